"""Tasks that nobody draws on a whiteboard, through every command that takes a plan or makes one."""

import json

import pytest

from cli.test_given_plans import explicable

DOMAIN = """(define (domain lamps) (:requirements :strips :typing) (:types robot human)
  (:predicates (lit) (asked))
  (:action ask :parameters (?h - human) :effect (asked))
  (:action light :parameters (?r - robot) :precondition (asked) :effect (lit)))
"""
PROBLEM = "(define (problem p) (:domain lamps) (:objects r - robot h - human) (:init {init}) (:goal {goal}))"
TEAM = ["domain.pddl", "problem.pddl"]


@pytest.fixture
def place(tmp_path):
    """A task in which something is left to do, and what was learnt there."""
    (tmp_path / "domain.pddl").write_text(DOMAIN)
    (tmp_path / "problem.pddl").write_text(PROBLEM.format(init="", goal="(lit)"))
    for made in (["simulate", *TEAM, "--num", "3", "-o", "traces"], ["train", "traces", "-o", "labeller"]):
        assert explicable(tmp_path, *made).returncode == 0
    return tmp_path


@pytest.mark.parametrize("init_and_goal", [("(lit)", "(lit)"), ("", "()")], ids=["goal holds", "no goal"])
def test_where_nothing_is_left_to_do_the_plan_is_empty(place, init_and_goal):
    init, goal = init_and_goal
    (place / "problem.pddl").write_text(PROBLEM.format(init=init, goal=goal))
    labelled = ["--labeller", "labeller"]
    for asked in (
        ["plan", *TEAM],
        ["plan", *TEAM, *labelled],
        ["plan", *TEAM, *labelled, "--mode", "paper"],
        ["plan", *TEAM, *labelled, "--max-cost-increase", "0"],
        ["tell", "labeller", *TEAM],
    ):
        done = explicable(place, *asked)
        assert done == (0, "; cost = 0\n", ""), asked
        assert explicable(place, *asked, "-o", "empty.plan").returncode == 0
        assert (place / "empty.plan").read_text() == "; cost = 0\n"
        assert json.loads(explicable(place, *asked, "--json").stdout)["plan"] == []
    for asked in (
        ["label", "labeller", *TEAM, "empty.plan"],
        ["explain", "labeller", *TEAM, "empty.plan"],
        ["measure", *TEAM, "empty.plan", *labelled],
        ["rank", "labeller", *TEAM, "empty.plan"],
        ["front", "labeller", *TEAM],
        ["schedule", *TEAM],
        ["schedule", *TEAM, "empty.plan"],
    ):
        done = explicable(place, *asked, "--json")
        assert (done.returncode, done.stderr) == (0, ""), asked
        json.loads(done.stdout)
        assert explicable(place, *asked).returncode == 0, asked
