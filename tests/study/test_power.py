"""How many people a study needs: the test it rests on, and what the command says."""

import json

import numpy as np
import pytest
from statsmodels.genmod.cov_struct import Independence
from statsmodels.genmod.families import Gaussian
from statsmodels.genmod.generalized_estimating_equations import GEE
from studies import write_study

from explicable.cli import run
from explicable.errors import UsageError
from explicable.execution import builtin_families
from explicable.study.difference import find_differences
from explicable.study.materials import read_materials
from explicable.study.power import analyse, arms

PLANS = "".join(
    f'[[task]]\nname = "{source}"\nmap = "two.map"\nplan = "{source}.txt"\nsource = "{source}"\npeople = 5\n'
    for source in ("direct", "roundabout")
)
COMMAND = "(command person c-0-2)\n"
DIRECT = "(move r1 c-0-0 c-1-0)\n(move r1 c-1-0 c-1-1)\n(move r1 c-1-1 c-1-2)\n(move r1 c-1-2 c-0-2)\n"
BACK = "(move r1 c-0-0 c-1-0)\n(move r1 c-1-0 c-0-0)\n"
VISIT = "(visit-room r1 c-0-2)\n"


def draw_studies(rng, num_studies, num_people, gap):
    """Draw studies in which people differ, and the steps of the one are `gap` more often explicable."""
    steps = rng.integers(5, 15, size=(num_studies, num_people, 2))
    taste = rng.normal(0, 0.15, size=(num_studies, num_people, 1))
    shares = np.clip(0.7 + taste + np.array([gap, 0.0]), 0.02, 0.98)
    return np.stack([rng.binomial(steps, shares), steps], axis=-1).astype(float)


@pytest.fixture
def study(tmp_path):
    folder = write_study(tmp_path / "study", tasks=PLANS)
    (folder / "direct.txt").write_text(COMMAND + DIRECT + VISIT)
    (folder / "roundabout.txt").write_text(COMMAND + 2 * BACK + DIRECT + VISIT)
    return folder


def test_the_test_is_a_generalised_estimating_equation():
    studies = draw_studies(np.random.default_rng(1), 5, 12, 0.15)
    found, is_significant = find_differences(studies)
    for number, study in enumerate(studies):
        answers, design, people = [], [], []
        for person, sides in enumerate(study):
            for side, (yes, asked) in enumerate(sides):
                answers += [1.0] * int(yes) + [0.0] * int(asked - yes)
                design += [[1.0, 1.0 - side]] * int(asked)
                people += [person] * int(asked)
        model = GEE(
            np.array(answers), np.array(design), people, family=Gaussian(), cov_struct=Independence()
        ).fit()
        error = model.bse[1] * np.sqrt(12 / 11)
        assert found[number] == pytest.approx(model.params[1])
        assert is_significant[number] == (abs(model.params[1]) > 2.200985 * error)  # t, 11 degrees of freedom


@pytest.mark.parametrize("num_people", [6, 30])
def test_where_there_is_no_difference_few_studies_find_one(num_people):
    studies = draw_studies(np.random.default_rng(2), 4000, num_people, 0.0)
    _, is_significant = find_differences(studies)
    assert (
        0.035 < is_significant.mean() < 0.065
    )  # the level is 5 %; 4000 studies tell it to within 0.7 points


def test_a_clear_difference_needs_few_people_and_none_is_never_found(study):
    materials, family = read_materials(study), builtin_families()["myopic"]
    assert arms(materials) == ["direct", "roundabout"]
    found = analyse(materials, family, "direct", "roundabout", most=20, num_studies=60)
    assert found.difference > 0.1
    assert found.needed is not None
    assert found.sizes[-1].power >= found.sizes[0].power
    assert all(size.power_low <= size.power <= size.power_high for size in found.sizes)
    assert found == analyse(materials, family, "direct", "roundabout", most=20, num_studies=60)
    assert found.difference == -analyse(materials, family, "roundabout", "direct", most=4).difference
    (study / "roundabout.txt").write_text((study / "direct.txt").read_text())
    same = analyse(read_materials(study), family, "direct", "roundabout", most=20, num_studies=60)
    assert same.needed is None


def test_conditions_of_play_are_compared_between_people(tmp_path):
    conditions = '[[condition]]\nname = "led"\n[[condition]]\nname = "leads"\nmode = "autonomous"\n'
    tasks = '[[task]]\nname = "one"\nmap = "one.map"\n'
    materials = read_materials(
        write_study(tmp_path, play='semantics = "persistent"', tasks=conditions + tasks)
    )
    found = analyse(materials, builtin_families()["mission"], "led", "leads", most=6, num_studies=20)
    assert 0 < found.f_one <= 1
    assert found.sizes[0].people_each == 2  # four people in two conditions
    with pytest.raises(UsageError, match="leads, led"):
        analyse(materials, builtin_families()["mission"], "led", "ff")


def test_the_command_answers_in_one_sentence(study, capsys):
    arguments = ["study", "power", str(study), "--most", "12", "--studies", "20", "--family", "myopic"]
    assert run(arguments) == 0
    text = capsys.readouterr().out
    assert "the difference in F between direct and roundabout" in text.splitlines()[0]
    assert "simulated participants, no people" in text
    assert run([*arguments, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["simulated"] is True
    assert told["answer"] == text.splitlines()[0]
    assert [family["family"] for family in told["families"]] == ["myopic"]
    assert run([*arguments, "--compare", "direct", "ff"]) == 2
    assert "can't be compared" in capsys.readouterr().err
