"""What happens in a game, and how it stands on record while the game goes on.

Named tuples: a game makes hundreds of them, and they are made in less than half the time of a frozen class.
"""

from typing import NamedTuple

from explicable.execution.monitor import Event, State
from explicable.execution.robots.protocol import Fact
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.task import State as GameState


class Notice(NamedTuple):
    """Something that happened.

    Parameters
    ----------
    event
        What.
    action
        The step that it is about; empty if about none.
    facts
        What was observed.
    answer
        Whether the step is explicable.
    plan
        The joint plan from now on.
    agent
        Who is lost or back, or has answered; empty where there is no doubt.
    reason
        Why it happened, for people to read; of the time that is up, the value of an `Ending`.
    """

    event: Event
    action: GroundAtom = ()
    facts: tuple[Fact, ...] = ()
    answer: bool | None = None
    plan: Actions = ()
    reason: str = ""
    agent: str = ""


class Occurrence(NamedTuple):
    """A notice, when it came, and what it led to.

    Parameters
    ----------
    notice
        What happened.
    time_s
        Seconds since the game began.
    state
        Of the monitor, afterwards.
    refusal
        Why it was not taken; nothing has changed then. Empty if it was.
    game_state
        Where the game then stands, in the setting's truth.
    """

    notice: Notice
    time_s: float
    state: State
    game_state: GameState
    refusal: str = ""

    @property
    def event(self) -> Event:
        """What happened."""
        return self.notice.event
