"""Who sits at the other end of a game: a simulated participant, or a script for tests."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

from explicable.execution import mind as minds
from explicable.execution.mind import Mind
from explicable.execution.participants import Participant
from explicable.execution.setting import Setting
from explicable.execution.thoughts import Thoughts
from explicable.labelling.traces import Origin
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State

if TYPE_CHECKING:
    import numpy as np


class Person(Protocol):
    """What a game asks of a person; states are those of the truth."""

    @property
    def name(self) -> str:
        """Under which the labels go into traces."""

    @property
    def origin(self) -> Origin:
        """Whether the labels are those of a real person."""

    @property
    def request(self) -> Request | None:
        """The last thing asked for and not got."""

    def thinks_over(self) -> bool:
        """Tell whether the person thinks, of its own accord, about doing something now."""

    def choose(self, refused: frozenset[GroundAtom]) -> GroundAtom | None:
        """Choose a human step, none of those refused, or None to let the robot go on."""

    def judge(self, action: GroundAtom, state: State) -> bool | None:
        """Say whether the robot step that is taken in this state makes sense; None for no answer."""

    def watch(self, action: GroundAtom, before: State, after: State) -> None:
        """See a step of anybody happen."""

    def give_up(self, request: Request) -> None:
        """Be told that a request can't be fulfilled."""


class Watcher:
    """What all people made of software do alike: keep a mind up to date."""

    def __init__(self, name: str, setting: Setting) -> None:
        self.name = name
        self.origin: Origin = "simulated"
        self.setting = setting
        self._thoughts = setting.shared(Thoughts)
        self._thought = self._thoughts.first

    @property
    def mind(self) -> Mind:
        """What the person believes."""
        return self._thought.mind

    @property
    def request(self) -> Request | None:
        """The last thing asked for and not got."""
        return self._thought.request

    def watch(self, action: GroundAtom, before: State, after: State) -> None:
        """See a step of anybody happen."""
        self._thought = self._thoughts.watch(self._thought, action, before, after)

    def give_up(self, request: Request) -> None:
        """Be told that a request can't be fulfilled."""
        self._thought = self._thoughts.give_up(self._thought, request)


class SimulatedPerson(Watcher):
    """A simulated participant at play: a test instrument.

    Parameters
    ----------
    setting
        Where the game is played.
    participant
        Its parameters.
    rng
        All its chance comes from here.
    """

    def __init__(self, setting: Setting, participant: Participant, rng: "np.random.Generator") -> None:
        super().__init__(participant.name, setting)
        self.participant = participant
        self.rng = rng

    def thinks_over(self) -> bool:
        """Tell so with the probability of the participant's readiness."""
        return bool(self.rng.random() < self.participant.readiness)

    def choose(self, refused: frozenset[GroundAtom]) -> GroundAtom | None:
        """See `explicable.execution.mind.choose`."""
        return minds.choose(self.setting, self.participant, self.mind, self.rng, refused)

    def judge(self, action: GroundAtom, state: State) -> bool | None:
        """Answer by the beliefs before the step, which may have been forgotten; then perhaps learn."""
        thoughts, who, chance = self._thoughts, self.participant, self.rng.random
        if inferred := self._thought.mind.inferred:
            kept = tuple([chance() < who.memory for _ in inferred])
            if not all(kept):
                self._thought = thoughts.keep(self._thought, kept)
        regret, error = thoughts.judge(self._thought, who, action, state)
        if error is not None and chance() < who.learning:
            self._thought = thoughts.correct(self._thought, error)
        return minds.label_step(who, regret, self.rng)


class ScriptedPerson(Watcher):
    """A person for tests: takes written steps in their order, one whenever it is asked to choose.

    Parameters
    ----------
    setting
        Where the game is played.
    script
        Human steps; None lets the robot go on once. After the last it only watches.
    answer
        What it says of a robot step; by default that each is explicable.
    """

    def __init__(
        self,
        setting: Setting,
        script: Sequence[GroundAtom | None],
        answer: Callable[[GroundAtom], bool | None] = lambda _: True,
    ) -> None:
        super().__init__("scripted", setting)
        self._steps = list(reversed(script))
        self._answer = answer

    def thinks_over(self) -> bool:
        """Never: it acts when asked."""
        return False

    def choose(self, refused: frozenset[GroundAtom]) -> GroundAtom | None:  # noqa: ARG002 (a script heeds nothing)
        """Take the next step of the script."""
        return self._steps.pop() if self._steps else None

    def judge(self, action: GroundAtom, state: State) -> bool | None:  # noqa: ARG002 (a script heeds nothing)
        """Give the answer that was written."""
        return self._answer(action)
