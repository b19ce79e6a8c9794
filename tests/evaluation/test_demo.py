"""The demo's files and tables agree."""

import json
import re

import pytest

from explicable.evaluation.demo import PLAN_TITLES, pool, run_demo, write_demo
from explicable.labelling import Labeller, read_traces
from explicable.model.grounding import ground_team
from explicable.model.plan import read_plan
from explicable.pddl import read_team_problem


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demo")
    demo = run_demo(seed=3)
    write_demo(demo, folder)
    return demo, folder


def test_scores_recomputed_from_the_files_are_the_records(demo):
    _, folder = demo
    labeller = Labeller.load(folder / "labeller.json")
    records = [json.loads(line) for line in (folder / "records.jsonl").read_text().splitlines()]
    assert len(records) == 4 * len(PLAN_TITLES)
    for record in records:
        files = folder / "problems" / record["map"]
        names = ("domain", "problem", "human-domain", "human-problem")
        team = ground_team(read_team_problem(*(files / f"{name}.pddl" for name in names)))
        actions = read_plan(folder / "plans" / f"{record['map']}.{record['plan_type']}.plan")
        execution = team.task.execute(actions)
        assert team.task.is_goal(execution.states[-1])
        labelled = labeller.label(team, actions)
        assert (record["cost"], record["num_steps"]) == (execution.cost, len(actions))
        assert list(labelled.labels) == record["labels"]
        for score in ("f_paper", "f_robot", "f_expected"):
            assert getattr(labelled.scores, score) == pytest.approx(record[score], abs=1e-12)


def test_pooled_ratios_are_ratios_of_sums(demo):
    made, _ = demo
    for plan_type in PLAN_TITLES:
        labels = [
            label for record in made.records if record.plan_type == plan_type for label in record.labels
        ]
        assert pool(made.records, plan_type).f_paper == pytest.approx(sum(labels) / len(labels))


def test_page_and_files_hold_everything(demo):
    made, folder = demo
    assert len(read_traces(folder / "traces.jsonl")) == len(made.traces) == 34
    page = (folder / "report.html").read_text()
    assert len(re.findall(r"<svg", page)) >= len(made.records)
    assert not re.search(r"(src|href)=\"https?:", page)
    for record in made.records:
        assert f"{record.f_paper:.3f}" in page
        assert (folder / "figures" / f"{record.map}.{record.plan_type}.svg").exists()
