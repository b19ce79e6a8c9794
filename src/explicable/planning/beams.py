"""Beams over sequences of steps, for schedules that end soon.

A step counts by when it can be done at the earliest, beside what is already under way
(`explicable.model.schedule`). Steps are appended in the order of their start times, which loses nothing: a
schedule made from its own order of start times starts no step later. So a node is a state, and for each fact
and agent the times that constrain what follows.

Its bound is the critical path of the delete relaxation from there (h^max with durations; Haslum & Geffner,
"Heuristic planning with time and resources", ECP 2001): no schedule that goes on from the node ends sooner.
Beams of growing width keep the nodes whose goals are, in that relaxation, reached soonest on average; a beam
that had to drop no node has proved the least makespan.
"""

import time
from collections.abc import Iterator

from explicable.model.team import TeamTask
from explicable.planning.best_schedule import BestSchedule
from explicable.planning.relaxed_times import Node, RelaxedTimes, Timetable

_FIRST_WIDTH = 4
_GROWTH = 4


class Beams:
    """Passes of growing width; each prunes by what the ones before have found.

    Parameters
    ----------
    best
        Takes every plan that is found.
    deadline
        Reading of `time.perf_counter` at which the search ends.
    """

    def __init__(self, team_task: TeamTask, best: BestSchedule, deadline: float) -> None:
        self.task, self.best, self.deadline = team_task.task, best, deadline
        self.timetable = Timetable(team_task, best.durations)
        self.relaxed = RelaxedTimes(self.timetable)
        self.lower_bound = 0.0
        self.num_nodes = 0

    def run(self, max_width: int) -> float:
        """Widen the beam until the least makespan is proved, or the time or the width is spent."""
        root = self.timetable.root()
        self.lower_bound = min(float(self.relaxed.rate([root])[0][0]), self.best.least_makespan)
        width = _FIRST_WIDTH
        while self.lower_bound < self.best.least_makespan - 1e-9 and width <= max_width:
            is_complete = self._pass(root, width)
            if time.perf_counter() >= self.deadline:
                break
            if is_complete and self.timetable.is_exact:
                self.lower_bound = self.best.least_makespan
            if is_complete:
                break
            width *= _GROWTH
        return self.lower_bound

    def _pass(self, root: Node, width: int) -> bool:
        """Run one beam; True if it had to drop no node."""
        layer, is_complete = [root], True
        known: dict[bytes, list[Node]] = {}
        while layer and time.perf_counter() < self.deadline:
            children = list(self._children(layer, known))
            if not children:
                break
            self.num_nodes += len(children)
            bounds, guides = self.relaxed.rate(children)
            order = sorted(
                (number for number in range(len(children)) if bounds[number] < self._limit()),
                key=lambda number: (guides[number], number),
            )
            is_complete = is_complete and len(order) <= width
            layer = [children[number] for number in order[:width]]
        return is_complete

    def _limit(self) -> float:
        """Nodes that end no sooner are of no use."""
        return self.best.objective - 1e-9

    def _children(self, layer: list[Node], known: dict[bytes, list[Node]]) -> Iterator[Node]:
        for node in layer:
            if time.perf_counter() >= self.deadline:
                return
            for child in self.timetable.children(node):
                if self.task.is_goal(child.state):
                    if child.makespan < self._limit():
                        self.best.consider(child.actions(self.task.action))
                elif not _is_dominated(child, known.setdefault(child.state, [])):
                    yield child


def _is_dominated(node: Node, others: list[Node]) -> bool:
    """Whether another node of the same state constrains what follows no more; notes the node if not."""
    if any(other.precedes(node) for other in others):
        return True
    others.append(node)
    return False
