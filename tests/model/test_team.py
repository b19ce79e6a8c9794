"""Teams of two models: what keeps them from being composed, where that stands, and what does not."""

import pytest

from explicable.errors import ConflictError, PDDLError
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem, find_conflicts
from explicable.pddl import parse_domain, parse_problem, read_pair, read_team_problem
from explicable.planning import compare

DOMAIN = """(define (domain kitchen)
  (:requirements :typing :action-costs)
  (:types robot human place)
  (:constants stove - place)
  (:predicates (at ?r - robot ?p - place) (asked ?p - place) (clean ?p - place))
  (:functions (total-cost) - number (way ?p - place) - number)
  (:action ask :parameters (?h - human ?p - place) :effect (asked ?p))
  (:action go :parameters (?r - robot ?p - place)
    :effect (and (at ?r ?p) (increase (total-cost) (way ?p))))
  (:action scrub :parameters (?r - robot ?p - place)
    :precondition (and (at ?r ?p) (asked ?p)) :effect (clean ?p)))
"""
PROBLEM = """(define (problem dinner) (:domain kitchen)
  (:objects cook - human arm - robot sink - place)
  (:init (= (total-cost) 0) (= (way sink) 2) (= (way stove) 1))
  (:goal (and (clean sink) (clean stove))) (:metric minimize (total-cost)))
"""


@pytest.fixture
def read(tmp_path):
    """Read the team of the kitchen, with some words replaced in the human's files."""

    def read(*changes):
        texts = {"domain": DOMAIN, "problem": PROBLEM}
        for name, text in texts.items():
            believed = text
            for old, new in changes:
                believed = believed.replace(old, new)
            (tmp_path / f"{name}.pddl").write_text(text)
            (tmp_path / f"human-{name}.pddl").write_text(believed)
        names = ("domain", "problem", "human-domain", "human-problem")
        return read_team_problem(*(tmp_path / f"{name}.pddl" for name in names))

    return read


# Nothing here is used, so that one word can be changed and the file stays sound.
WORDS = """(define (domain words)
(:types robot human place)
(:constants stove - place)
(:predicates (at ?r - robot ?p - place) (lit))
(:functions (way ?p - place))
(:action scrub :parameters (?a - robot) :effect (and)))
"""
EMPTY = "(define (problem p) (:domain words) (:objects sink - place) (:init) (:goal (and)))"


@pytest.mark.parametrize(
    ("old", "new", "where", "message"),
    [
        ("robot human", "robot - place human", "3:9", "type 'robot' is object X but place Y"),
        ("stove - place", "stove - robot", "4:13", "object 'stove' is place X but robot Y"),
        (
            "?r - robot ?p",
            "?r ?q - robot ?p",
            "5:15",
            "predicate 'at' takes (robot place) X but (robot robot place) Y",
        ),
        (
            "?r - robot ?p",
            "?r - human ?p",
            "5:15",
            "predicate 'at' takes (robot place) X but (human place) Y",
        ),
        ("(lit))", "(lit ?p - place))", "5:42", "predicate 'lit' takes () X but (place) Y"),
        ("(way ?p - place)", "(way)", "6:14", "function 'way' takes (place) X but () Y"),
        ("?a - robot", "?a - human", "7:10", "action 'scrub' belongs to robots X but to humans Y"),
    ],
)
def test_a_conflict_is_refused_by_name_and_place(tmp_path, old, new, where, message):
    domain, problem, believed = (tmp_path / name for name in ("d.pddl", "p.pddl", "h.pddl"))
    domain.write_text(WORDS)
    problem.write_text(EMPTY)
    believed.write_text("\n" + WORDS.replace(old, new))
    with pytest.raises(ConflictError) as caught:
        read_team_problem(domain, problem, believed)
    line, column = where.split(":")
    sides = message.replace(" X", " in the robot's model,").replace(" Y", " in the human's")
    assert str(caught.value) == f"{believed}:{where}: {sides} (there: {domain}:{int(line) - 1}:{column})"


