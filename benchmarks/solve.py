"""Runs a program on a task, checks its plan, and says what happened as one flat record."""

import json
import shutil
import signal
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from measure import Cost, Limits, measure
from tasks import BenchmarkTask

from peers import HERE, Peers, Program


def solve(
    program: Program,
    task: BenchmarkTask | None,
    peers: Peers,
    limits: Limits,
    verdicts: dict[tuple[str, str], dict],
) -> dict:
    """Run all stages within one CPU limit.

    `outcome` is `solved` (by a valid plan, or by giving its figures where no plan is asked for), `limit`,
    `invalid` (the plan) or `failed`; `why` says more about the last two. `verdicts` keeps what the validator
    said of the text of a plan for a task, and is added to.
    """
    record: dict = {"program": program.name, "task": task.name if task else ""}
    with TemporaryDirectory(prefix="explicable-bench-") as folder:
        cwd = Path(folder)
        if task:
            shutil.copyfile(task.domain, cwd / "domain.pddl")
            shutil.copyfile(task.problem, cwd / "problem.pddl")
        if program.most_cpu_s is not None:
            limits = replace(limits, cpu_s=min(limits.cpu_s, program.most_cpu_s))
        costs = _run_stages(program, cwd, limits)
        for name, cost in costs.items():
            record |= {f"{name}_cpu_s": cost.cpu_s, f"{name}_peak_mib": cost.peak_mib}
        record["cpu_s"] = sum(cost.cpu_s for cost in costs.values())
        record["wall_s"] = sum(cost.wall_s for cost in costs.values())
        record["peak_mib"] = max(cost.peak_mib for cost in costs.values())
        return record | _outcome(program, task, cwd, costs, peers, limits, verdicts)


def _run_stages(program: Program, cwd: Path, limits: Limits) -> dict[str, Cost]:
    costs: dict[str, Cost] = {}
    left_s = limits.cpu_s
    for stage in program.stages:
        within = Limits(limits.core, left_s, limits.memory_bytes)
        costs[stage.name] = cost = measure(list(stage.command), cwd=cwd, limits=within, stdin=stage.stdin)
        left_s -= cost.cpu_s
        if cost.exit_code != 0 or left_s <= 0:
            break
    return costs


def _outcome(
    program: Program,
    task: BenchmarkTask | None,
    cwd: Path,
    costs: dict[str, Cost],
    peers: Peers,
    limits: Limits,
    verdicts: dict[tuple[str, str], dict],
) -> dict:
    last = costs[next(reversed(costs))]
    complete = len(costs) == len(program.stages)
    found = complete and program.plan and (cwd / program.plan).is_file()
    figures = program.read(costs) if program.read and complete else {}
    used_s = sum(cost.cpu_s for cost in costs.values())
    judged = {}
    if task and program.plan and found and used_s <= limits.cpu_s:
        key = task.name, (cwd / program.plan).read_text(errors="replace")
        if key not in verdicts:
            verdicts[key] = validate(peers, cwd, program.plan, limits.core)
        judged = verdicts[key]
    if judged.get("valid") or (figures and not program.plan):
        return figures | judged | {"outcome": "solved"}
    stopped = last.exit_code in {
        -signal.SIGXCPU,
        -signal.SIGKILL,
    }  # by the limits; a plan left behind may be torn
    if stopped or used_s >= 0.97 * limits.cpu_s:
        return {"outcome": "limit"}
    if judged:
        return judged | {"outcome": "invalid"}
    return {"outcome": "failed", "why": _why(last)}


def validate(peers: Peers, cwd: Path, plan: str, core: int) -> dict:
    """Ask the independent validator about a plan file."""
    command = [peers.python, str(HERE / "validate.py"), "domain.pddl", "problem.pddl", plan]
    judged = measure(command, cwd=cwd, limits=Limits(core, cpu_s=300))
    if judged.exit_code != 0:
        return {"valid": False, "why": f"the validator failed, {_why(judged)}"}
    return json.loads(judged.stdout.splitlines()[-1])


def _why(cost: Cost) -> str:
    lines = [line for line in (cost.stderr or cost.stdout).splitlines() if line.strip()]
    message = lines[-1].replace(str(HERE.parent), ".")[:200] if lines else "no message"
    return f"exit code {cost.exit_code}: {message}"
