"""Every kind of trial, small: records, answers, tables, figures and page agree."""

import json
import re

import pytest
from small_studies import write_study

from explicable.cli import EXIT_BAD_INPUT, EXIT_TRIALS_FAILED
from explicable.cli import run as command_line
from explicable.evaluation.answers.rows import flatten, group, judged, labelled
from explicable.evaluation.experiments import builtin_experiments, read_experiment
from explicable.evaluation.page import Table, render_latex
from explicable.evaluation.records import without_measurements
from explicable.evaluation.results import make_page
from explicable.evaluation.runner import read_records, run_experiments
from explicable.evaluation.statistics import estimate
from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.labelling import write_traces

STUDIES = {
    "plans": """
question = "Plans?"
kind = "plans"
settings = { num_traces = 4, num_judges = 2, keep_steps = true }
""",
    "labels": """
question = "Labels?"
kind = "labels"
settings = { num_traces = 4, num_maps = 2, num_bootstrap = 2 }
[[cells]]
symbols = ["lifted", "ground"]
""",
    "loops": """
question = "Loops?"
kind = "loops"
settings = { num_traces = 4, num_maps = 2, num_players = 2 }
""",
    "scaling": """
question = "Scaling?"
kind = "scaling"
settings = { num_marks = 2, num_maps = 1 }
[[cells]]
side = [4, 5]
""",
    "domains": """
question = "Domains?"
kind = "domains"
settings = { problem = "warehouse", family = "myopic", num_traces = 3 }
""",
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("all-kinds")
    studies = [write_study(folder, text, kind) for kind, text in STUDIES.items()]
    arguments = [part for path in studies for part in ("--study", str(path))]
    assert command_line(["evaluate", *arguments, "-o", str(folder)]) == 0
    experiments = [read_experiment(path) for path in studies]
    return experiments, read_records(experiments, folder), folder


def test_nothing_failed_and_every_figure_has_its_n(finished):
    experiments, records, folder = finished
    run = json.loads((folder / "run.json").read_text())
    page = make_page(experiments, records, run)
    assert page.failures.rows == ()
    assert [section.question for section in page.sections] == [
        "Plans?",
        "Labels?",
        "Loops?",
        "Scaling?",
        "Domains?",
    ]
    for section in page.sections:
        assert section.answers
        for table in section.tables:
            assert table.rows
            for row in table.rows:
                assert len(row) == len(table.columns)
                for cell in row[1:]:
                    paper = table.name in {"table-1", "table-2"} and re.fullmatch(r"\d\.\d{3}", cell)
                    assert paper or cell == "–" or re.search(r"\(n = \d+\)$", cell), (table.name, cell)
    assert page.facts["seeds"] == ", ".join(f"{kind} 0" for kind in STUDIES)


def test_the_page_needs_nothing_from_elsewhere_and_shows_all_failures(finished):
    _, _, folder = finished
    page = (folder / "report.html").read_text()
    assert not re.search(r"(src|href)=\"(?!#)", page)
    assert not re.search(r"<(script|link|iframe|img)\b", page)
    assert "Unexplained failures" in page
    markdown = (folder / "results.md").read_text()
    assert markdown.rstrip().endswith("None.")
    assert len(list((folder / "figures").glob("*.svg"))) >= 8
    assert {path.name for path in (folder / "tables").glob("*.tex")} >= {
        "plans-table-1.tex",
        "loops-measures.tex",
    }


def test_printed_ratios_follow_from_the_lines_alone(finished):
    experiments, records, folder = finished
    rows = group(flatten(experiments[0], records["plans"]), "plan")
    markdown = (folder / "results.md").read_text()
    for found in rows.values():
        explicable = sum(
            e + row["num_steps"] - row["num_robot_steps"] for row in found for _, e, _ in row["judged"]
        )
        whole = sum(row["num_steps"] for row in found for _ in row["judged"])
        assert estimate(judged(found)).value == pytest.approx(explicable / whole)
        assert f"{explicable / whole:.3f} [" in markdown
        steps = sum(row["f_paper"] * row["num_steps"] for row in found)
        ratio = steps / sum(row["num_steps"] for row in found)
        assert estimate(labelled(found, "f_paper")).value == pytest.approx(ratio)
        assert f"{ratio:.3f} [" in markdown


def test_another_run_with_the_same_seed_differs_in_times_alone(finished, tmp_path):
    experiments, records, _ = finished
    chosen = [experiment for experiment in experiments if experiment.name in {"loops", "scaling"}]
    again = run_experiments(chosen, tmp_path)
    for name, found in again.items():
        assert without_measurements(found) == without_measurements(records[name])


def test_traces_of_a_study_take_the_place_of_simulated_games(tmp_path, capsys):
    maps = [builtin_maps("training")["training-01"], builtin_maps("test")["test-02"]]
    problems = [encode(world, "exclusive") for world in maps]
    games = simulate_study(problems, builtin_families()["myopic"], num_traces=4, seed=3, way="commanded")
    write_traces(tmp_path / "traces.jsonl", [game.trace for game in games])
    arguments = ["evaluate", "--traces", str(tmp_path / "traces.jsonl"), "--quick", "-o", str(tmp_path)]
    assert command_line(arguments) == 0
    (record,) = map(json.loads, (tmp_path / "records" / "study.jsonl").read_text().splitlines())
    own = [row for row in record["rows"] if row["plan"] == "participants"]
    assert [row["map"] for row in own] == ["test-02"] * 2  # nobody played the other three
    assert [row["own_labels"][0] for row in own] == [game.trace.annotator for game in games[1::2]]
    page = (tmp_path / "results.md").read_text()
    assert "the traces of a study" in page
    assert "human (participants')" in page
    write_traces(tmp_path / "traces.jsonl", [game.trace for game in games[1::2]])
    assert command_line([*arguments[:-1], str(tmp_path / "other")]) == EXIT_TRIALS_FAILED
    assert "none is left to learn from" in (tmp_path / "other" / "results.md").read_text()
    write_traces(tmp_path / "traces.jsonl", [])
    assert command_line(arguments) == EXIT_BAD_INPUT
    assert "first-response" in capsys.readouterr().err


def test_latex_escapes_what_latex_would_take_for_commands():
    text = render_latex(Table("t", "50 % of a_b & {c} #1", ("plan", "F"), (("FF", "≥ 0.8"),)))
    assert r"50 \% of a\_b \& \{c\} \#1" in text
    assert r"FF & $\geq$ 0.8 \\" in text


def test_a_quick_run_of_all_experiments(tmp_path):
    assert command_line(["evaluate", "--quick", "--jobs", "2", "-o", str(tmp_path)]) == 0
    page = (tmp_path / "report.html").read_text()
    for experiment in builtin_experiments(quick=True):
        assert f'id="{experiment.name}"' in page
