"""Showing plans to simulated participants: what they say of plans that are like none of their games."""

from collections.abc import Sequence

from explicable.execution.episodes import assign, judge
from explicable.execution.participants import Family
from explicable.execution.setting import prepare
from explicable.labelling.traces import Trace
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem


def show(
    problem: TeamProblem,
    plans: Sequence[Sequence[GroundAtom]],
    family: Family,
    *,
    num_traces: int = 8,
    seed: int = 0,
) -> list[Trace]:
    """Let participants watch joint plans and label the robots' steps.

    Labels of the plans that a planner makes teach what games, in which the robot follows, never show. Each
    participant watches every plan once; they are those of `simulate_study` with the same seed.

    Parameters
    ----------
    problem
        The team problem.
    plans
        Executable from its initial state; they need not reach the goal.
    num_traces
        How many labelled plans to return.

    Raises
    ------
    PlanError
        If a step can't be executed; the message gives its number.

    Examples
    --------
    >>> from explicable.execution import builtin_families
    >>> from explicable.first_response import World, encode
    >>> plan = [("move", "r1", "c-0-0", "c-0-1"), ("move", "r1", "c-0-1", "c-0-0")]
    >>> problem = encode(World(("@.*",)), "persistent")
    >>> traces = show(problem, [plan], builtin_families()["mission"], num_traces=3)
    >>> [trace.annotator for trace in traces]
    ['simulated-mission-1', 'simulated-mission-2', 'simulated-mission-3']
    """
    import numpy as np

    setting = prepare(problem)
    traces = []
    for game, (place, number) in enumerate(assign(len(plans), num_traces, games_each=len(plans))):
        participant = family.draw(number + 1, np.random.default_rng((seed, 0, number)))
        steps = judge(setting, participant, plans[place], np.random.default_rng((seed, 3, game)))
        traces.append(Trace(problem, steps, participant.name, "simulated"))
    return traces
