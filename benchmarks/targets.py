"""The targets of the planner and of the labeller, each judged by the recorded runs alone."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

from tables import Records, agile_score, geometric_mean, number
from tasks import GROUNDING_TASKS, LARGE_MAP

from peers import CRFSUITE, FD_EAGER, FD_LAZY, LABELLED, OURS, PLAIN, WARM


@dataclass(frozen=True, slots=True)
class Target:
    """What was to be reached and what was; `reached` is None where the runs don't say."""

    aim: str
    found: str
    reached: bool | None


def ratios(records: Records, over: tuple[str, str], under: tuple[str, str]) -> dict[str, float]:
    """For every task that both programs solved: the figure of the one over the figure of the other.

    `over` and `under` name a program and its figure.
    """
    found = {}
    for task in records.tasks():
        above, below = records.sample(over[0], task, over[1]), records.sample(under[0], task, under[1])
        if above and below:
            found[task] = above.median / max(below.median, 1e-6)
    return found


def rates(records: Records, program: str) -> dict[str, float]:
    """Collect evaluations per second, the median over the runs, by task."""
    found = {}
    for task in records.tasks():
        evaluations, seconds = (records.sample(program, task, f).values for f in ("evaluations", "search_s"))
        if evaluations:
            found[task] = median(e / max(s, 1e-6) for e, s in zip(evaluations, seconds, strict=True))
    return found


def targets(records: Records) -> Iterator[Target]:
    """All targets, in the order of the page."""
    yield from _rate(records.of("rate"))
    planners = records.of("planners")
    yield from _first_plan(planners)
    yield from _competition(planners, records.header["cpu_limit_s"])
    yield _memory(planners)
    yield from _grounding(records.of("grounding"))
    yield _large_map(records.of("growth"))
    yield _labelled_rate(records.of("labelled"))
    yield from _labeller(records.of("crf"))


def _least(found: dict[str, float]) -> str:
    task = min(found, key=found.__getitem__)
    return f"{number(found[task])} ({task})"


def _greatest(found: dict[str, float]) -> str:
    task = max(found, key=found.__getitem__)
    return f"{number(found[task])} ({task})"


def _rate(records: Records) -> Iterator[Target]:
    ours, theirs = rates(records, OURS), rates(records, FD_EAGER)
    found = {task: ours[task] / theirs[task] for task in ours.keys() & theirs.keys()}
    mean = geometric_mean(found.values())
    least = min(found.values(), default=math.nan)
    text = (
        f"least {_least(found)}, geometric mean {number(mean)} (n = {len(found)})"
        if found
        else "not measured"
    )
    yield Target(
        "evaluations per second over FD's, on every task at least 1", text, least >= 1 if found else None
    )
    yield Target("the same, geometric mean at least 1.5", text, mean >= 1.5 if found else None)


def _first_plan(records: Records) -> Iterator[Target]:
    found = ratios(records, (FD_LAZY, "cpu_s"), (WARM, "cpu_s"))
    mean = geometric_mean(found.values())
    text = (
        f"least {_least(found)}, geometric mean {number(mean)} (n = {len(found)})"
        if found
        else "not measured"
    )
    reached = min(found.values()) > 1 if found else None
    yield Target("FD's time from text to first plan over ours (warm), on every task above 1", text, reached)
    yield Target("the same, geometric mean at least 10", text, mean >= 10 if found else None)
    added = {}
    for task in records.tasks():
        fresh, warm = records.sample(OURS, task), records.sample(WARM, task)
        if fresh and warm:
            added[task] = fresh.median - warm.median
    text = (
        f"median {number(median(added.values()))} s, greatest {_greatest(added)} s"
        if added
        else "not measured"
    )
    yield Target(
        "a fresh process adds at most 0.15 s", text, median(added.values()) <= 0.15 if added else None
    )


def _competition(records: Records, limit_s: float) -> Iterator[Target]:
    tasks, programs = records.tasks(), [p for p in records.programs() if p != WARM]
    scores = {p: sum(agile_score(records.sample(p, t), limit_s) for t in tasks) for p in programs}
    peers = {p: score for p, score in scores.items() if p != OURS}
    if OURS not in scores or not peers:
        yield Target("agile score above every peer's", "not measured", None)
        return
    best = max(peers, key=peers.__getitem__)
    text = f"{scores[OURS]:.2f} against {peers[best]:.2f} ({best}) of {len(tasks)}"
    yield Target("agile score above every peer's", text, scores[OURS] > peers[best])
    solved = {p: {t for t in tasks if records.sample(p, t)} for p in programs}
    missed = sorted((solved.get(FD_LAZY, set()) | solved.get("mimir", set())) - solved[OURS])
    text = f"{len(solved[OURS])} of {len(tasks)} solved; missing: {', '.join(missed) or 'none'}"
    yield Target(f"within {limit_s:g} s every task that FD lazy or mimir solves", text, not missed)


def _memory(records: Records) -> Target:
    found = ratios(records, (OURS, "peak_mib"), (FD_LAZY, "search_peak_mib"))
    whole = ratios(records, (OURS, "peak_mib"), (FD_LAZY, "peak_mib"))
    if not found:
        return Target("peak memory over that of FD's search at most 1", "not measured", None)
    search, all_of_it = (
        f"greatest {_greatest(r)}, geometric mean {number(geometric_mean(r.values()))}"
        for r in (found, whole)
    )
    text = f"{search}; over FD's translate and search: {all_of_it}"
    return Target("peak memory over that of FD's search at most 1", text, max(found.values()) <= 1)


def _grounding(records: Records) -> Iterator[Target]:
    for task in GROUNDING_TASKS:
        sample = records.sample(OURS, task)
        text = f"{sample.cell(1000)} ms" if sample else "not measured"
        yield Target(
            f"reading and grounding {task} within 50 ms", text, sample.median <= 0.05 if sample else None
        )


def _large_map(records: Records) -> Target:
    seconds, peak = records.sample(OURS, LARGE_MAP), records.sample(OURS, LARGE_MAP, "peak_mib")
    aim = "a 200x200 map with 20 marks within 5 s and 1 GiB"
    if not seconds:
        return Target(
            aim, records.outcome(OURS, LARGE_MAP) or "not measured", False if records.runs else None
        )
    return Target(aim, f"{seconds.cell()} s, {peak.cell()} MiB", seconds.median <= 5 and peak.median <= 1024)


def _labelled_rate(records: Records) -> Target:
    plain, with_labels = rates(records, PLAIN), rates(records, LABELLED)
    found = {task: with_labels[task] / plain[task] for task in with_labels.keys() & plain.keys()}
    aim = "evaluations per second with a labeller over those without, on every task at least 0.75"
    if not found:
        return Target(aim, "not measured", None)
    mean = number(geometric_mean(found.values()))
    text = f"least {_least(found)}, geometric mean {mean} (n = {len(found)})"
    return Target(aim, text, min(found.values()) >= 0.75)


def _labeller(records: Records) -> Iterator[Target]:
    faster = ratios(records, (CRFSUITE, "train_s"), (OURS, "train_s"))
    smaller = ratios(records, (CRFSUITE, "memory_mib"), (OURS, "memory_mib"))
    for aim, found, least in (
        ("training on 34 034 sequences: CRFsuite's time over ours at least 2", faster, 2),
        ("training on 34 034 sequences: CRFsuite's memory over ours above 1", smaller, 1),
    ):
        text = number(next(iter(found.values()))) if found else "not measured"
        yield Target(aim, text, next(iter(found.values())) >= least if found else None)
