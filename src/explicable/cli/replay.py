"""`explicable replay`: games on record, played again."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import INPUT_FILE, OUTPUT_FILE, FiniteRange, naming
from explicable.cli.outcomes import json_option
from explicable.cli.printing import complain, echo
from explicable.cli.progress import working
from explicable.errors import PlanError
from explicable.model.files import write_whole
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.execution import EpisodeRecord

MAX_TOLD = 10  # one wrong event makes most that follow it wrong


@click.command()
@click.argument("episode", type=INPUT_FILE)
@click.option("--svg", type=OUTPUT_FILE, help="Draw the game to this file, if it was played on a map.")
@click.option(
    "--step-time",
    type=FiniteRange(0, 60),
    default=0.5,
    show_default=True,
    help="Seconds a step in the picture, which plays itself; 0: it stands still.",
)
@click.option("--trace", type=OUTPUT_FILE, help="Write the steps with the answers to this trace file.")
@json_option
def replay(episode: Path, svg: Path | None, step_time: float, trace: Path | None, as_json: bool) -> int:
    """Play the game on record in EPISODE again, event by event, and check that the same comes of it.

    Exit code 3 if it does not; then neither picture nor trace is written.
    """
    from explicable.execution import read_episode
    from explicable.execution import replay as play_again
    from explicable.labelling import write_traces

    recorded = read_episode(episode)
    with working(f"playing {len(recorded.events)} events again"):
        replayed = play_again(recorded)
    is_true = not replayed.differences  # else nothing is made of it
    if svg is not None and is_true:
        with naming(episode, PlanError):
            drawing = _draw(recorded, step_time)
        write_whole(svg, drawing)
    if trace is not None and is_true:
        write_traces(trace, [recorded.trace])
    if as_json:
        summary = {
            "ending": recorded.trace.notes.get("ending"),
            "steps": len(recorded.trace.steps),
            "events": len(recorded.events),
            "deviations": recorded.num_deviations,
            "changes": recorded.num_changes,
            "plans": len(recorded.planning_s),
            "same": is_true,
            "differences": replayed.differences,
        }
        echo(json.dumps(summary))
    else:
        _tell(recorded)
        for difference in replayed.differences[:MAX_TOLD]:
            complain(f"{episode}: {difference}")
        if (others := len(replayed.differences) - MAX_TOLD) > 0:
            complain(f"{episode}: and {others} more differences (--json tells all)")
    return EXIT_BAD_INPUT if replayed.differences else 0


def _tell(recorded: "EpisodeRecord") -> None:
    """Print every event, one a line."""
    for event in recorded.events:
        notice = event.notice
        about = [format_action(notice.action)] if notice.action else []
        about += map(str, notice.facts)
        if notice.answer is not None:
            about.append("makes sense" if notice.answer else "makes no sense")
        if notice.plan:
            about.append(f"{len(notice.plan)} steps")
        if notice.reason:
            about.append(notice.reason)
        if event.refusal:
            about.append(f"refused: {event.refusal}")
        echo(f"{event.time_s:9.3f} s  {notice.event.value:16}  {'  '.join(about)}".rstrip())
    echo(f"{recorded.trace.notes.get('ending', 'not ended')}: {len(recorded.trace.steps)} steps")


def _draw(recorded: "EpisodeRecord", step_s: float) -> str:
    from explicable.first_response import parse_map, render

    if recorded.map_text is None:
        raise click.UsageError("the game was not played on a map: it can't be drawn")
    steps = recorded.trace.steps
    return render(
        parse_map(recorded.map_text),
        "robot",
        plan=[step.action for step in steps],
        labels=[step.is_explicable for step in steps],
        title=f"{recorded.trace.annotator}: {recorded.trace.notes.get('ending', '')}".rstrip(": "),
        key=True,
        step_s=step_s,
    )
