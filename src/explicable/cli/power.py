"""`explicable study power`: how many people a study needs, by simulated participants."""

import json
from pathlib import Path

import click

from explicable.cli.files import FiniteRange
from explicable.cli.outcomes import json_option
from explicable.cli.printing import echo
from explicable.cli.progress import working
from explicable.cli.simulate import find_family


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--compare",
    nargs=2,
    metavar="ONE OTHER",
    help="Sources of replayed plans, or conditions of play. Default: the two that there are.",
)
@click.option(
    "--family", "names", multiple=True, help="Family of simulated participants. Default: all of them."
)
@click.option(
    "--most", type=click.IntRange(min=4, max=1000), default=100, show_default=True, help="Most people."
)
@click.option(
    "--power", "target", type=FiniteRange(0.05, 0.99), default=0.8, show_default=True, help="Power asked for."
)
@click.option(
    "--studies", type=click.IntRange(20, 10_000), default=500, show_default=True, help="Studies of each size."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
@json_option
def power(
    folder: Path,
    compare: tuple[str, str] | None,
    names: tuple[str, ...],
    most: int,
    target: float,
    studies: int,
    seed: int,
    as_json: bool,
) -> None:
    """Say how many people the study in DIR needs to find a difference in explicability.

    Simulated participants, who are test instruments, take part in many simulated studies; the level is 5 %.
    """
    from explicable.execution import builtin_families
    from explicable.study.difference import LEVEL
    from explicable.study.materials import read_materials
    from explicable.study.power import analyse, arms, say

    materials = read_materials(folder)
    known = arms(materials)
    if compare is None and len(known) != 2:
        raise click.UsageError(
            f"there are {len(known)} to compare ({', '.join(known)}): name two by --compare"
        )
    one, other = compare or known
    families = [find_family(name, None) for name in names or builtin_families()]
    with working("letting simulated participants take part"):
        found = [
            analyse(materials, family, one, other, most=most, target=target, num_studies=studies, seed=seed)
            for family in families
        ]
    sentence = say(found, most)
    if as_json:
        told = {"simulated": True, "answer": sentence, "level": LEVEL, "study": materials.hash}
        echo(json.dumps({**told, "families": [analysed.as_dict() for analysed in found]}))
        return
    echo(sentence)
    for analysed in found:
        odds = "" if analysed.odds_ratio is None else f", odds ratio {analysed.odds_ratio:.2f}"
        echo(
            f"\n{analysed.family} (simulated participants, no people): F of {one} {analysed.f_one:.3f},"
            f" of {other} {analysed.f_other:.3f}, difference {analysed.difference:+.3f}{odds}\n"
            "  people  of each task  power  [95 % interval]   differences seen by 95 % of studies"
        )
        for size in analysed.sizes:
            echo(
                f"  {size.num_people:6}  {size.people_each:12}  {size.power:5.2f}  "
                f"[{size.power_low:.2f}, {size.power_high:.2f}]      "
                f"{size.difference_low:+.3f} to {size.difference_high:+.3f}"
                f"{'   enough' if size.num_people == analysed.needed else ''}"
            )
