"""The humans of a team as the loop sees them: asked for steps, shown what happens, asked what they think."""

from collections.abc import Callable, Sequence

from explicable.errors import UsageError
from explicable.execution.course import Course
from explicable.execution.monitor import Event
from explicable.execution.notices import Notice
from explicable.execution.people import Person
from explicable.execution.setting import Setting
from explicable.labelling.records import Origin
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State

Refuse = Callable[[GroundAtom], None]
"""Called with each step that somebody asks for and that is not possible."""


class Humans:
    """All people of a game.

    Parameters
    ----------
    course
        The game.
    people
        One, who may take any human step, or one for each human of the team, in their order.

    Raises
    ------
    UsageError
        If there are several people, but not one for each human of the team.
    """

    def __init__(self, course: Course, people: Sequence[Person]) -> None:
        self._course, self._people = course, people
        self._others = _steps_of_others(course.setting, people)
        self._impossible: set[GroundAtom] = set()
        self._moved: set[int] = set()  # those who have not thought about the robot's last step yet

    @property
    def names(self) -> str:
        """Who they are, for the trace."""
        return ", ".join(person.name for person in self._people)

    @property
    def origin(self) -> Origin:
        """Whether they are real people."""
        return self._people[0].origin

    @property
    def want_nothing(self) -> bool:
        """Whether nobody has asked for anything and not got it."""
        return all(person.request is None for person in self._people)

    def act(self, refuse: Refuse) -> GroundAtom:
        """Return a step that somebody takes of their own accord: who wants nothing yet, or thinks it over."""
        for number, person in enumerate(self._people):
            if person.request is None or (number in self._moved and person.thinks_over()):
                self._moved.discard(number)
                if asked := self._ask(number, refuse):
                    return asked
        return ()

    def choose(self, refuse: Refuse) -> GroundAtom:
        """Ask one after the other for a step that is possible; empty if nobody wants one."""
        return next(filter(None, (self._ask(number, refuse) for number in range(len(self._people)))), ())

    def _ask(self, number: int, refuse: Refuse) -> GroundAtom:
        """Ask one for a step until they name one that is possible, or none."""
        person, others = self._people[number], self._others[number]
        while asked := person.choose(self._course.refused | self._impossible | others):
            if asked in self._impossible or asked in others:
                return ()  # the person does not listen
            if self._course.is_step_of_person(asked) and self._course.allows(asked):
                return asked
            refuse(asked)
            self._impossible.add(asked)
        return ()

    def see(self, action: GroundAtom, before: State, *, ask: bool) -> list[Notice]:
        """Let all see a step that was taken; return their answers, if asked."""
        answers = []
        for number, person in enumerate(self._people):
            answer = person.judge(action, before) if ask else None
            if answer is not None:
                who = person.name if len(self._people) > 1 else ""
                answers.append(Notice(Event.ANSWER_GIVEN, action, answer=answer, agent=who))
            person.watch(action, before, self._course.state)
            (self._moved.add if ask else self._moved.discard)(number)
        self._impossible.clear()
        return answers

    def give_up(self, request: Request) -> None:
        """Tell all that a request can't be fulfilled."""
        for person in self._people:
            person.give_up(request)


def _steps_of_others(setting: Setting, people: Sequence[Person]) -> list[frozenset[GroundAtom]]:
    """Return for each of several people the human steps that are not theirs; none if there is one alone."""
    humans = [agent.name for agent in setting.problem.agents if agent.kind == "human"]
    if len(people) == 1:
        return [frozenset()]
    if len(people) != len(humans):
        raise UsageError(f"people are needed for {', '.join(humans) or 'nobody'}, not {len(people)} of them")
    agent_of = setting.problem.agent_of
    actions = set(setting.truth.task.actions) - {()}
    owners = {action: agent_of(action).name for action in actions}
    return [frozenset(step for step in actions if owners[step] in set(humans) - {name}) for name in humans]
