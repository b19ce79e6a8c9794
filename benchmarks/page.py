"""Makes `docs/benchmarks.md` from recorded runs and from notes written by hand, and from nothing else.

Usage: `python page.py RECORDS NOTES PAGE`.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import labeller_page
from tables import Records, agile_score, geometric_mean, markdown_table, number, read_records
from targets import rates, ratios, targets

from peers import FD_EAGER, FD_LAZY, LABELLED, OURS, PLAIN, RATE_S, WARM

# FF 2.3 has no package and can't run here. Whole process, CPU seconds, measured on another machine.
FF_QUOTED = {
    "gripper/prob20": 0.006,
    "depot/p07": 0.006,
    "rovers/p20": 0.13,
    "rovers/p30": 0.31,
    "satellite/p15-pfile15": 0.019,
    "satellite/p20-pfile20": 0.35,
    "zenotravel/p20": 0.35,
    "miconic/s30-0": 0.021,
    "freecell/p05": 0.016,
    "tpp/p20": 9.2,
}
FF_QUOTED_TASKS = 33
FF_QUOTED_SCORE = ("28", "27.35")


INTRODUCTION = """# Benchmarks

Made by `make bench` from recorded runs; don't edit by hand. CPU seconds (user and system, child processes
included) and peak resident memory of the largest process; all programs in turns on one pinned core.
Each figure is the median of n = {runs} runs (of slow peers one, see below), with the least and the greatest
in brackets. Limits: {limit:g} s of CPU and {memory} MiB of address space. A plan counts only if a validator
that is independent of explicable (`benchmarks/validate.py`, on Fast Downward's reader) accepts it.

{date}; {machine}; load at the start {load:.1f}; Python {python}; commit {commit}; {versions}.
"""


def write_page(records: Path, notes: Path, page: Path) -> None:
    """Write the whole page."""
    found = read_records(records)
    parts = [_introduction(found), _target_table(found)]
    if notes.is_file():
        parts.append(notes.read_text())
    parts += [part for section in SECTIONS for part in section(found)]
    parts += labeller_page.sections()
    page.write_text("\n".join(parts))


def _introduction(records: Records) -> str:
    header = records.header
    versions = ", ".join(f"{name} {version}" for name, version in header["versions"].items())
    text = INTRODUCTION.format(
        **header
        | {"versions": versions, "memory": header["memory_limit_mib"], "limit": header["cpu_limit_s"]}
    )
    absent = records.of("absent").runs
    lines = [
        f"- Could not be run ({run['task']}): {run['program']}: {run.get('why') or run['outcome']}."
        for run in absent
    ]
    lines += [
        f"- {name}: one run a task" + (f", {seconds:g} s of CPU at most." if seconds else ".")
        for name, seconds in header.get("slow", {}).items()
    ]
    return "\n".join([text, *lines, ""])


def _target_table(records: Records) -> str:
    verdicts = {True: "reached", False: "**missed**", None: "not measured"}
    rows = [[target.aim, target.found, verdicts[target.reached]] for target in targets(records)]
    return "## Targets\n\n" + markdown_table(["target", "found", "verdict"], rows)


def _first_plans(records: Records) -> Iterator[str]:
    runs = records.of("planners")
    if not runs.runs:
        return
    programs = runs.programs()
    yield "## From PDDL text to a first plan\n"
    yield f"CPU seconds. Fresh processes, but for `{WARM}`: the same in a process that has planned before.\n"
    rows = []
    for task in runs.tasks():
        cells = [
            runs.sample(p, task).cell() if runs.sample(p, task) else runs.outcome(p, task) for p in programs
        ]
        rows.append([task, *cells, number(FF_QUOTED[task]) if task in FF_QUOTED else ""])
    yield markdown_table(["task", *programs, "FF 2.3, quoted from another machine"], rows)
    yield "Ratio of CPU times, peer over ours, where both solve: geometric mean [least, greatest], n tasks.\n"
    rows = []
    for program in programs:
        fresh, warm = (ratios(runs, (program, "cpu_s"), (ours, "cpu_s")) for ours in (OURS, WARM))
        rows.append([program, *(_spread(r) for r in (fresh, warm))])
    yield markdown_table(["program", f"over {OURS}", f"over {WARM}"], rows)
    yield _scores(runs, records.header["cpu_limit_s"])
    yield _peaks(runs, programs)
    yield _plan_costs(runs, programs)


def _spread(found: dict[str, float]) -> str:
    if not found:
        return "–"
    low, high = min(found.values()), max(found.values())
    return f"{number(geometric_mean(found.values()))} [{number(low)}, {number(high)}], {len(found)}"


def _scores(runs: Records, limit_s: float) -> str:
    rows = []
    for program in runs.programs():
        samples = [runs.sample(program, task) for task in runs.tasks()]
        score = sum(agile_score(sample, limit_s) for sample in samples)
        rows.append([program, str(sum(map(bool, samples))), f"{score:.2f}"])
    rows.sort(key=lambda row: -float(row[2]))
    rows.append(
        [
            f"FF 2.3, quoted: {FF_QUOTED_TASKS} tasks of the planning competitions, another machine",
            *FF_QUOTED_SCORE,
        ]
    )
    head = f"{len(runs.tasks())} tasks; 1 if solved within 1 s of CPU, else 1 - log T / log {limit_s:g}.\n\n"
    return (
        "## Coverage and agile score\n\n" + head + markdown_table(["program", "solved", "agile score"], rows)
    )


def _peaks(runs: Records, programs: list[str]) -> str:
    rows = []
    for task in runs.tasks():
        cells = [runs.sample(p, task, "peak_mib").cell() for p in programs if p != WARM]
        rows.append([task, *cells, runs.sample(FD_LAZY, task, "search_peak_mib").cell()])
    head = "## Peak memory\n\nMiB; the interpreter of ours and of most peers included.\n\n"
    return head + markdown_table(
        ["task", *(p for p in programs if p != WARM), f"{FD_LAZY}, search only"], rows
    )


def _plan_costs(runs: Records, programs: list[str]) -> str:
    rows = []
    for task in runs.tasks():
        costs = [runs.sample(p, task, "plan_cost") for p in programs]
        rows.append([task, *(number(c.median) if c else "–" for c in costs)])
    return "## Costs of the first plans\n\n" + markdown_table(["task", *programs], rows)


def _rates(records: Records) -> Iterator[str]:
    runs = records.of("rate")
    if not runs.runs:
        return
    ours, theirs = rates(runs, OURS), rates(runs, FD_EAGER)
    yield "## Evaluations per second\n"
    yield "Thousands; eager greedy best-first search with the FF heuristic, all costs one,"
    yield f"{RATE_S} s at most. Set-up of the heuristic included.\n"
    rows = []
    for task in runs.tasks():
        mine, other = ours.get(task), theirs.get(task)
        ratio = number(mine / other) if mine and other else "–"
        counts = [runs.sample(p, task, "evaluations") for p in (OURS, FD_EAGER)]
        rows.append(
            [
                task,
                *(number(r / 1000) if r else "–" for r in (mine, other)),
                ratio,
                *(c.cell() for c in counts),
            ]
        )
    yield markdown_table(
        ["task", OURS, FD_EAGER, "ratio", "evaluations, ours", f"evaluations, {FD_EAGER}"], rows
    )


def _grounding(records: Records) -> Iterator[str]:
    runs = records.of("grounding")
    if not runs.runs:
        return
    programs = runs.programs()
    yield "## Reading and grounding\n"
    yield "Milliseconds of CPU in a warm process. FD translate: up to the instantiated actions, without its"
    yield "finite-domain variables.\n"
    rows = [
        [t, *(runs.sample(p, t).cell(1000) if runs.sample(p, t) else runs.outcome(p, t) for p in programs)]
        for t in runs.tasks()
    ]
    yield markdown_table(["task", *programs], rows)


def _growth(records: Records) -> Iterator[str]:
    runs = records.of("growth")
    if not runs.runs:
        return
    programs = runs.programs()
    yield "## Growth with size\n"
    yield "Fresh processes; CPU seconds and peak MiB.\n"
    rows = []
    for task in runs.tasks():
        seconds = [
            runs.sample(p, task).cell() if runs.sample(p, task) else runs.outcome(p, task) for p in programs
        ]
        rows.append([task, *seconds, *(runs.sample(p, task, "peak_mib").cell() for p in programs)])
    yield markdown_table(["task", *(f"{p}, s" for p in programs), *(f"{p}, MiB" for p in programs)], rows)


def _labelled(records: Records) -> Iterator[str]:
    runs = records.of("labelled")
    if not runs.runs:
        return
    plain, with_labels = rates(runs, PLAIN), rates(runs, LABELLED)
    yield "## Search with a labeller\n"
    yield "Eager greedy search, five seeds of 5000 evaluations at most; CPU time. The labeller is trained on"
    yield "plans of the task whose labels are drawn at random: only its time counts here."
    yield "Commit {commit}, {date}, load {load:.1f}; n = {runs} runs.\n".format(**runs.header)
    rows = []
    for task in runs.tasks():
        mine, other = with_labels.get(task), plain.get(task)
        if mine and other:
            figures = (other / 1000, mine / 1000, mine / other, 1e6 / mine - 1e6 / other)
            rows.append([task, *map(number, figures)])
    head = ["task", "thousand evaluations a second, plain", "labelled", "ratio", "added, us an evaluation"]
    yield markdown_table(head, rows)


def _crf(records: Records) -> Iterator[str]:
    runs = records.of("crf")
    if not runs.runs:
        return
    yield "## Training a conditional random field\n"
    yield "34 traces, each with 1000 permutations of its symbols; 100 iterations of L-BFGS."
    yield "Memory beyond that of an idle interpreter.\n"
    figures = {
        "reading, s": "read_s",
        "training, s": "train_s",
        "memory, MiB": "memory_mib",
        "loss": "loss",
        "weights": "weights",
    }
    rows = [[p, *(runs.sample(p, "", f).cell() for f in figures.values())] for p in runs.programs()]
    yield markdown_table(["program", *figures], rows)


SECTIONS = (_first_plans, _rates, _grounding, _growth, _labelled, _crf)

if __name__ == "__main__":
    write_page(*map(Path, sys.argv[1:]))
