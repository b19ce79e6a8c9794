"""What is measured inside a warm process, ours and the peers': each probe prints one JSON object.

Usage: `python probes.py PROBE DOMAIN PROBLEM [ARGUMENT ...]`. What a probe needs is imported, and ours has
solved a tiny task, before the clock starts. CPU seconds are user and system time of this process and its
children.
"""

import json
import resource
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

TINY_DOMAIN = """(define (domain tiny) (:requirements :strips) (:predicates (on) (done))
(:action start :parameters () :precondition (and) :effect (on))
(:action finish :parameters () :precondition (on) :effect (done)))"""
TINY_PROBLEM = "(define (problem tiny) (:domain tiny) (:objects) (:init) (:goal (done)))"


def cpu_s() -> float:
    """CPU seconds used so far by this process and its children."""
    used = (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in used)


def plan(domain: Path, problem: Path) -> dict:
    """PDDL text to first plan with the default search; off the clock, the plan is executed and written."""
    from explicable.model.grounding import ground
    from explicable.model.plan import format_plan
    from explicable.pddl import parse_domain, parse_problem, read_pair
    from explicable.search import search

    search(ground(parse_problem(TINY_PROBLEM, parse_domain(TINY_DOMAIN))))
    start = cpu_s()
    read = read_pair(domain, problem)
    read_end = cpu_s()
    task = ground(read)
    ground_end = cpu_s()
    result = search(task)
    end = cpu_s()
    if result.operators is not None:
        actions = [task.action(operator) for operator in result.operators]
        execution = task.execute(actions)
        assert task.is_goal(execution.states[-1])
        Path("plan").write_text(format_plan(actions, result.cost))
    return {
        "cpu_s": end - start,
        "read_s": read_end - start,
        "ground_s": ground_end - read_end,
        "search_s": end - ground_end,
        "evaluations": result.evaluations,
    }


def rate(domain: Path, problem: Path, seconds: str) -> dict:
    """Eager greedy best-first search with the FF heuristic, all costs one, for so many seconds at most."""
    from explicable.model.grounding import ground
    from explicable.pddl import read_pair
    from explicable.search import search

    task = ground(read_pair(domain, problem))
    start = cpu_s()
    result = search(task, "eager", time_limit_s=float(seconds))
    return {"evaluations": result.evaluations, "search_s": cpu_s() - start}


def labelled(domain: Path, problem: Path, with_scorer: str) -> dict:
    """Eager greedy search, plain or with a labeller that scores the path and relaxed plan.

    The labeller learns from four plans of the task itself, whose labels are drawn at random: only its time
    counts here, and so every feature gets a weight.
    """
    import numpy as np

    from explicable.labelling import LabelledStep, Labeller, Trace
    from explicable.model.grounding import ground_team
    from explicable.model.team import TeamProblem
    from explicable.pddl import read_pair
    from explicable.search import search

    team_problem = TeamProblem(read_pair(domain, problem))
    team = ground_team(team_problem)
    scorer = None
    if with_scorer == "yes":
        rng = np.random.default_rng(0)
        traces = []
        for seed in range(4):
            actions = map(team.task.action, search(team.task, seed=seed).operators or ())
            steps = [
                LabelledStep(team_problem.agent_of(action).name, action, bool(rng.random() < 0.7))
                for action in actions
            ]
            traces.append(Trace(team_problem, tuple(steps), "nobody", "simulated"))
        scorer = Labeller.train(traces, num_bootstrap=0).scorer(team)
    start = cpu_s()
    evaluations = 0
    for seed in range(1, 6):
        evaluations += search(team.task, "eager", scorer=scorer, max_evaluations=5000, seed=seed).evaluations
    return {"evaluations": evaluations, "search_s": cpu_s() - start}


def ground(domain: Path, problem: Path) -> dict:
    """Read and ground."""
    from explicable.model.grounding import ground
    from explicable.pddl import parse_domain, parse_problem, read_pair

    ground(parse_problem(TINY_PROBLEM, parse_domain(TINY_DOMAIN)))
    start = cpu_s()
    task = ground(read_pair(domain, problem))
    return {"cpu_s": cpu_s() - start, "operators": task.num_operators}


def ground_fd(domain: Path, problem: Path) -> dict:
    """Fast Downward's translator up to the instantiated actions, without its finite-domain variables."""
    from fast_downward.translate import instantiate, normalize, options, pddl_parser

    options.set_options([str(domain), str(problem)])
    with redirect_stdout(StringIO()):
        start = cpu_s()
        task = pddl_parser.open(domain_filename=str(domain), problem_filename=str(problem))
        normalize.normalize(task)
        _, _, actions, *_ = instantiate.explore(task)
        return {"cpu_s": cpu_s() - start, "operators": len(actions)}


def ground_mimir(domain: Path, problem: Path) -> dict:
    """Mimir: reading, and its search context over a grounded task."""
    from pymimir import Domain, Problem

    start = cpu_s()
    Problem(Domain(domain), problem, mode="grounded")
    return {"cpu_s": cpu_s() - start}


def ground_tarski(domain: Path, problem: Path) -> dict:
    """Tarski's reader, and its grounding as a logic program by clingo."""
    from tarski.grounding import LPGroundingStrategy
    from tarski.io import PDDLReader

    start = cpu_s()
    reader = PDDLReader(raise_on_error=True)
    reader.parse_domain(str(domain))
    actions = LPGroundingStrategy(reader.parse_instance(str(problem))).ground_actions()
    return {"cpu_s": cpu_s() - start, "operators": sum(map(len, actions.values()))}


def plan_mimir(domain: Path, problem: Path) -> dict:
    """Mimir as a planner: lazy greedy best-first search with the FF heuristic and its preferred actions."""
    from pymimir import Domain, FFHeuristic, Problem, gbfs_lazy

    task = Problem(Domain(domain), problem, mode="grounded")
    result = gbfs_lazy(task, task.get_initial_state(), FFHeuristic(task))
    if result.solution is not None:
        Path("plan").write_text("".join(f"{action}\n" for action in result.solution))
    return {}


PROBES: dict[str, Callable[..., dict]] = {
    probe.__name__: probe
    for probe in (plan, rate, labelled, ground, ground_fd, ground_mimir, ground_tarski, plan_mimir)
}

if __name__ == "__main__":
    name, domain_name, problem_name, *arguments = sys.argv[1:]
    report = PROBES[name](Path(domain_name), Path(problem_name), *arguments)
    sys.stdout.write("\n" + json.dumps(report) + "\n")
