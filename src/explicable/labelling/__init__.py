"""Learning from labelled plans what people find explicable."""

from explicable.labelling.labelled_plan import LabelledPlan
from explicable.labelling.labeller import Labeller
from explicable.labelling.score import Explicability, PlanScores
from explicable.labelling.traces import (
    LabelledStep,
    Trace,
    check_traces,
    problem_texts,
    read_traces,
    split_traces,
    write_traces,
)

__all__ = [
    "Explicability",
    "LabelledPlan",
    "LabelledStep",
    "Labeller",
    "PlanScores",
    "Trace",
    "check_traces",
    "problem_texts",
    "read_traces",
    "split_traces",
    "write_traces",
]
