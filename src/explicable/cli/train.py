"""`explicable train`: from labelled traces to a labeller."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from explicable.cli.files import INPUT_FILE, OUTPUT_FILE, FiniteRange
from explicable.cli.outcomes import json_option
from explicable.cli.printing import echo, warn
from explicable.cli.progress import counting
from explicable.cli.trace_files import naming_traces, read_labelled_traces

if TYPE_CHECKING:
    from explicable.labelling import Trace
    from explicable.labelling.validation import Validation

DEFAULT_BOOTSTRAP = 50
_MOST = 100_000  # copies of a trace, and models: a hundred times what anybody has use for


@click.command()
@click.argument("files", metavar="TRACES...", nargs=-1, required=True, type=INPUT_FILE)
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Write the labeller to this file.")
@click.option("--c1", type=FiniteRange(min=0), default=0.0, show_default=True, help="L1 penalty.")
@click.option("--c2", type=FiniteRange(min=0), default=1.0, show_default=True, help="L2 penalty.")
@click.option(
    "--doubt",
    type=FiniteRange(min=0),
    help="Log odds by which each feature that no trace showed speaks against a step; not with --augment."
    " Default: 0.3.",
)
@click.option(
    "--augment",
    type=click.IntRange(min=0, max=_MOST),
    metavar="N",
    help="As in the paper: learn from the names in each step instead of lifted features, and from N copies of"
    " each trace under random renamings (the paper: 1000). Holds for objects of the same names only.",
)
@click.option(
    "--bootstrap",
    type=click.IntRange(min=0, max=_MOST),
    help=f"Models that tell how sure the labeller is. Default: {DEFAULT_BOOTSTRAP}, or 0 with --augment,"
    " where each takes as long as the training itself.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
@click.option(
    "--cross-validate",
    "num_folds",
    type=click.IntRange(min=2),
    metavar="FOLDS",
    help="Tell how well traces are predicted that were held out, a part at a time.",
)
@click.option(
    "--by",
    type=click.Choice(["problem", "annotator"]),
    default="problem",
    show_default=True,
    help="What cross-validation holds out.",
)
@click.option(
    "--calibration",
    type=OUTPUT_FILE,
    help="Draw how often held-out steps were explicable, by predicted probability, to this SVG file.",
)
@json_option
def train(
    files: tuple[Path, ...],
    output: Path,
    c1: float,
    c2: float,
    doubt: float | None,
    augment: int | None,
    bootstrap: int | None,
    seed: int,
    num_folds: int | None,
    by: Literal["problem", "annotator"],
    calibration: Path | None,
    as_json: bool,
) -> None:
    """Learn from the labelled TRACES which steps people find explicable."""
    from explicable.labelling import Labeller
    from explicable.labelling.validation import cross_validate

    if calibration is not None and num_folds is None:
        raise click.UsageError("--calibration needs --cross-validate")
    options = {"c1": c1, "c2": c2, "seed": seed, **_kind_of_labeller(doubt, augment, bootstrap)}
    traces = _read(files)
    validation = None
    with naming_traces(*files), counting(1 + (num_folds or 0)) as tell:
        if num_folds is not None:
            validation = cross_validate(
                traces,
                lambda kept: Labeller.train(kept, **options),
                num_folds=num_folds,
                by=by,
                tell=lambda fold: tell(f"fold {fold + 1} of {num_folds}"),
            )
        tell("training")
        labeller = Labeller.train(traces, **options)
    labeller.save(output)
    if validation is not None and calibration is not None:
        from explicable.evaluation.calibration import draw_calibration
        from explicable.model.files import write_whole

        write_whole(calibration, draw_calibration(validation.steps.calibration))
    if as_json:
        held_out = None if validation is None else validation.as_dict()
        echo(json.dumps({"labeller": str(output), **labeller.summary, "held_out": held_out}))
        return
    echo(f"{output}: trained on {labeller.summary['num_labels']} labels in {len(traces)} traces", err=True)
    if validation is not None:
        _print(validation, by)


def _kind_of_labeller(doubt: float | None, augment: int | None, bootstrap: int | None) -> dict[str, Any]:
    """Return what `Labeller.train` calls the options of which one decides about another."""
    if augment is None:
        kind = {} if doubt is None else {"doubt": doubt}
        return {**kind, "num_bootstrap": DEFAULT_BOOTSTRAP if bootstrap is None else bootstrap}
    if doubt is not None:
        raise click.UsageError("--doubt is of lifted features, and --augment has none")
    return {"symbols": "ground", "num_copies": augment, "num_bootstrap": bootstrap or 0}


def _read(files: tuple[Path, ...]) -> "list[Trace]":
    """Read what is to be learned from; warn if robots' steps were all called the same."""
    traces = read_labelled_traces(*files)
    answers = {
        step.label is not False
        for trace in traces
        for step in trace.steps
        if step.label is not None and trace.problem.agent_of(step.action).kind == "robot"
    }
    if len(answers) == 1:
        warn(f"all labels say {'explicable' if True in answers else 'inexplicable'}: so will the labeller")
    return traces


def _print(validation: "Validation", by: str) -> None:
    steps = validation.steps
    lines = [
        (f"held out, by {by}", f"{validation.num_traces} traces, {steps.num_steps} labelled steps"),
        ("log-loss", f"{steps.log_loss:.3f} nats (always guessing the rate: {steps.base_log_loss:.3f})"),
        ("AUC", "-" if steps.auc is None else f"{steps.auc:.3f}"),
        (
            "error of E[F]",
            f"{validation.mae_robot:.3f} (robots' steps), {validation.mae_all_steps:.3f} (all steps)",
        ),
        ("90, 95 % intervals", "hold " + ", ".join(f"{100 * share:.0f} %" for share in validation.covered)),
        ("calibration error", f"{steps.calibration.error:.3f}"),
    ]
    for name, text in lines:
        echo(f"{name:22} {text}")
