"""Plans of any PDDL domain, shown step by step and labelled."""

import re
import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from studies import Visitor, open_study, write_study

from explicable.cli import run
from explicable.errors import InputError
from explicable.model.plan import read_plan
from explicable.study.materials import read_materials, resolve

EXAMPLES = Path(__file__).parents[2] / "examples"
TASK = """
[[task]]
name = "{example}-ff"
domain = "domain.pddl"
problem = "problem.pddl"
human_domain = "human-domain.pddl"
human_problem = "human-problem.pddl"
plan = "plan.txt"
source = "planner-x"
people = 1
{more}
"""


def example_study(folder, example, more=""):
    write_study(folder, tasks=TASK.format(example=example, more=more))
    for path in (EXAMPLES / example).glob("*.pddl"):
        shutil.copy(path, folder)
    if not (folder / "plan.txt").exists():
        files = [str(folder / name) for name in ("domain.pddl", "problem.pddl")]
        human = [str(folder / name) for name in ("human-domain.pddl", "human-problem.pddl")]
        arguments = ["--human-domain", human[0], "--human-problem", human[1], "-o", str(folder / "plan.txt")]
        assert run(["plan", *files, *arguments]) == 0
    return folder


@pytest.mark.parametrize("example", ["warehouse", "rover-survey"])
@pytest.mark.parametrize("ask", ["after", "before"])
def test_every_robot_step_of_a_plan_is_asked_about_once(tmp_path, example, ask):
    folder = example_study(tmp_path, example)
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace("[play]", f'[play]\nask = "{ask}"', 1))
    client, _, _ = open_study(folder)
    problem = read_materials(folder).material(f"{example}-ff", "all").problem
    plan = read_plan(folder / "plan.txt")
    with client:
        visitor = Visitor(client).reach_tasks()
        views = visitor.play()
    questions = [view for view in views if view["phase"] == "question"]
    assert len(questions) == sum(problem.agent_of(action).kind == "robot" for action in plan)
    assert not any(view["commands"] for view in views)
    page = visitor.page.text + str(views)
    assert "planner-x" not in page  # blinded: nothing says what made the plan
    assert f"{example}-ff" not in page
    taken = [view for view in views if view["number"] and view["stage"] == "tasks"]
    assert all(view["sentence"].endswith(".") for view in taken)
    assert all(view["became_true"] or view["became_false"] for view in taken)


PRACTICE = """
[practice]
domain = "domain.pddl"
problem = "problem.pddl"
human_domain = "human-domain.pddl"
human_problem = "human-problem.pddl"
plan = "plan.txt"
picture = "places"
"""


def test_a_study_of_another_domain_has_no_map_anywhere(tmp_path):
    folder = example_study(tmp_path, "warehouse", 'picture = "places"')
    text = (folder / "study.toml").read_text().replace('practice = "practice.map"\n', "")
    (folder / "study.toml").write_text(text + PRACTICE)
    client, _, _ = open_study(folder)
    with client:
        visitor = Visitor(client)
        visitor.arrive()
        instructions = visitor.consent().text
        assert "Sometimes you only watch" in instructions
        assert "You say which room" not in instructions
        assert "What the pictures mean" not in instructions  # that is the key of maps
        visitor.submit()
        practised = visitor.play()
        assert all(view["is_replay"] for view in practised[:-1])
        visitor.submit(**{"question-1": "before"})
        visitor.play()
        assert visitor.heading == "Your opinion"
    assert run(["study", "simulate", str(folder), "-n", "1"]) == 0
    assert run(["study", "export", str(folder), "-o", str(tmp_path / "data")]) == 0


SVG = "{http://www.w3.org/2000/svg}"
PLACES = '[places]\nat = "1 in 2"\nstored = "1 in 2"\ncarries = "2 in 1"'


