"""What the paper's effect comes to: more F than FF's plan, as much as participants', hardly more length."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from explicable.evaluation.answers.plan_cells import TITLES, Cells, extra_cost, percent
from explicable.evaluation.answers.rows import Row, judged, labelled
from explicable.evaluation.page import Table, format_estimate
from explicable.evaluation.statistics import Estimate, estimate, estimate_difference

MIN_GAIN, MAX_EXTRA = 0.10, 0.05
"""What the paper's effect comes to: so much more F than FF's plan, at so much more cost than the shortest."""


@dataclass(frozen=True, slots=True)
class PaperEffect:
    """What the paper's effect comes to for one plan in one cell."""

    cell: str
    name: str
    over_ff: tuple[Estimate, Estimate]  # in F, by the labeller and by judges
    over_own: tuple[Estimate, Estimate]
    extra: Estimate


def find_effects(cells: Cells) -> list[PaperEffect]:
    """Hold each explicable planner against FF, the participants and the shortest plan."""
    return [
        PaperEffect(cell, name, over_ff, over_own, extra_cost(plans[name], plans["shortest"]))
        for cell, plans in cells.items()
        if plans.keys() >= {"ff", "participants", "shortest"}
        for name in plans
        if name not in {"ff", "participants", "shortest"}
        for over_ff, over_own in [
            (_gains(plans[name], plans["ff"]), _gains(plans[name], plans["participants"]))
        ]
    ]


def _gains(rows: Sequence[Row], others: Sequence[Row]) -> tuple[Estimate, Estimate]:
    """Estimate how much more F plans have than others, to the labeller and to participants who judge."""
    by_labeller = estimate_difference(labelled(rows, "f_paper"), labelled(others, "f_paper"))
    return by_labeller, estimate_difference(judged(rows), judged(others))


def say_effects(effects: Sequence[PaperEffect]) -> Iterator[tuple[str, str]]:
    """Say of each planner, by name, in how many cells each part of the paper's effect is reached."""
    for name in dict.fromkeys(effect.name for effect in effects):
        mine = [effect for effect in effects if effect.name == name]
        above_ff = [sum(effect.over_ff[who].value >= MIN_GAIN for effect in mine) for who in (0, 1)]
        above_own = [sum(effect.over_own[who].value >= 0.0 for effect in mine) for who in (0, 1)]
        num_short = sum(effect.extra.value <= MAX_EXTRA for effect in mine)
        cells = f"of {len(mine)} cell{'s' if len(mine) > 1 else ''}"
        yield (
            name,
            f"Plan “{TITLES[name]}”: F is at least 0.10 above that of FF's plan in {above_ff[0]} {cells} to"
            f" the labeller, in {above_ff[1]} to participants who judge; at least that of participants' own"
            f" plans in {above_own[0]} and {above_own[1]}; at most 5 % longer than the shortest in"
            f" {num_short}.",
        )


def say_gains(cells: Cells) -> Iterator[tuple[str, str]]:
    """Say, by name, what each explicable planner gains over FF's plan, and at what length."""
    for cell, plans in cells.items():
        for name, rows in plans.items():
            if name in {"ff", "shortest", "participants"} or "ff" not in plans:
                continue
            text = (
                f"{cell}: plan “{TITLES[name]}” has F {format_estimate(estimate(judged(rows)))} to"
                f" participants who judge: {format_estimate(_gains(rows, plans['ff'])[1])} over FF's plan"
            )
            if "shortest" in plans:
                extra = percent(extra_cost(rows, plans["shortest"]))
                text += f", and is {format_estimate(extra, 1, ' %')} longer than the shortest"
            yield name, f"{text}."


def effect_table(effects: Sequence[PaperEffect]) -> Table:
    """Lay out each part of the effect, plan by plan."""
    lines = [
        (
            f"{effect.cell}: {TITLES[effect.name]}",
            *(format_estimate(found) for found in (*effect.over_ff, *effect.over_own)),
            format_estimate(percent(effect.extra), 1, " %"),
        )
        for effect in effects
    ]
    columns = (
        "plan",
        "F − FF's, labeller",
        "F − FF's, judged",
        "F − participants', labeller",
        "F − participants', judged",
        "longer than shortest",
    )
    note = (
        "Targets: at least 0.10 above FF, at least the participants' F, at most 5 % longer than the shortest."
    )
    return Table("effect", "The paper's effect", columns, tuple(lines), note)