def test_all_conflicts_are_listed_and_one_is_shown(read):
    with pytest.raises(ConflictError) as caught:
        read(
            ("stove - place", "stove - robot"),
            ("sink - place", "sink - human"),
            ("(clean sink) (clean stove)", ""),
            ("(= (way sink) 2) (= (way stove) 1)", ""),
        )
    assert len(caught.value.conflicts) == 2
    assert "one of 2 conflicts" in str(caught.value)


def test_related_types_of_parameters_are_no_conflict(read):
    team = read(("(at ?r - robot ?p - place)", "(at ?r - object ?p - place)"))
    assert find_conflicts(team.robot, team.mental) == ()
    assert ground_team(team).task.goal_reachable


def test_an_object_that_is_a_constant_to_the_other_side_is_one_object(read):
    team = read(("(:constants stove - place)", ""), ("sink - place", "sink stove - place"))
    assert find_conflicts(team.robot, team.mental) == ()
    composite = team.composite
    assert [*composite.domain.constants, *composite.objects] == ["stove", "cook", "arm", "sink"]
    assert compare(team).names == ()


def test_differences_are_listed_by_what_they_are_about(read):
    team = read(
        ("(clean ?p - place))", "(clean ?p - place) (wet ?p - place))"),
        (":effect (asked ?p)", ":precondition (wet ?p) :effect (asked ?p)"),
        ("(clean stove)", "(wet stove)"),
        ("(= (way sink) 2)", "(= (way sink) 1) (wet sink)"),
        ("sink - place", "sink door - place"),
        (":precondition (and (at ?r ?p) (asked ?p))", ":precondition (at ?r ?p)"),
    )
    found = compare(team)
    assert [str(difference) for difference in found.tellable] == ["(way sink) is 2", "scrub needs (asked ?p)"]
    assert [str(difference) for difference in found.names] == [
        "object door is unknown to the robots",
        "predicate wet is unknown to the robots",
    ]
    assert [str(difference) for difference in found.goals] == [
        "(clean stove) is a goal to the robots alone",
        "(wet stove) is a goal to the person alone",
    ]
    assert [str(difference) for difference in found.human_actions] == ["ask needs (wet ?p)"]


def test_one_model_does_not_differ_from_itself(read):
    team = read()
    for same in (team, TeamProblem(team.robot)):
        found = compare(same)
        assert (found.tellable, found.names, found.goals, found.human_actions) == ((), (), (), ())


ANDROID = "robot human - object android - (either robot human)"


@pytest.mark.parametrize(
    ("types", "objects"),
    [("robot human", "marvin - (either robot human)"), (ANDROID, "sink - place marvin - android")],
)
def test_an_object_that_is_robot_and_human_is_refused_by_name_and_place(tmp_path, types, objects):
    domain, problem = tmp_path / "d.pddl", tmp_path / "p.pddl"
    domain.write_text(WORDS.replace("robot human place", f"{types} place"))
    problem.write_text(EMPTY.replace("sink - place", objects))
    column = problem.read_text().index("marvin") + 1
    for believed in (None, problem):
        with pytest.raises(PDDLError) as caught:
            read_team_problem(domain, problem, human_problem=believed)
        message = "object 'marvin' is both a robot and a human: an agent is either"
        assert str(caught.value) == f"{problem}:1:{column}: {message}"
    with pytest.raises(PDDLError, match="'marvin' is both"):
        _ = TeamProblem(read_pair(domain, problem)).agents


def test_robots_act_by_their_own_model_in_actions_that_are_open_to_humans_too():
    text = WORDS.replace("?a - robot", "?a - (either robot human)")
    own, believed = (parse_problem(EMPTY, parse_domain(each)) for each in (text, text.replace("and", "lit")))
    assert own.domain.actions != believed.domain.actions
    assert TeamProblem(own, believed).composite.domain.actions == own.domain.actions
