"""Who is the person, what do they believe, what will they ask for next? A filter over simulated minds.

A Bayesian filter. Each *guess* is a participant with a mind (`mind`), drawn from families of simulated
participants. It watches the game as the person does, and is as probable as it makes what the person does:

- a request: ``p = (1 - lapse) exp(-cost / T) / sum + lapse / n``, by the costs that the guess sees of all n
  requests that were possible (goal recognition by inverse planning: Baker, Saxe & Tenenbaum 2009);
- an answer: by the regret of the step for the guess, wrong with the probability ``lapse``.

When few guesses carry the weight, they are drawn anew (Gordon, Salmond & Smith 1993).
"""

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from explicable.errors import UsageError
from explicable.execution.course import Course
from explicable.execution.monitor import Event
from explicable.execution.notices import Occurrence
from explicable.execution.participants import Family, Participant
from explicable.execution.setting import Setting
from explicable.execution.thoughts import Judgement, Thought, Thoughts
from explicable.model.problem import GroundAtom
from explicable.model.task import State

if TYPE_CHECKING:
    from numpy.typing import NDArray


def draw_evenly(
    families: Iterable[Family], rng: np.random.Generator, *, num_guesses: int = 24
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


class _Crowd:
    """Participants side by side.

    Attributes
    ----------
    judges
        One of those who judge alike, for each way to judge.
    ways
        The number of each participant's.
    """

    def __init__(self, participants: tuple[Participant, ...]) -> None:
        self.participants = participants
        alike = {(who.horizon, who.initiative): who for who in participants}
        self.judges = tuple(alike.values())
        ways = list(alike)
        self.ways = [ways.index((who.horizon, who.initiative)) for who in participants]
        self._slack = np.array([who.slack for who in participants])
        self._temperature = np.array([who.temperature for who in participants])
        self._is_boltzmann = np.array([who.judgement == "boltzmann" for who in participants])

    def acceptance(self, regrets: "NDArray[np.float64]") -> "NDArray[np.float64]":
        """Return what `mind.acceptance` does, for each by their own regret."""
        rational = np.exp(-np.maximum(regrets, 0.0) / self._temperature)
        return np.where(self._is_boltzmann, rational, regrets <= self._slack)


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
        What the guesses think, if not what the setting remembers.
    """

    def __init__(
        self,
        setting: Setting,
        participants: Iterable[Participant],
        rng: np.random.Generator,
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
        self._thoughts = thoughts or setting.shared(Thoughts)
        self._crowd = _Crowd(drawn)
        self._facts_until: list[tuple[float, ...]] = [()] * len(drawn)
        self._thinking = [self._thoughts.first] * len(drawn)
        self._weights = np.full(len(drawn), 1.0 / len(drawn))
        self._judged = [Judgement(0.0, None)] * len(drawn)  # of the last robot step, by beliefs before it
        self._course: Course | None = None
        self._num_seen = self._num_judged = 0
        self._state = setting.truth.task.initial_state

    @property
    def participants(self) -> tuple[Participant, ...]:
        """Whom the person may be, by now."""
        self._catch_up()
        return self._crowd.participants

    def see(self, course: Course) -> None:
        """Look on at a game; give it to `run` as ``watch``. What it tells is worked out when asked for."""
        self._course = course

    @property
    def thinking(self) -> tuple[Thought, ...]:
        """What each of the participants would believe now."""
        self._catch_up()
        return tuple(self._thinking)

    @property
    def weights(self) -> "NDArray[np.float64]":
        """How probable it is that the person is this or that participant."""
        self._catch_up()
        return self._weights

    def predict(self) -> Mapping[GroundAtom, float]:
        """Return the probability of each request that the person may make next.

        Empty if nothing is left to ask for. A request under way is taken to be fulfilled before that.
        """
        self._catch_up()
        weights: dict[Thought, float] = {}
        for thought, weight in zip(self._thinking, self._weights.tolist(), strict=True):
            weights[thought] = weights.get(thought, 0.0) + weight
        chances: dict[GroundAtom, float] = {}
        for thought, weight in weights.items():
            for action, chance in self._choices(self._thoughts.rest(thought)).items():
                chances[action] = chances.get(action, 0.0) + weight * chance
        return chances

    def families(self) -> dict[str, float]:
        """Return the probability of each family, by the names of its participants."""
        found: dict[str, float] = {}
        for participant, weight in zip(self.participants, self._weights.tolist(), strict=True):
            name = participant.name.rsplit("-", 1)[0]
            found[name] = found.get(name, 0.0) + weight
        return found

    def _catch_up(self) -> None:
        """Take in what has happened since the last time."""
        news = self._course.occurrences[self._num_seen :] if self._course else ()
        for occurrence in news:
            if not occurrence.refusal:
                self._take_in(occurrence)
            self._state = occurrence.game_state
        self._num_seen += len(news)

    def _take_in(self, occurrence: Occurrence) -> None:
        event, action, after = occurrence.event, occurrence.notice.action, occurrence.game_state
        if event is Event.STEP_FINISHED:
            self._think(action)
            self._watch(action, after)
        elif event is Event.ANSWER_GIVEN and occurrence.notice.answer is not None:
            self._hear(explicable=occurrence.notice.answer)
        elif event is Event.PERSON_COMMANDED and after != self._state:
            if action in self.setting.belief.requests:
                self._weigh(np.array([self._choices(t).get(action, self.lapse) for t in self._thinking]))
            self._watch(action, after)

    def _watch(self, action: GroundAtom, after: State) -> None:
        """Let all guesses see a step."""
        watch, before = self._thoughts.watch, self._state
        then = {thought: watch(thought, action, before, after) for thought in set(self._thinking)}
        self._thinking = [then[thought] for thought in self._thinking]

    def _think(self, action: GroundAtom) -> None:
        """Let all guesses judge a robot step and perhaps learn from it, as simulated participants do."""
        self._num_judged += 1
        self._forget()
        judge, judges, truth = self._thoughts.judge, self._crowd.judges, self._state
        pairs = list(zip(self._thinking, self._crowd.ways, strict=True))
        judged = {pair: judge(pair[0], judges[pair[1]], action, truth) for pair in set(pairs)}
        self._judged = [judged[pair] for pair in pairs]
        if any(judgement.error is not None for judgement in judged.values()):
            self._learn()

    def _learn(self) -> None:
        for number, (who, (_, error)) in enumerate(zip(self._crowd.participants, self._judged, strict=True)):
            if error is not None and self._rng.random() < who.learning:
                self._thinking[number] = self._thoughts.correct(self._thinking[number], error)
                self._facts_until[number] += (self._forgotten_at(who),)

    def _forgotten_at(self, who: Participant) -> float:
        """Draw at which robot step a fact will be forgotten that may be so at each from now on."""
        return self._num_judged + self._rng.geometric(1.0 - who.memory) if who.memory < 1.0 else math.inf

    def _forget(self) -> None:
        now = self._num_judged
        for number, until in enumerate(self._facts_until):
            if until and now in until:
                kept = tuple([end != now for end in until])
                self._thinking[number] = self._thoughts.keep(self._thinking[number], kept)
                self._facts_until[number] = tuple(itertools.compress(until, kept))

    def _choices(self, thought: Thought) -> Mapping[GroundAtom, float]:
        return self._thoughts.choices(thought, self.temperature, self.lapse)

    def _hear(self, *, explicable: bool) -> None:
        """Take in an answer; it tells nothing if nobody regrets the step, since then all would accept it."""
        regrets = [judgement.regret for judgement in self._judged]
        if any(regrets):
            accepted = self._crowd.acceptance(np.array(regrets))
            meant = accepted if explicable else 1.0 - accepted
            self._weigh(self.lapse + (1.0 - 2.0 * self.lapse) * meant)

    def _weigh(self, likelihoods: "NDArray[np.float64]") -> None:
        self._weights = self._weights * likelihoods
        self._weights /= self._weights.sum()
        if 1.0 / (self._weights @ self._weights) < len(self._weights) / 2:
            self._draw_anew()

    def _draw_anew(self) -> None:
        """Draw guesses by their weights, evenly spaced; all weigh alike then."""
        number = len(self._weights)
        marks = (np.arange(number) + self._rng.random()) / number
        drawn = np.minimum(
            np.searchsorted(np.cumsum(self._weights), marks, side="right"), number - 1
        ).tolist()
        self._crowd = _Crowd(tuple([self._crowd.participants[guess] for guess in drawn]))
        self._thinking = [self._thinking[guess] for guess in drawn]
        self._judged = [self._judged[guess] for guess in drawn]
        # Copies of a guess go their own ways.
        self._facts_until = [
            tuple([self._forgotten_at(who) for _ in range(thought.num_inferred)])
            for who, thought in zip(self._crowd.participants, self._thinking, strict=True)
        ]
        self._weights = np.full(number, 1.0 / number)
