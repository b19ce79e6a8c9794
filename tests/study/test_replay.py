"""Plans of any PDDL domain, shown step by step and labelled."""

import shutil
from pathlib import Path

import pytest
from studies import Visitor, open_study, write_study

from explicable.cli import run
from explicable.errors import InputError
from explicable.model.plan import read_plan
from explicable.study.materials import read_materials

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


def test_files_outside_the_studys_folder_are_refused(tmp_path):
    folder = example_study(tmp_path / "study", "warehouse")
    (tmp_path / "secret.txt").write_text("(a)")
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace('plan = "plan.txt"', 'plan = "../secret.txt"'))
    with pytest.raises(InputError, match="lies outside"):
        read_materials(folder)
