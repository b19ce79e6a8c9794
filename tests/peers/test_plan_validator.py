"""Plans, judged by a validator that was not written here."""

from pathlib import Path

import pytest
from unified_planning.engines import SequentialPlanValidator, ValidationResultStatus
from unified_planning.io import PDDLReader

from explicable.first_response import builtin_maps, encode
from explicable.model.grounding import ground
from explicable.model.plan import format_plan
from explicable.pddl import format_domain, format_problem, read_pair
from explicable.search import search

SURVEY = Path(__file__).parents[2] / "examples" / "rover-survey"
PROBLEMS = {
    "map": lambda: encode(builtin_maps("test")["test-01"]).composite,
    "rovers": lambda: read_pair(SURVEY / "domain.pddl", SURVEY / "problem.pddl"),
}


@pytest.mark.parametrize("algorithm", ["default", "ff", "lazy", "eager", "bfws", "wastar"])
@pytest.mark.parametrize("name", PROBLEMS)
def test_plans_are_valid(name, algorithm, tmp_path):
    problem = PROBLEMS[name]()
    task = ground(problem)
    result = search(task, algorithm)
    files = [tmp_path / "domain.pddl", tmp_path / "problem.pddl", tmp_path / "plan"]
    actions = [task.action(operator) for operator in result.operators]
    texts = (format_domain(problem.domain), format_problem(problem), format_plan(actions, result.cost))
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    reader = PDDLReader()
    peers_problem = reader.parse_problem(str(files[0]), str(files[1]))
    plan = reader.parse_plan(peers_problem, str(files[2]))
    with SequentialPlanValidator() as validator:
        assert validator.validate(peers_problem, plan).status == ValidationResultStatus.VALID
