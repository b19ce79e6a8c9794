"""`explicable team`: who is in a team, who does what, and where its two models differ."""

import json
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import TeamProblemPaths, team_problem_arguments, warn_of_hopeless
from explicable.cli.outcomes import json_option
from explicable.cli.printing import complain, echo
from explicable.errors import ConflictError

if TYPE_CHECKING:
    from explicable.model.team import TeamTask

_TITLES = {
    "tellable": "What the robots know and the person does not (`explicable tell` can tell it)",
    "names": "Names that only one of the two models has",
    "goals": "Goals that differ: the robots' is the team's",
    "human_actions": "Humans' actions that differ: the person's are the team's",
}


@click.command()
@team_problem_arguments
@json_option
def team(paths: TeamProblemPaths, as_json: bool) -> int:
    """Show the team of DOMAIN PROBLEM: its agents, their actions, and where the two models differ.

    Differences are what explicable planning is about; conflicts, names that the two use for different things,
    are refused by every command. Here all are listed, and the exit code is 3.
    """
    from explicable.model.grounding import ground_team

    try:
        problem = paths.read()
    except ConflictError as error:
        if as_json:
            echo(json.dumps({"conflicts": [str(conflict) for conflict in error.conflicts]}))
        for conflict in error.conflicts:
            complain(conflict)
        return EXIT_BAD_INPUT
    record = describe_team(warn_of_hopeless(ground_team(problem)))
    if as_json:
        echo(json.dumps(record))
    else:
        _print_team(record)
    return 0


def describe_team(team_task: "TeamTask") -> dict[str, Any]:
    """The object that `team --json` prints."""
    from explicable.planning import compare

    problem, task = team_task.problem, team_task.task
    actions: dict[str, dict[str, None]] = {agent.name: {} for agent in problem.agents}
    for operator in range(task.num_operators):
        if action := task.action(operator):
            actions[problem.agent_of(action).name][action[0]] = None
    comparison = compare(problem)
    return {
        "agents": [
            {"name": agent.name, "kind": agent.kind, "actions": sorted(actions[agent.name])}
            for agent in problem.agents
        ],
        "goal_reachable": {
            "robots": task.goal_reachable,
            "human": team_task.mental.goal_reachable,
        },
        "differences": {
            name: [str(difference) for difference in getattr(comparison, name)] for name in _TITLES
        },
        "conflicts": [],
    }


def _print_team(record: dict[str, Any]) -> None:
    for agent in record["agents"]:
        does = ", ".join(agent["actions"]) or "can do nothing here"
        echo(f"{agent['kind']:6} {agent['name']}: {does}")
    if all(agent["kind"] == "robot" for agent in record["agents"]):
        echo("Nobody is a human: an action is a human's if its first parameter is of type human.")
    for side, reachable in record["goal_reachable"].items():
        if not reachable:
            whose = "robots' own" if side == "robots" else "human"
            echo(f"In the {whose} model the goal can't be reached.")
    for name, title in _TITLES.items():
        found = record["differences"][name]
        if found:
            echo(f"\n{title}: {len(found)}")
            for text in found:
                echo(f"  {text}")
    if not any(record["differences"].values()):
        echo("\nThe two models are the same.")
