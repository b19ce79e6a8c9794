"""Who is the person, what do they believe, what will they ask for next? A filter over simulated minds.

A Bayesian filter. Each *guess* is a participant with a mind (`mind`), drawn from families of simulated
participants. It watches the game as the person does, and is as probable as it makes what the person does:

- a request: ``p = (1 - lapse) exp(-cost / T) / sum + lapse / n``, by the costs that the guess sees of all n
  requests that were possible (goal recognition by inverse planning: Baker, Saxe & Tenenbaum 2009);
- an answer: by the regret of the step for the guess, wrong with the probability ``lapse``.

When few guesses carry the weight, they are drawn anew (Gordon, Salmond & Smith 1993).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.execution import mind as minds
from explicable.execution.course import Course
from explicable.execution.monitor import Event
from explicable.execution.notices import Occurrence
from explicable.execution.participants import Family, Participant
from explicable.execution.setting import Setting
from explicable.execution.thoughts import Thought, Thoughts
from explicable.model.problem import GroundAtom
from explicable.model.task import State

if TYPE_CHECKING:
    import numpy as np


@dataclass(slots=True)
class Guess:
    """A person that the present one may be.

    Attributes
    ----------
    participant
        How it judges and learns.
    thought
        What it believes now.
    weight
        Its probability.
    regret
        Of the last robot step, by its beliefs before the step.
    """

    participant: Participant
    thought: Thought
    weight: float
    regret: float = field(default=0.0)


def draw_evenly(
    families: Iterable[Family], rng: "np.random.Generator", *, num_guesses: int = 24
) -> tuple[Participant, ...]:
    """Draw simulated participants from families in turn: whom a `PersonFilter` reckons with.

    Examples
    --------
    >>> import numpy as np
    >>> from explicable.execution import builtin_families
    >>> drawn = draw_evenly(builtin_families().values(), np.random.default_rng(0), num_guesses=4)
    >>> [participant.name for participant in drawn]
    ['simulated-myopic-0', 'simulated-mission-1', 'simulated-boltzmann-2', 'simulated-myopic-3']
    """
    drawn_from = list(families)
    if not drawn_from or num_guesses < 1:
        raise UsageError("a filter needs families, and a guess or more")
    return tuple(drawn_from[i % len(drawn_from)].draw(i, rng) for i in range(num_guesses))


class PersonFilter:
    """What the robot believes about the person at work.

    Parameters
    ----------
    setting
        Where the game is played.
    participants
        Whom the person may be; each is a guess. Their number bounds time and memory.
    rng
        All chance comes from here.
    temperature
        T of the requests, in the unit of cost.
    lapse
        Probability that the person does what no guess explains, above 0 and below 1.
    thoughts
        Shared by the filters of games on the same map.
    """

    def __init__(
        self,
        setting: Setting,
        participants: Iterable[Participant],
        rng: "np.random.Generator",
        *,
        temperature: float = 1.0,
        lapse: float = 0.1,
        thoughts: Thoughts | None = None,
    ) -> None:
        drawn = tuple(participants)
        if not drawn or not (temperature > 0 and 0 < lapse < 1):
            raise UsageError("a filter needs a guess or more, a temperature above 0, a lapse in (0, 1)")
        self.setting, self._rng = setting, rng
        self.temperature, self.lapse = temperature, lapse
        self._thoughts = thoughts or Thoughts(setting)
        start = self._thoughts.first
        self.guesses = [Guess(participant, start, 1.0 / len(drawn)) for participant in drawn]
        self._num_seen = 0
        self._state = setting.truth.task.initial_state

    def see(self, course: Course) -> None:
        """Take in what has happened since the last time; give it to `run` as ``watch``."""
        for occurrence in course.occurrences[self._num_seen :]:
            if not occurrence.refusal:
                self._take_in(occurrence)
            self._state = occurrence.game_state
        self._num_seen = len(course.occurrences)

    def predict(self) -> Mapping[GroundAtom, float]:
        """Return the probability of each request that the person may make next.

        Empty if nothing is left to ask for. A request under way is taken to be fulfilled before that.
        """
        chances: dict[GroundAtom, float] = {}
        for guess in self.guesses:
            for action, chance in self._choices(self._thoughts.rest(guess.thought)).items():
                chances[action] = chances.get(action, 0.0) + guess.weight * chance
        return chances

    def families(self) -> dict[str, float]:
        """Return the probability of each family, by the names of its participants."""
        found: dict[str, float] = {}
        for guess in self.guesses:
            name = guess.participant.name.rsplit("-", 1)[0]
            found[name] = found.get(name, 0.0) + guess.weight
        return found

    def _take_in(self, occurrence: Occurrence) -> None:
        event, action, after = occurrence.event, occurrence.notice.action, occurrence.game_state
        if event is Event.ANSWER_GIVEN and occurrence.notice.answer is not None:
            explicable = occurrence.notice.answer
            self._weigh([self._answers(guess, explicable=explicable) for guess in self.guesses])
        elif event is Event.STEP_FINISHED:
            self._think(action)
            self._watch(action, after)
        elif event is Event.PERSON_COMMANDED and after != self._state:
            if action in self.setting.belief.requests:
                self._weigh([self._choices(g.thought).get(action, self.lapse) for g in self.guesses])
            self._watch(action, after)

    def _watch(self, action: GroundAtom, after: State) -> None:
        """Let all guesses see a step."""
        watch, before = self._thoughts.watch, self._state
        for guess in self.guesses:
            guess.thought = watch(guess.thought, action, before, after)

    def _think(self, action: GroundAtom) -> None:
        """Let all guesses judge a robot step and perhaps learn from it, as simulated participants do."""
        thoughts, chance, truth = self._thoughts, self._rng.random, self._state
        for guess in self.guesses:
            who = guess.participant
            if inferred := guess.thought.mind.inferred:
                kept = tuple([chance() < who.memory for _ in inferred])
                if not all(kept):
                    guess.thought = thoughts.keep(guess.thought, kept)
            guess.regret, error = thoughts.judge(guess.thought, who, action, truth)
            if error is not None and chance() < who.learning:
                guess.thought = thoughts.correct(guess.thought, error)

    def _choices(self, thought: Thought) -> Mapping[GroundAtom, float]:
        return self._thoughts.choices(thought, self.temperature, self.lapse)

    def _answers(self, guess: Guess, *, explicable: bool) -> float:
        accepted = minds.acceptance(guess.participant, guess.regret)
        meant = accepted if explicable else 1.0 - accepted
        return (1.0 - self.lapse) * meant + self.lapse * (1.0 - meant)

    def _weigh(self, likelihoods: Sequence[float]) -> None:
        for guess, likelihood in zip(self.guesses, likelihoods, strict=True):
            guess.weight *= likelihood
        total = sum(guess.weight for guess in self.guesses)
        for guess in self.guesses:
            guess.weight /= total
        if 1.0 / sum(guess.weight**2 for guess in self.guesses) < len(self.guesses) / 2:
            self._draw_anew()

    def _draw_anew(self) -> None:
        """Draw guesses by their weights, evenly spaced; all weigh alike then."""
        number, spent = len(self.guesses), 0.0
        kept: list[Guess] = []
        mark = float(self._rng.random())
        for guess in self.guesses:
            spent += guess.weight * number
            while mark < spent and len(kept) < number:
                kept.append(Guess(guess.participant, guess.thought, 1.0 / number, guess.regret))
                mark += 1.0
        while len(kept) < number:  # rounding
            last = self.guesses[-1]
            kept.append(Guess(last.participant, last.thought, 1.0 / number, last.regret))
        self.guesses = kept
