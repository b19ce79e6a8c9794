"""`explicable study`: people play or watch plans in a browser and label them; from consent to data set."""

import json
from pathlib import Path
from typing import Literal

import click

from explicable.cli.extras import require
from explicable.cli.files import OUTPUT_FOLDER, FiniteRange
from explicable.cli.outcomes import json_option
from explicable.cli.power import power
from explicable.cli.printing import complain, echo, warn
from explicable.cli.simulate import find_family

STUDY = click.Path(exists=True, file_okay=False, path_type=Path)

study_argument = click.argument("folder", metavar="DIR", type=STUDY)
database_option = click.option(
    "--database", metavar="URL", help="Database, as SQLAlchemy writes it. Default: the file study.db in DIR."
)


@click.group()
def study() -> None:
    """Collect people's labels in a browser."""
    require("study", "fastapi", "sqlalchemy")


def _warn(folder: Path) -> None:
    """Say what is allowed in a study, but hardly meant."""
    from explicable.study.study_file import read_study

    for warning in read_study(folder).warnings:
        warn(warning)


@study.command()
@click.argument("folder", metavar="DIR", type=OUTPUT_FOLDER)
@click.option("--title", help="What participants see first.")
@click.option("--language", type=click.Choice(["en", "de"]), default="en", show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
def init(folder: Path, title: str | None, language: Literal["en", "de"], seed: int) -> None:
    """Write a study to DIR that runs as it is: study.toml, texts and maps to change as you like."""
    from explicable.study.folder import make_folder

    for path in make_folder(folder, title=title, language=language, seed=seed):
        echo(path)


@study.command()
@study_argument
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=8000, show_default=True, help="0 takes any free port."
)
@database_option
@click.option("--workers", type=click.IntRange(1, 64), default=1, show_default=True, help="Processes.")
@click.option("--new-password", is_flag=True, help="Make a new password for the researcher's pages.")
@click.option("--no-limits", is_flag=True, hidden=True, help="Don't limit floods: for load tests.")
def serve(
    folder: Path,
    host: str,
    port: int,
    database: str | None,
    workers: int,
    new_password: bool,
    no_limits: bool,
) -> None:
    """Run the study in DIR until Ctrl-C; what has been acknowledged is never lost."""
    from explicable.study.serving import Server

    _warn(folder)
    server = Server(
        folder,
        host=host,
        port=port,
        database=database,
        workers=workers,
        renews_password=new_password,
        trusts_floods=no_limits,
    )
    told = server.announcement
    echo(f"participants:   {told.link}")
    if told.recruitment_link is not None:
        echo(f"recruitment:    {told.recruitment_link}")
    echo(f"researcher:     {told.link}admin")
    if told.new_password:
        echo(f"password:       {told.new_password}   (shown only now; --new-password makes another)")
    server.run()


