"""Robot plans that human teammates expect.

The public names, each imported when it is first asked for, so that a small program starts fast.
The function that searches is `explicable.search.search`: its package bears the name here.
"""

from typing import TYPE_CHECKING

from explicable.lazy import lazy_names

if TYPE_CHECKING:
    from explicable.labelling import Labeller, read_traces
    from explicable.model.grounding import ground, ground_team
    from explicable.model.plan import JointPlan, Step, format_plan, read_plan
    from explicable.model.team import Agent, TeamProblem, TeamTask
    from explicable.pddl import read_pair, read_team_problem
    from explicable.planning import (
        HumanModel,
        TeamPlan,
        choose,
        compare,
        conform_or_explain,
        explain,
        front,
        measure,
        plan_classically,
        plan_explicably,
        plan_within_budget,
        rank,
    )
    from explicable.search import Outcome, SearchResult

_HOMES = {
    "Agent": "model.team",
    "HumanModel": "planning",
    "JointPlan": "model.plan",
    "Labeller": "labelling",
    "Outcome": "search",
    "SearchResult": "search",
    "Step": "model.plan",
    "TeamPlan": "planning",
    "TeamProblem": "model.team",
    "TeamTask": "model.team",
    "choose": "planning",
    "compare": "planning",
    "conform_or_explain": "planning",
    "explain": "planning",
    "format_plan": "model.plan",
    "front": "planning",
    "ground": "model.grounding",
    "ground_team": "model.grounding",
    "measure": "planning",
    "plan_classically": "planning",
    "plan_explicably": "planning",
    "plan_within_budget": "planning",
    "rank": "planning",
    "read_pair": "pddl",
    "read_plan": "model.plan",
    "read_team_problem": "pddl",
    "read_traces": "labelling",
}

__all__ = [
    "Agent",
    "HumanModel",
    "JointPlan",
    "Labeller",
    "Outcome",
    "SearchResult",
    "Step",
    "TeamPlan",
    "TeamProblem",
    "TeamTask",
    "choose",
    "compare",
    "conform_or_explain",
    "explain",
    "format_plan",
    "front",
    "ground",
    "ground_team",
    "measure",
    "plan_classically",
    "plan_explicably",
    "plan_within_budget",
    "rank",
    "read_pair",
    "read_plan",
    "read_team_problem",
    "read_traces",
]


__getattr__, __dir__ = lazy_names(__name__, _HOMES)
