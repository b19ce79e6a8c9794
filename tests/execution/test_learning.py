"""Learning the person at work: the filter over minds, and the adapted labeller."""

import math

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.execution import (
    Family,
    Participant,
    PersonFilter,
    Proposal,
    SimulatedPerson,
    Thoughts,
    adapt,
    builtin_families,
    draw_evenly,
    prepare,
    run,
    simulate_study,
    thoughts,
)
from explicable.execution.monitor import Event
from explicable.first_response import builtin_maps, encode
from explicable.labelling import Labeller
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.search import Outcome


def play(problem, participant, families, seed=0):
    """Play as a follower; return the filter, and what it predicted before each request."""
    setting = prepare(problem)
    person = SimulatedPerson(setting, participant, np.random.default_rng(seed))
    rng = np.random.default_rng(1)
    guesses = PersonFilter(setting, draw_evenly(families, rng, num_guesses=20), rng)
    predicted, last = [], [guesses.predict()]

    def watch(course):
        event = course.occurrences[-1]
        if event.event is Event.PERSON_COMMANDED:
            predicted.append((last[-1], event.notice.action))
        guesses.see(course)
        last.append(guesses.predict())

    run(setting, lambda _: Proposal(Outcome.LIMIT), person, watch=watch)
    return guesses, predicted


@pytest.fixture(scope="module")
def problems():
    return [encode(world, "exclusive") for world in builtin_maps("test").values()]


def test_requests_are_predicted_better_than_by_chance_across_families(problems):
    families = builtin_families()
    for own in families.values():
        others = [family for family in families.values() if family is not own]
        losses, chance = [], []
        for seed, problem in enumerate(problems):
            participant = own.draw(seed, np.random.default_rng(seed))
            for chances, asked in play(problem, participant, others, seed)[1]:
                assert sum(chances.values()) == pytest.approx(1.0)
                losses.append(-math.log(chances.get(asked, 1e-3)))
                chance.append(math.log(len(chances)))
        assert np.mean(losses) < 0.75 * np.mean(chance)


def test_answers_tell_a_strict_judge_from_a_mild_one(problems):
    strict, mild = Family("strict", {"slack": 0.0}, {}), Family("mild", {"slack": 50.0}, {})
    for slack, name in ((0.0, "simulated-strict"), (50.0, "simulated-mild")):
        participant = Participant("simulated-somebody", slack=slack)
        found = [play(problem, participant, [strict, mild])[0].families() for problem in problems]
        assert np.mean([chances.get(name, 0.0) for chances in found]) > 0.9


@pytest.mark.parametrize("wrong", [{"temperature": 0.0}, {"lapse": 0.0}, {"lapse": 1.0}])
def test_a_filter_needs_guesses_and_sound_numbers(problems, wrong):
    setting, rng, families = prepare(problems[0]), np.random.default_rng(0), builtin_families().values()
    with pytest.raises(UsageError):
        PersonFilter(setting, draw_evenly(families, rng), rng, **wrong)
    with pytest.raises(UsageError):
        PersonFilter(setting, (), rng)
    with pytest.raises(UsageError):
        draw_evenly(families, rng, num_guesses=0)
    with pytest.raises(UsageError):
        draw_evenly([], rng)


@pytest.mark.parametrize("most", [0, 3, thoughts.MOST_THOUGHTS])
def test_what_is_remembered_of_other_games_changes_nothing(problems, most, monkeypatch):
    monkeypatch.setattr(thoughts, "MOST_THOUGHTS", most)
    setting, families = prepare(problems[0]), list(builtin_families().values())
    shared = Thoughts(setting)
    for seed in range(3):
        found = []
        for known in (shared, shared, Thoughts(setting)):
            rng = np.random.default_rng(seed)
            guesses = PersonFilter(setting, draw_evenly(families, rng), rng, thoughts=known)
            person = SimulatedPerson(setting, families[seed].draw(seed, rng), np.random.default_rng(seed))
            run(setting, lambda _: Proposal(Outcome.LIMIT), person, watch=guesses.see)
            found.append(([thought.mind for thought in guesses.thinking], guesses.weights.tolist()))
        assert found[0] == found[1] == found[2]


@pytest.fixture(scope="module")
def game(problems):
    traces = [
        e.trace for e in simulate_study(problems, builtin_families()["myopic"], num_traces=4, way="commanded")
    ]
    labeller = Labeller.train(traces, num_bootstrap=0)
    return labeller, TeamFeatures(ground_team(problems[0])), traces[0]


def likelihood(labeller, features, trace, answers):
    labelled = labeller.label(features, trace.actions)
    pairs = zip(labelled.probabilities, answers, strict=True)
    return sum(math.log(p if answer else 1 - p) for p, answer in pairs if answer is not None)


def test_adapting_explains_the_answers_better_within_its_bounds(game):
    labeller, features, trace = game
    contrary = [None if step.label is None else not step.label for step in trace.steps]
    before = likelihood(labeller, features, trace, contrary)
    gains = []
    for max_change in (0.0, 0.1, 1.0):
        adapted = adapt(labeller, features, trace.actions, contrary, max_change=max_change)
        gains.append(likelihood(adapted, features, trace, contrary) - before)
        change = np.abs(adapted.model.state_weights_ - labeller.model.state_weights_)
        assert change.max() <= max_change + 1e-12
    assert gains[0] == pytest.approx(0.0)
    assert gains[0] < gains[1] < gains[2]


def test_adapting_to_nothing_changes_nothing_and_a_strong_prior_little(game):
    labeller, features, trace = game
    silent = [None] * len(trace.steps)
    contrary = [None if step.label is None else not step.label for step in trace.steps]
    assert adapt(labeller, features, trace.actions, silent) is labeller
    held = adapt(labeller, features, trace.actions, contrary, strength=1e6)
    assert np.allclose(held.model.state_weights_, labeller.model.state_weights_, atol=1e-4)


def test_adapting_refuses_what_does_not_fit(game):
    labeller, features, trace = game
    with pytest.raises(UsageError):
        adapt(labeller, features, trace.actions, [])
    with pytest.raises(UsageError):
        adapt(labeller, features, trace.actions, [None] * len(trace.steps), strength=0)
