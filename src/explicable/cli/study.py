"""`explicable study`: people play or watch plans in a browser and label them; from consent to data set."""

from pathlib import Path
from typing import Literal

import click

FOLDER = click.Path(file_okay=False, path_type=Path)
STUDY = click.Path(exists=True, file_okay=False, path_type=Path)

study_argument = click.argument("folder", metavar="DIR", type=STUDY)
database_option = click.option(
    "--database", metavar="URL", help="Database, as SQLAlchemy writes it. Default: the file study.db in DIR."
)


@click.group()
def study() -> None:
    """Collect people's labels in a browser."""
    try:
        import fastapi  # noqa: F401
        import sqlalchemy  # noqa: F401
    except ImportError as error:
        raise click.UsageError(
            f"the study needs packages of its own ({error.name}): pip install 'explicable[study]'"
        ) from error


@study.command()
@click.argument("folder", metavar="DIR", type=FOLDER)
@click.option("--title", help="What participants see first.")
@click.option("--language", type=click.Choice(["en", "de"]), default="en", show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
def init(folder: Path, title: str | None, language: Literal["en", "de"], seed: int) -> None:
    """Write a study to DIR that runs as it is: study.toml, texts and maps to change as you like."""
    from explicable.study.folder import make_folder

    for path in make_folder(folder, title=title, language=language, seed=seed):
        click.echo(path)


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
    click.echo(f"participants:   {told.link}")
    if told.recruitment_link != told.link:
        click.echo(f"recruitment:    {told.recruitment_link}")
    click.echo(f"researcher:     {told.link}admin")
    if told.new_password:
        click.echo(f"password:       {told.new_password}   (shown only now; --new-password makes another)")
    server.run()
