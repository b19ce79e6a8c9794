"""The linear-chain CRF by enumerating all labellings: slow and obvious."""

import itertools

import numpy as np


def labellings(num_positions, num_labels, clamped=None):
    """All labellings that agree with `clamped` (-1: any label), in lexicographic order."""
    clamped = [-1] * num_positions if clamped is None else clamped
    return itertools.product(*(range(num_labels) if c < 0 else [c] for c in clamped))


def score(labels, state, transition):
    steps = sum(state[t][label] for t, label in enumerate(labels))
    return steps + sum(transition[a][b] for a, b in itertools.pairwise(labels))


def distribution(state, transition, clamped=None):
    """Every labelling with its probability."""
    every = list(labellings(len(state), len(transition), clamped))
    scores = np.array([score(labels, state, transition) for labels in every])
    weights = np.exp(scores - scores.max())
    return list(zip(every, weights / weights.sum(), strict=True))


def log_partition(state, transition, clamped=None):
    scores = [score(y, state, transition) for y in labellings(len(state), len(transition), clamped)]
    return float(np.logaddexp.reduce(scores))


def marginals(state, transition, clamped=None):
    table = np.zeros((len(state), len(transition)))
    for labels, probability in distribution(state, transition, clamped):
        for t, label in enumerate(labels):
            table[t, label] += probability
    return table


def count_distribution(state, transition, empty, clamped=None, counted=None):
    counted = [True] * len(state) if counted is None else counted
    table = np.zeros(sum(map(bool, counted)) + 1)
    for labels, probability in distribution(state, transition, clamped):
        table[sum(c and label != empty for c, label in zip(counted, labels, strict=True))] += probability
    return table


def best_labelling(state, transition, clamped=None):
    """The best labelling; of several, the one whose last label is lowest, then the one before, and so on."""
    every = labellings(len(state), len(transition), clamped)
    return max(every, key=lambda labels: (score(labels, state, transition), [-y for y in reversed(labels)]))