def test_a_task_names_its_renderer(tmp_path):
    folder = example_study(tmp_path / "places", "warehouse", f'picture = "places"\n{PLACES}')
    client, _, _ = open_study(folder)
    with client:
        views = Visitor(client).reach_tasks().play()
    shown = [view for view in views if view["stage"] == "tasks"]
    material = read_materials(folder).material("warehouse-ff", "all")
    places = material.pictures.places
    assert len(places) > 1
    assert len({view["picture"] for view in shown}) > 3
    for view in shown:
        words = re.findall(r"<text[^>]*>([^<]*)</text>", view["picture"])
        assert set(places) <= set(words)
        assert view["number"] == 0 or view["became_true"] or view["became_false"]
    carried = next(view["picture"] for view in shown if "carries" in str(view["became_true"]))
    _, cart, parcel, place = next(action for action in read_plan(folder / "plan.txt") if action[0] == "load")
    boxes = {box.findtext(f"{SVG}text"): box for box in ET.fromstring(carried).iter(f"{SVG}g")}
    assert boxes[cart] in boxes[place].iter()
    assert boxes[parcel] in boxes[cart].iter()


def test_a_map_can_be_shown_in_words_and_a_renderer_must_fit(tmp_path):
    def material(folder, tasks, **options):
        write_study(tmp_path / folder, tasks=tasks, **options)
        return read_materials(tmp_path / folder).material("one", "all")

    task = '[[task]]\nname = "one"\nmap = "one.map"\n'
    assert material("map", task).pictures is not None
    assert material("words", f'{task}picture = "none"\n').pictures is None
    assert material("places", f'{task}picture = "places"\n').pictures.places[0] == "c-0-0"
    with pytest.raises(InputError, match="nothing is anywhere"):
        material("nowhere", f'{task}picture = "places"\n[places]\ninside = "1 in 2"\n')
    example_study(tmp_path / "unfit", "warehouse", 'picture = "first-response"')
    with pytest.raises(InputError, match="needs the map"):
        read_materials(tmp_path / "unfit")


def test_pddl_files_of_the_domain_of_maps_are_shown_as_the_map(tmp_path):
    folder = write_study(tmp_path, tasks="")
    assert run(["first-response", "encode", str(folder / "one.map"), "-o", str(folder / "pddl")]) == 0
    files = [f"pddl/{name}.pddl" for name in ("domain", "problem", "human-domain", "human-problem")]
    options = ["--human-domain", str(folder / files[2]), "--human-problem", str(folder / files[3])]
    paths = [str(folder / name) for name in files[:2]]
    assert run(["plan", *paths, *options, "-o", str(folder / "plan.txt")]) == 0
    keys = zip(("domain", "problem", "human_domain", "human_problem"), files, strict=True)
    task = "".join(f'{key} = "{file}"\n' for key, file in keys)
    task = f'[[task]]\nname = "pddl"\nmap = "one.map"\npicture = "first-response"\nplan = "plan.txt"\n{task}'
    client, _, _ = open_study(write_study(tmp_path, tasks=task))
    with client:
        views = Visitor(client).reach_tasks().play()
    assert all("data-room" in view["picture"] for view in views if view["stage"] == "tasks")


def test_templates_say_steps_and_facts_as_the_study_likes(tmp_path):
    example_study(tmp_path, "warehouse")
    action = read_plan(tmp_path / "plan.txt")[0]
    more = f'[sentences]\n{action[0]} = "here {{agent}} acts with {{1}}"'
    example_study(tmp_path, "warehouse", more)
    material = read_materials(tmp_path).material("warehouse-ff", "all")
    agent = material.problem.agent_of(action).name
    assert material.wording.sentence(action, agent) == f"Here {agent} acts with {action[1]}"
    example_study(tmp_path, "warehouse", more.replace("{1}", "{nobody}"))
    with pytest.raises(InputError, match=r"there is no \{nobody\}"):
        read_materials(tmp_path).check()


def test_a_plan_that_can_not_be_executed_is_refused_before_anybody_comes(tmp_path):
    example_study(tmp_path, "warehouse")
    steps = (tmp_path / "plan.txt").read_text().splitlines()
    (tmp_path / "plan.txt").write_text("\n".join(steps[1:]))
    with pytest.raises(InputError, match=r"step \d+, .* can't be executed"):
        read_materials(tmp_path).check()


@pytest.mark.parametrize("name", ["a\0b", "loop", "loop/map"])
def test_what_is_no_name_of_a_file_is_refused(tmp_path, name):
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match="no name of a file"):
        resolve(tmp_path, name)


def test_files_outside_the_studys_folder_are_refused(tmp_path):
    folder = example_study(tmp_path / "study", "warehouse")
    (tmp_path / "secret.txt").write_text("(a)")
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace('plan = "plan.txt"', 'plan = "../secret.txt"'))
    with pytest.raises(InputError, match="lies outside"):
        read_materials(folder)
