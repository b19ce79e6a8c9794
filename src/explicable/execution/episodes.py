"""The protocol of the study behind the paper, played with simulated participants (method page, section 5)."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Literal, get_args

from explicable.errors import PlanError, UsageError
from explicable.execution.outlook import Outlook
from explicable.execution.participants import Family, Participant
from explicable.execution.people import Person, SimulatedPerson
from explicable.execution.setting import Setting, prepare
from explicable.labelling.traces import LabelledStep, Trace
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State
from explicable.model.team import TeamProblem

if TYPE_CHECKING:
    import numpy as np

Way = Literal["commanded", "autonomous"]
StudyWay = Literal["commanded", "autonomous", "mixed"]

UNANNOUNCED = 4
"""In a mixed study one in so many games is played autonomously, though nobody has said so."""


class Ending(StrEnum):
    """How an episode ended."""

    REACHED = "goal reached"
    STUCK = "nobody knew how to go on"
    IMPOSSIBLE = "no plan leads to the goal"
    LIMIT = "step limit reached"
    TIME = "time limit reached"
    ABORTED = "aborted"


@dataclass(frozen=True, slots=True)
class Episode:
    """A game played to its end."""

    trace: Trace
    ending: Ending


def simulate(
    setting: Setting,
    participant: Participant,
    rng: "np.random.Generator",
    *,
    way: Way = "commanded",
    announced: bool = True,
    max_steps: int = 1000,
) -> Episode:
    """Play one game of the study with a simulated participant; see `play`.

    It knows how the robot plays, unless this is not ``announced``: in autonomous play it expects initiative.
    All chance comes from ``rng``.

    Examples
    --------
    >>> import numpy as np
    >>> from explicable.execution import prepare
    >>> from explicable.first_response import World, encode
    >>> setting = prepare(encode(World(("@x*", "...")), "exclusive"))
    >>> episode = simulate(setting, Participant("simulated-1"), np.random.default_rng(0))
    >>> [step.label for step in episode.trace.steps]
    [None, False, True, True, True, True]
    """
    participant = replace(
        participant, initiative=participant.initiative or (announced and way == "autonomous")
    )
    episode = play(setting, SimulatedPerson(setting, participant, rng), way=way, max_steps=max_steps)
    notes = {"participant": asdict(participant), **episode.trace.notes}
    return replace(episode, trace=replace(episode.trace, notes=notes))


def play(setting: Setting, person: Person, *, way: Way = "commanded", max_steps: int = 1000) -> Episode:
    """Play one game as in the study: the person asks, the robot follows, and each robot step is judged.

    The robot takes a shortest way, in the truth, to what was last asked for. After each of its steps the
    person says whether it made sense, and may ask for something else. A request that the robot sees no way
    to fulfil is refused once and for all.

    Parameters
    ----------
    setting
        The team problem, prepared by `prepare`.
    person
        Who judges and asks.
    way
        ``commanded``: the robot waits until something is asked for. ``autonomous``: it heads for what can
        be had soonest, and the person may be silent for as long as the robot gets on.
    max_steps
        Most steps of the whole team.

    Returns
    -------
    Episode
        It always ends; how, it says.
    """
    if way not in get_args(Way):
        raise UsageError(f"way must be one of {', '.join(get_args(Way))}, not {way!r}")
    game = Game(setting, person)
    refused, robot_moved = frozenset[GroundAtom](), False
    while not game.is_over:
        if len(game.steps) >= max_steps:
            return game.ended(Ending.LIMIT)
        request = person.request
        robot_action = follow(setting.truth, game.state, request, way)
        must_ask = request is None and (robot_action is None or way == "commanded")
        thinks_over = robot_moved and person.thinks_over()
        asked = person.choose(refused) if must_ask or thinks_over else None
        robot_moved = False
        if asked is not None:
            if game.allows(asked):
                game.take(asked)
            else:
                refused |= {asked}
        elif robot_action is not None:
            game.take(robot_action)
            robot_moved = True
        elif request is not None:
            refused |= {request.action}
            person.give_up(request)
        else:
            return game.ended(Ending.STUCK)
    return game.ended(Ending.REACHED)


def follow(truth: Outlook, state: State, request: Request | None, way: Way) -> GroundAtom | None:
    """Return the robot's next action on a shortest way to what is asked for, or None where it has to wait.

    With nothing asked for it waits if something useful could be asked, unless it plays autonomously; where
    nothing can be asked it does its part of a shortest joint way to the goal.
    """
    if request is not None:
        operator = truth.next_operator(state, request)
    else:
        asks = truth.ranked_asks(state)
        if asks and way == "commanded":
            return None
        operator = _lead(truth, state, asks[0][1]) if asks else _own_part(truth, state)
    return None if operator is None else truth.task.action(operator)


def _lead(truth: Outlook, state: State, ask: int) -> int | None:
    """Return what a robot can do already towards what it expects to be asked for."""
    asked = truth.task.successor(state, ask)
    operator = truth.next_operator(asked, truth.requests[truth.task.action(ask)])
    return operator if operator is not None and truth.task.is_applicable(state, operator) else None


def _own_part(truth: Outlook, state: State) -> int | None:
    """Return the next step of a shortest joint way, if it is a robot's."""
    way = truth.mission_way(state)
    robots = way and truth.problem.agent_of(truth.task.action(way[0])).kind == "robot"
    return way[0] if way and robots else None


