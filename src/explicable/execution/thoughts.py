"""What may go on in people's heads, each thought once, for all who watch games of a setting.

Who thinks the same holds the same `Thought`: a mind, with what was worked out of it so far. So what follows
from a step that is seen is worked out for one of them, and looked up by all others.
"""

import math
import weakref
from typing import NamedTuple

from explicable.execution import mind as minds
from explicable.execution.mind import Belief, Mind
from explicable.execution.participants import Horizon, Participant
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State

MOST_THOUGHTS = 20_000
"""So many are remembered, with what follows from them: a few ten megabytes."""


class Judgement(NamedTuple):
    """What a robot step is to somebody.

    Parameters
    ----------
    regret
        By the beliefs before the step.
    error
        What is believed, and can be seen now not to be so: there is something to learn.
    """

    regret: float
    error: Belief | None


class Thought:
    """A mind, and what was worked out of it; made by `Thoughts`."""

    __slots__ = (
        "_choices",
        "_corrected",
        "_judgements",
        "_kept",
        "_rest",
        "_seen",
        "mind",
        "num_inferred",
        "request",
    )

    def __init__(self, mind: Mind) -> None:
        self.mind, self.request = mind, mind.request
        self.num_inferred = len(mind.inferred)
        self._judgements: dict[tuple[GroundAtom, State, Horizon, bool], Judgement] = {}
        self._seen: dict[tuple[GroundAtom, State, State], Thought] = {}
        self._corrected: dict[Belief, Thought] = {}
        self._kept: dict[tuple[bool, ...], Thought] = {}
        self._choices: dict[tuple[float, float], dict[GroundAtom, float]] = {}
        self._rest: Thought | None = None


class Thoughts:
    """The thoughts of all who watch games of one setting: shared by all of them (`Setting.shared`).

    Parameters
    ----------
    setting
        Where the games are played; to be kept by whoever plays there.

    Examples
    --------
    >>> from explicable.execution import prepare
    >>> from explicable.first_response import World, encode
    >>> setting = prepare(encode(World(("*@*",))))
    >>> thoughts = setting.shared(Thoughts)
    >>> list(thoughts.choices(thoughts.first, temperature=1.0, lapse=0.1).values())
    [0.5, 0.5]
    """

    def __init__(self, setting: Setting) -> None:
        # Weakly: a setting holds its thoughts, and tasks are too large to wait for the garbage collector.
        self.setting = weakref.proxy(setting)
        self._known: dict[Mind, Thought] = {}

    @property
    def first(self) -> Thought:
        """What everybody thinks when a game begins."""
        return self._of(Mind(self.setting.belief.task.initial_state))

    def judge(
        self, thought: Thought, participant: Participant, action: GroundAtom, truth: State
    ) -> Judgement:
        """Judge a robot step that is taken in a true state."""
        key = action, truth, participant.horizon, participant.initiative
        found = thought._judgements.get(key)
        if found is None:
            regret = minds.regret(self.setting.belief, participant, thought.mind, action)
            error = minds.find_error(self.setting, participant, thought.mind, truth) if regret > 0 else None
            found = thought._judgements[key] = Judgement(regret, error)
        return found

    def watch(self, thought: Thought, action: GroundAtom, before: State, after: State) -> Thought:
        """Return the thought after a step of anybody was seen, from one true state to another."""
        key = action, before, after
        found = thought._seen.get(key)
        if found is None:
            mind = minds.watch(self.setting, thought.mind, action, before, after)
            found = thought._seen[key] = self._of(mind)
        return found

    def correct(self, thought: Thought, error: Belief) -> Thought:
        """Return the thought after an error was seen."""
        found = thought._corrected.get(error)
        if found is None:
            found = thought._corrected[error] = self._of(minds.correct(self.setting, thought.mind, error))
        return found

    def keep(self, thought: Thought, kept: tuple[bool, ...]) -> Thought:
        """Return the thought of whose inferred facts these are kept, in their order."""
        found = thought._kept.get(kept)
        if found is None:
            found = thought._kept[kept] = self._of(minds.keep(self.setting, thought.mind, kept))
        return found

    def choices(self, thought: Thought, temperature: float, lapse: float) -> dict[GroundAtom, float]:
        """Return the probability of each request that may now be made; see `recognition`."""
        found = thought._choices.get((temperature, lapse))
        if found is None:
            found = thought._choices[temperature, lapse] = self._choose(thought, temperature, lapse)
        return found

    def give_up(self, thought: Thought, request: Request) -> Thought:
        """Return the thought after it was said that a request can't be fulfilled."""
        return self._of(minds.give_up(thought.mind, request))

    def rest(self, thought: Thought) -> Thought:
        """Return the thought after the request under way was fulfilled by the way that is expected."""
        if thought._rest is None:
            belief, mind = self.setting.belief, thought.mind
            state = belief.fulfilled(mind.state, mind.request) if mind.request else mind.state
            thought._rest = self._of(Mind(state))
        return thought._rest

    def _of(self, mind: Mind) -> Thought:
        found = self._known.get(mind)
        if found is None:
            if len(self._known) >= MOST_THOUGHTS:
                self._known.clear()
            found = self._known[mind] = Thought(mind)
        return found

    def _choose(self, thought: Thought, temperature: float, lapse: float) -> dict[GroundAtom, float]:
        belief = self.setting.belief
        ranked = belief.ranked_asks(thought.mind.state)
        if not ranked:
            return {}
        least = ranked[0][0]
        sane = [math.exp((least - cost) / temperature) if least < math.inf else 1.0 for cost, _ in ranked]
        total = sum(sane)
        return {
            belief.task.action(operator): (1.0 - lapse) * weight / total + lapse / len(ranked)
            for weight, (_, operator) in zip(sane, ranked, strict=True)
        }
