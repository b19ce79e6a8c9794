"""What records answer: one module for each kind of trial, each with a function `answer`."""

from collections.abc import Mapping, Sequence
from importlib import import_module

from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Section
from explicable.evaluation.records import Record

KINDS: Mapping[str, str] = {
    "plans": "explicable.evaluation.answers.plans",
    "labels": "explicable.evaluation.answers.labels",
    "loops": "explicable.evaluation.answers.loops",
    "domains": "explicable.evaluation.answers.plans",
    "scaling": "explicable.evaluation.answers.scaling",
}
"""Each kind of trial and the module that makes its section."""


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Answer an experiment's question from its records alone."""
    done = [record for record in records if record["outcome"] == "done"]
    if not done:
        return Section(experiment.name, experiment.question, ("Nothing yet: no trial has been done.",))
    section: Section = import_module(KINDS[experiment.kind]).answer(experiment, done)
    return section