@study.command()
@study_argument
@click.option("-n", "--num", type=click.IntRange(min=1), default=10, show_default=True, help="How many.")
@click.option("--family", default="myopic", show_default=True, help="Family of simulated participants.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
@click.option("--url", help="Address of the running study. Default: one is run for as long as it takes.")
@click.option("--at-once", type=click.IntRange(min=1), default=8, show_default=True, help="How many at once.")
@click.option("--pace", type=FiniteRange(min=0), default=0.0, help="Seconds between the labels of each.")
@database_option
@json_option
def simulate(
    folder: Path,
    num: int,
    family: str,
    seed: int,
    url: str | None,
    at_once: int,
    pace: float,
    database: str | None,
    as_json: bool,
) -> None:
    """Let simulated participants take part in the study in DIR, over HTTP.

    They are test instruments: every row that comes of them is marked, and is no evidence about people.
    """
    import contextlib

    from explicable.study.folder import open_study
    from explicable.study.materials import read_materials
    from explicable.study.serving import Server
    from explicable.study.simulation import Simulation, check_served

    kind = find_family(family, None)
    with contextlib.ExitStack() as stack:
        if url is not None:
            check_served(url, read_materials(folder).hash)
        else:
            server = Server(folder, port=0, database=database, trusts_floods=True)
            if server.announcement.new_password:
                echo(f"the researcher's password: {server.announcement.new_password}", err=True)
            url = stack.enter_context(server.in_background())
        opened = stack.enter_context(open_study(folder, database))
        simulation = Simulation(url, opened.materials, opened.keys, kind, seed, pace)
        tally = simulation.run(num, at_once=at_once)
    times = sorted(tally.answer_s)
    summary = {
        "simulated": True,
        "num_participants": num,
        "num_finished": tally.num_finished,
        "num_refused": tally.num_refused,
        "num_labels": len(tally.labels),
        "answer_s_median": times[len(times) // 2] if times else None,
        "answer_s_99": times[int(0.99 * len(times))] if times else None,
    }
    if as_json:
        echo(json.dumps(summary))
        return
    echo(
        f"simulated participants: {tally.num_finished} of {num} finished, {tally.num_refused} ended early or"
        f" found no place; labels: {len(tally.labels)}"
    )


@study.command()
@study_argument
@click.option("-o", "--output", type=OUTPUT_FOLDER, required=True, help="Folder to make for the data set.")
@database_option
@json_option
def export(folder: Path, output: Path, database: str | None, as_json: bool) -> None:
    """Write the data of the study in DIR: CSV, JSON Lines, Parquet (Psych-DS), codebook, checksums, traces.

    What a recruitment platform told about people is never exported.
    """
    from explicable.study.export import export as write_export
    from explicable.study.folder import open_study

    with open_study(folder, database) as opened:
        counts = opened.store.read(lambda tx: write_export(tx, opened.materials, output))
    if as_json:
        echo(json.dumps({"folder": str(output), "rows": counts}))
        return
    for table, count in counts.items():
        echo(f"{table:15} {count:8}")


@study.command()
@study_argument
@database_option
@json_option
def status(folder: Path, database: str | None, as_json: bool) -> None:
    """Say how far the study in DIR has come: people and simulated participants apart."""
    import time

    from explicable.study.enrolment import free_places
    from explicable.study.folder import open_study
    from explicable.study.summary import summarise

    with open_study(folder, database) as opened:
        opened.store.write(lambda tx: free_places(opened.materials, tx, time.time()))
        found = opened.store.read(
            lambda tx: {origin: summarise(tx, opened.materials, origin) for origin in ("person", "simulated")}
        )
    if as_json:
        echo(json.dumps({origin: summary.as_dict() for origin, summary in found.items()}))
        return
    for origin, summary in found.items():
        echo("people" if origin == "person" else "simulated participants (test instruments, no people)")
        stages = ", ".join(f"{stage}: {number}" for stage, number in sorted(summary.stages.items()))
        echo(f"  sessions by stage   {stages or 'none'}")
        echo(f"  labels              {summary.num_labels}")
        if summary.agreement is not None:
            echo(f"  agreement           {summary.agreement:.3f} (Krippendorff's alpha)")
        for score in summary.scores:
            interval = f" [{score.low:.3f}, {score.high:.3f}]" if score.low is not None else ""
            echo(
                f"  F of {score.source:14} {score.f_robot:.3f}{interval} "
                f"({score.num_labels} labels, {score.num_participants} participants, {score.num_tasks} tasks)"
            )
        for task in summary.tasks:
            name = f"{task.task} ({task.condition})" if task.condition else task.task
            echo(f"  {name:28} {task.finished} finished, {task.under_way} under way, of {task.wanted}")


@study.command()
@study_argument
@click.argument("participant")
@database_option
@click.option("--yes", is_flag=True, help="Don't ask.")
@json_option
def forget(folder: Path, participant: str, database: str | None, yes: bool, as_json: bool) -> int:
    """Erase all data of PARTICIPANT from the study in DIR; a tombstone remains."""
    import time

    from explicable.cli import EXIT_BAD_INPUT
    from explicable.study.folder import open_study
    from explicable.study.records import erase, is_known

    with open_study(folder, database) as opened:
        if not opened.store.read(lambda tx: is_known(tx, participant)):
            complain(f"there is no participant {participant!r}, or no longer")
            return EXIT_BAD_INPUT
        if not yes:
            click.confirm(f"Erase everything that {participant} left?", abort=True)
        rows = opened.store.write(lambda tx: erase(tx, participant, time.time()))
        opened.store.scrub()
    told = json.dumps({"participant": participant, "rows_erased": rows})
    echo(told if as_json else f"{participant}: {rows} rows erased")
    return 0


study.add_command(power)
