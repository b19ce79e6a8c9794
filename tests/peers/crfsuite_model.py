"""Reads and rewrites weights in a CRFsuite model file: 20 bytes a feature (type, source, target, weight)."""

import struct

import numpy as np
import pycrfsuite

FEATURES = struct.Struct("<4sII")  # chunk name, size, number of features
FEATURE = struct.Struct("<IIId")
STATE = 0


def train(path, X, y, **parameters):
    """Train CRFsuite with all state and transition features; returns the tagger's label order."""
    trainer = pycrfsuite.Trainer(algorithm="lbfgs", verbose=False)
    trainer.set_params(
        {
            "feature.possible_states": True,
            "feature.possible_transitions": True,
            "feature.minfreq": 0,
            **parameters,
        }
    )
    for sequence, labels in zip(X, y, strict=True):
        trainer.append(sequence, labels)
    trainer.train(str(path))
    return open_tagger(path).labels()


def open_tagger(path):
    tagger = pycrfsuite.Tagger()
    tagger.open(str(path))
    return tagger


def _features(content):
    start = struct.unpack_from("<I", content, 28)[0]  # header: magic, size, type, version, three counts, this
    name, _, number = FEATURES.unpack_from(content, start)
    assert name == b"FEAT"
    start += FEATURES.size
    return [start + k * FEATURE.size for k in range(number)]


def read_weights(path, feature_names, num_labels):
    """State and transition weights; CRFsuite drops features without weight and renumbers the rest."""
    state, transition = np.zeros((len(feature_names), num_labels)), np.zeros((num_labels, num_labels))
    names = {int(number): name for name, number in open_tagger(path).info().attributes.items()}
    content = path.read_bytes()
    for place in _features(content):
        kind, source, target, weight = FEATURE.unpack_from(content, place)
        if kind == STATE:
            state[feature_names.index(names[source]), target] = weight
        else:
            transition[source, target] = weight
    return state, transition


def write_weights(path, state, transition):
    """Overwrite every weight in a model that has them all, features in order of appearance."""
    content = bytearray(path.read_bytes())
    for place in _features(content):
        kind, source, target, _ = FEATURE.unpack_from(content, place)
        weight = (state if kind == STATE else transition)[source, target]
        FEATURE.pack_into(content, place, kind, source, target, weight)
    path.write_bytes(content)
