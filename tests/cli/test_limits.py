"""Tasks too large for memory, time or patience end with a message and their own exit code."""

import json
import resource
import subprocess
import sys

import pytest

LIMIT, USAGE = 5, 2
MIB = 1 << 20
NUM_OBJECTS, NUM_PARAMETERS = 40, 9


@pytest.fixture(scope="module")
def tasks(tmp_path_factory):
    """Two tasks, `domain-NAME.pddl` and `NAME.pddl`: wide has too many operators, deep too many states."""
    folder = tmp_path_factory.mktemp("tasks")
    variables = [f"?x{i}" for i in range(NUM_PARAMETERS)]
    objects = [f"o{i}" for i in range(NUM_OBJECTS)]
    (folder / "domain-wide.pddl").write_text(
        f"(define (domain wide) (:predicates (p ?x) (q {' '.join(variables)}))"
        f" (:action a :parameters ({' '.join(variables)})"
        f" :precondition (and {' '.join(f'(p {v})' for v in variables)}) :effect (q {' '.join(variables)})))"
    )
    (folder / "wide.pddl").write_text(
        f"(define (problem wide) (:domain wide) (:objects {' '.join(objects)})"
        f" (:init {' '.join(f'(p {o})' for o in objects)}) (:goal (q {' '.join(objects[:NUM_PARAMETERS])})))"
    )
    # A goal that the delete relaxation reaches at once, but no plan: all states must be looked at.
    (folder / "domain-deep.pddl").write_text(
        "(define (domain deep) (:requirements :strips :negative-preconditions)"
        " (:predicates (on ?x) (up) (down))"
        " (:action switch-on :parameters (?x) :precondition (not (on ?x)) :effect (on ?x))"
        " (:action switch-off :parameters (?x) :precondition (on ?x) :effect (not (on ?x)))"
        " (:action rise :parameters () :precondition (and) :effect (and (up) (not (down))))"
        " (:action sink :parameters () :precondition (and) :effect (and (down) (not (up)))))"
    )
    (folder / "deep.pddl").write_text(
        f"(define (problem deep) (:domain deep) (:objects {' '.join(objects)}) (:init)"
        " (:goal (and (up) (down))))"
    )
    return folder


def plan(folder, name, *options, address_space_mib=None):
    def restrict():
        if address_space_mib:
            resource.setrlimit(resource.RLIMIT_AS, (address_space_mib * MIB,) * 2)

    done = subprocess.run(
        [sys.executable, "-m", "explicable", "plan", f"domain-{name}.pddl", f"{name}.pddl", *options],
        cwd=folder,
        preexec_fn=restrict,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done


@pytest.mark.parametrize("address_space_mib", [None, 700])
def test_a_task_with_too_many_operators(tasks, address_space_mib):
    options = () if address_space_mib else ("--memory-limit", "200MiB")
    done = plan(tasks, "wide", *options, address_space_mib=address_space_mib)
    assert done.returncode == LIMIT
    assert "problem wide" in done.stderr
    assert "memory" in done.stderr or "MiB" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("algorithm", ["default", "lazy", "eager", "bfws", "astar"])
def test_a_task_with_too_many_states(tasks, algorithm):
    done = plan(tasks, "deep", "--search", algorithm, "--memory-limit", "45MiB", "--json")
    assert done.returncode == LIMIT, done.stderr
    found = json.loads(done.stdout)
    assert (found["outcome"], found["limit"], found["plan"]) == ("limit reached", "memory", None)


def test_an_address_space_that_ends(tasks):
    done = plan(tasks, "deep", address_space_mib=300)
    assert (done.returncode, done.stderr) == (LIMIT, "no plan: limit reached (memory)\n")


def test_what_the_process_holds_counts(tasks):
    done = plan(tasks, "deep", "--memory-limit", "1MiB")
    assert done.returncode == LIMIT
    assert "already taken" in done.stderr


def test_other_limits(tasks):
    done = plan(tasks, "deep", "--max-evaluations", "20", "--json")
    found = json.loads(done.stdout)
    assert (done.returncode, found["limit"]) == (LIMIT, "evaluations")
    assert found["evaluations"] <= 20 + 2 * NUM_OBJECTS + 2
    done = plan(tasks, "deep", "--time-limit", "0.1")
    assert (done.returncode, done.stderr) == (LIMIT, "no plan: limit reached (time)\n")


@pytest.mark.parametrize("size", ["lots", "-1", "1 light-year", "iB", "1.2.3GB"])
def test_sizes_that_mean_nothing(tasks, size):
    done = plan(tasks, "deep", f"--memory-limit={size}")
    assert done.returncode == USAGE
    assert "such as 1GiB" in done.stderr


def test_more_memory_than_can_be_addressed_is_no_limit(tasks):
    done = plan(tasks, "deep", "--memory-limit", "99999999999GiB", "--max-evaluations", "10", "--json")
    assert done.returncode == LIMIT, done.stderr
    assert json.loads(done.stdout)["limit"] == "evaluations"
