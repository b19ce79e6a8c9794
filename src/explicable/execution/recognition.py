"""Who is the person, what do they believe, what will they ask for next? A filter over simulated minds.

A Bayesian filter. Each *guess* is a participant with a mind (`mind`), drawn from families of simulated
participants. It watches the game as the person does, and is as probable as it makes what the person does:

- a request: ``p = (1 - lapse) exp(-cost / T) / sum + lapse / n``, by the costs that the guess sees of all n
  requests that were possible (goal recognition by inverse planning: Baker, Saxe & Tenenbaum 2009);
- an answer: by the regret of the step for the guess, wrong with the probability ``lapse``.

When few guesses carry the weight, they are drawn anew (Gordon, Salmond & Smith 1993).
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from explicable.errors import UsageError
from explicable.execution import mind as minds
from explicable.execution.course import Course
from explicable.execution.mind import Belief, Mind
from explicable.execution.monitor import Event
from explicable.execution.notices import Occurrence
from explicable.execution.participants import Family, Participant
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom
from explicable.model.task import State

if TYPE_CHECKING:
    import numpy as np

Answer = TypeVar("Answer")


@dataclass(slots=True)
class Guess:
    """A person that the present one may be.

    Attributes
    ----------
    participant
        How it judges and learns.
    mind
        What it believes now.
    weight
        Its probability.
    regret
        Of the last robot step, by its beliefs before the step.
    """

    participant: Participant
    mind: Mind
    weight: float
    regret: float = field(default=0.0)


class PersonFilter:
    """What the robot believes about the person at work.

    Parameters
    ----------
    setting
        Where the game is played.
    families
        From which guesses are drawn, evenly.
    rng
        All chance comes from here.
    num_guesses
        How many: bounds time and memory.
    temperature
        T of the requests, in the unit of cost.
    lapse
        Probability that the person does what no guess explains, above 0 and below 1.
    """

    def __init__(
        self,
        setting: Setting,
        families: Iterable[Family],
        rng: "np.random.Generator",
        *,
        num_guesses: int = 24,
        temperature: float = 1.0,
        lapse: float = 0.1,
    ) -> None:
        drawn_from = list(families)
        if not drawn_from or num_guesses < 1 or not (temperature > 0 and 0 < lapse < 1):
            raise UsageError(
                "a filter needs families, a guess or more, a temperature above 0, a lapse in (0, 1)"
            )
        self.setting, self._rng = setting, rng
        self.temperature, self.lapse = temperature, lapse
        start = Mind(setting.belief.task.initial_state)
        self.guesses = [
            Guess(drawn_from[i % len(drawn_from)].draw(i, rng), start, 1.0 / num_guesses)
            for i in range(num_guesses)
        ]
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
        choices = self._of_minds(lambda mind: self._choices(self._settle(mind)))
        for guess, likely in zip(self.guesses, choices, strict=True):
            for action, chance in likely.items():
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
                self._weigh(self._of_minds(lambda mind: self._choices(mind).get(action, self.lapse)))
            self._watch(action, after)

    def _of_minds(self, ask: Callable[[Mind], Answer]) -> list[Answer]:
        """Ask the mind of each guess; many share one, which is asked once."""
        minds_by_id = {id(guess.mind): guess.mind for guess in self.guesses}
        answers = {key: ask(mind) for key, mind in minds_by_id.items()}
        return [answers[id(guess.mind)] for guess in self.guesses]

    def _watch(self, action: GroundAtom, after: State) -> None:
        """Let all guesses see a step."""
        seen = self._of_minds(lambda mind: minds.watch(self.setting, mind, action, self._state, after))
        for guess, mind in zip(self.guesses, seen, strict=True):
            guess.mind = mind

    def _think(self, action: GroundAtom) -> None:
        """Let all guesses judge a robot step and perhaps learn from it, as simulated participants do."""
        setting = self.setting
        # Judged once for all that judge alike; with the mind, so that no other can come to have its id.
        judged: dict[tuple[int, str, bool], tuple[Mind, float, Belief | None]] = {}
        changed: dict[Mind, Mind] = {}  # equal ones become one
        for guess in self.guesses:
            who, before = guess.participant, guess.mind
            mind = minds.forget(setting, who, before, self._rng)
            key = id(mind), who.horizon, who.initiative
            if key not in judged:
                regret = minds.regret(setting.belief, who, mind, action)
                error = minds.find_error(setting, who, mind, self._state) if regret > 0 else None
                judged[key] = mind, regret, error
            _, guess.regret, error = judged[key]
            mind = minds.learn(setting, who, mind, error, self._rng)
            guess.mind = mind if mind is before else changed.setdefault(mind, mind)

    def _answers(self, guess: Guess, *, explicable: bool) -> float:
        accepted = minds.acceptance(guess.participant, guess.regret)
        meant = accepted if explicable else 1.0 - accepted
        return (1.0 - self.lapse) * meant + self.lapse * (1.0 - meant)

    def _choices(self, mind: Mind) -> dict[GroundAtom, float]:
        belief = self.setting.belief
        asks = [(cost, belief.task.action(operator)) for cost, operator in belief.ranked_asks(mind.state)]
        if not asks:
            return {}
        least = asks[0][0]
        sane = [math.exp((least - cost) / self.temperature) if least < math.inf else 1.0 for cost, _ in asks]
        total = sum(sane)
        return {
            action: (1.0 - self.lapse) * weight / total + self.lapse / len(asks)
            for weight, (_, action) in zip(sane, asks, strict=True)
        }

    def _settle(self, mind: Mind) -> Mind:
        """Return a mind after its request was fulfilled by the way it expects."""
        belief, state = self.setting.belief, mind.state
        way = belief.fulfilment_way(state, mind.request) if mind.request else None
        for operator in way or ():
            state = belief.task.successor(state, operator)
        return Mind(state)

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
                kept.append(Guess(guess.participant, guess.mind, 1.0 / number, guess.regret))
                mark += 1.0
        while len(kept) < number:  # rounding
            last = self.guesses[-1]
            kept.append(Guess(last.participant, last.mind, 1.0 / number, last.regret))
        self.guesses = kept
