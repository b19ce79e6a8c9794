"""Plans for teams, made goal by goal: each goal goes to the robot who has it done soonest.

Searches for a cheap sequence like to give all the work to one robot, whose steps then follow each other. Here
the goals are put into an order, and each in turn goes to the robot by whose way to it, taken beside all that
has been planned so far, it is done soonest: list scheduling (Graham, "Bounds on multiprocessing timing
anomalies", SIAM Journal on Applied Mathematics 17, 1969) with a search for each way. Swapping goals in the
order then looks for a better one.
"""

from collections.abc import Callable, Iterator, Sequence

from explicable.model.durations import Durations
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.schedule import make_schedule
from explicable.model.task import State
from explicable.model.team import TeamTask
from explicable.search import search

_WAY_LIMIT_S = 1.0


class GoalOrders:
    """Makes plans for orders of a task's goals.

    Parameters
    ----------
    team_task
        The task.
    durations
        Of its steps.
    is_time_up
        Asked before each search; when it is, no more plans are made.
    """

    def __init__(self, team_task: TeamTask, durations: Durations, is_time_up: Callable[[], bool]) -> None:
        self.team_task, self.task, self.durations = team_task, team_task.task, durations
        self._is_time_up = is_time_up
        self.robots = [agent.name for agent in team_task.problem.agents if agent.kind == "robot"]
        self._ways: dict[tuple[State, tuple[GroundAtom, ...], str], Actions | None] = {}

    def plans(self) -> Iterator[Actions]:
        """Give a plan for each order tried, until no swap of two goals makes the best one better.

        None at all if the goal is more than a conjunction of atoms, or there is only one robot or goal.
        """
        goals = tuple(self.task.fact(fact) for fact in self.task.goal)
        if (
            len(goals) < 2
            or len(self.robots) < 2
            or any(goal[0] in ("not", "goal achieved") for goal in goals)
        ):
            return
        order, least = goals, None
        is_better = True
        while is_better:
            is_better = False
            for other in [order] if least is None else _swaps(order):
                made = self._make(other)
                if made is None:
                    if self._is_time_up():
                        return
                    continue
                plan, makespan = made
                yield plan
                if least is None or makespan < least:
                    order, least, is_better = other, makespan, True
                    break

    def _make(self, order: Sequence[GroundAtom]) -> tuple[Actions, float] | None:
        """Return a plan that reaches the goals in this order, and its makespan."""
        plan: Actions = ()
        done: tuple[GroundAtom, ...] = ()
        makespan = 0.0
        for goal in order:
            done = (*done, goal)
            state = self.task.execute(plan).states[-1]
            extended = [
                (*self._ends(plan, way), plan + way)
                for robot in self.robots
                if (way := self._way(state, done, robot)) is not None
            ]
            if not extended:
                return None
            _, makespan, plan = min(extended)
        return plan, makespan

    def _ends(self, plan: Actions, way: Actions) -> tuple[float, float]:
        """Return when the last step of a way is done, and the whole, if it is taken beside a plan."""
        if not way:
            return 0.0, 0.0
        schedule = make_schedule(self.team_task.problem, self.task, plan + way, self.durations)
        last = max(number for number, s in enumerate(schedule.steps) if s.step.action == way[-1])
        return schedule.steps[last].end, schedule.makespan

    def _way(self, state: State, goals: tuple[GroundAtom, ...], robot: str) -> Actions | None:
        """Return a way for one robot, and people, to reach goals; None if there is none or no more time."""
        key = (state, goals, robot)
        if key not in self._ways:
            if self._is_time_up():
                return None
            self._ways[key] = self._search(state, goals, robot)
        return self._ways[key]

    def _search(self, state: State, goals: tuple[GroundAtom, ...], robot: str) -> Actions | None:
        # A robot of which nothing is true can do nothing. Where that is not so, or where something needs to
        # be untrue of it, the plan may not be possible for the whole team, and counts as none.
        others = set(self.robots) - {robot}
        alone = self.task.state_of(atom for atom in self.task.atoms(state) if others.isdisjoint(atom[1:]))
        task = self.task.with_goal(goals)
        result = search(task, initial_state=alone, time_limit_s=_WAY_LIMIT_S)
        if result.operators is None:
            return None
        after = state
        for operator in result.operators:
            if not task.is_applicable(after, operator):
                return None
            after = task.successor(after, operator)
        actions = tuple(task.action(operator) for operator in result.operators)
        return actions if task.is_goal(after) else None


def _swaps(order: tuple[GroundAtom, ...]) -> Iterator[tuple[GroundAtom, ...]]:
    for first in range(len(order)):
        for second in range(first + 1, len(order)):
            swapped = list(order)
            swapped[first], swapped[second] = swapped[second], swapped[first]
            yield tuple(swapped)