def judge(
    setting: Setting, participant: Participant, actions: Sequence[GroundAtom], rng: "np.random.Generator"
) -> tuple[LabelledStep, ...]:
    """Let a participant watch a whole joint plan and label its robot steps.

    Raises
    ------
    PlanError
        If a step can't be executed in the truth; the message gives its number.
    """
    game = Game(setting, SimulatedPerson(setting, participant, rng))
    for action in actions:
        game.take(action)
    return tuple(game.steps)


class Game:
    """A game under way: the true state, the person, and the steps so far."""

    def __init__(self, setting: Setting, person: Person) -> None:
        self.setting, self.person = setting, person
        self.state = setting.truth.task.initial_state
        self.steps: list[LabelledStep] = []

    @property
    def is_over(self) -> bool:
        """Whether the goal is reached."""
        return self.setting.truth.task.is_goal(self.state)

    def allows(self, action: GroundAtom) -> bool:
        """Whether an action can be executed now."""
        return self.setting.truth.operator(self.state, action) is not None

    def take(self, action: GroundAtom) -> None:
        """Execute a step of any agent; the person judges it if it is a robot's, and sees it.

        Raises
        ------
        PlanError
            If it can't be executed; the message gives the step's number. Nothing has changed then.
        """
        truth = self.setting.truth
        operator = truth.operator(self.state, action)
        if operator is None:
            raise PlanError(f"step {len(self.steps) + 1}, {format_action(action)}, can't be executed there")
        agent, after = self.setting.problem.agent_of(action), truth.task.successor(self.state, operator)
        label = self.person.judge(action, self.state) if agent.kind == "robot" else None
        self.person.watch(action, self.state, after)
        self.state = after
        self.steps.append(LabelledStep(agent.name, action, label))

    def ended(self, ending: Ending) -> Episode:
        """Close the game."""
        notes = {"ending": ending.value}
        trace = Trace(
            self.setting.problem, tuple(self.steps), self.person.name, self.person.origin, notes=notes
        )
        return Episode(trace, ending)


def assign(num_problems: int, num_traces: int, *, games_each: int = 4) -> list[tuple[int, int]]:
    """Spread games evenly over problems and participants.

    Returns
    -------
    list of (problem, participant)
        Both counted from 0. Each problem is played as often as any other, give or take one; nobody plays a
        problem twice.

    Examples
    --------
    >>> assign(3, 5, games_each=2)
    [(0, 0), (1, 0), (2, 1), (0, 1), (1, 2)]
    """
    if num_problems < 1 or num_traces < 1 or games_each < 1:
        raise UsageError("problems, traces and games for each participant must be at least one each")
    games_each = min(games_each, num_problems)
    return [(game % num_problems, game // games_each) for game in range(num_traces)]


def simulate_study(
    problems: Iterable[TeamProblem],
    family: Family,
    *,
    names: Sequence[str] | None = None,
    num_traces: int = 34,
    seed: int = 0,
    way: StudyWay = "mixed",
) -> list[Episode]:
    """Play a whole study: participants of one family, each of whom plays a few of the problems.

    The paper collected 34 traces on 16 problems.

    Parameters
    ----------
    problems
        What is played.
    family
        From which the participants are drawn.
    names
        Of the problems, for their traces.
    seed
        The same seed gives the same traces.
    way
        ``mixed``: as commanded, but in one of four games the robot goes ahead unasked and nobody has said so.
        Traces of commanded play alone never show a robot that moves without a request, so what is learned
        from them has no opinion of it.

    Returns
    -------
    list of Episode
        Problem by problem in turn. Each trace notes the participant's parameters and how the game ended.
    """
    import numpy as np

    settings = [prepare(problem) for problem in problems]
    if way not in get_args(StudyWay):
        raise UsageError(f"way must be one of {', '.join(get_args(StudyWay))}, not {way!r}")
    if names is not None and len(names) != len(settings):
        raise UsageError(f"{len(names)} names for {len(settings)} problems")
    episodes = []
    for game, (place, number) in enumerate(assign(len(settings), num_traces)):
        participant = family.draw(number + 1, np.random.default_rng((seed, 0, number)))
        # By chance which of the four: else it would always be the same problems.
        place_of_surprise = np.random.default_rng((seed, 2, game // UNANNOUNCED)).integers(UNANNOUNCED)
        is_surprise = way == "mixed" and game % UNANNOUNCED == place_of_surprise
        episode = simulate(
            settings[place],
            participant,
            np.random.default_rng((seed, 1, game)),
            way="autonomous" if is_surprise or way == "autonomous" else "commanded",
            announced=not is_surprise,
        )
        name = names[place] if names else None
        episodes.append(replace(episode, trace=replace(episode.trace, name=name)))
    return episodes
