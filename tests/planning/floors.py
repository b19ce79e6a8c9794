"""Small maps, plans and a labeller with known weights for the tests of this folder."""

import itertools

from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.labeller import Labeller
from explicable.model.grounding import ground_team

PATIENCE_S = 600.0
"""For searches that end by themselves: what is proved must not hang on how fast the machine is."""

SCHEMAS = ("move", "remove-obstacle", "visit-room")

# The short way to the room is blocked at x, which the person does not know.
DETOUR = "#####\n#@x*#\n#...#\n#####\n"


def floor(text, semantics="persistent"):
    return ground_team(encode(parse_map(text), semantics))


def moves(*cells, robot="r1"):
    names = [f"c-{row}-{column}" for row, column in cells]
    return [("move", robot, here, there) for here, there in itertools.pairwise(names)]


def command(row, column):
    return ("command", "person", f"c-{row}-{column}")


def visit(row, column, robot="r1"):
    return ("visit-room", robot, f"c-{row}-{column}")


def judge_of_progress(strength=3.0):
    """A labeller by hand: a step that leads away from what was asked for, or can't be, is inexplicable."""
    bad = ("no-nearer", "farther", "much-farther", "no-way")
    good = ("nearer", "done", "shortcut", "no-target", "unconcerned")
    weights = {f"request: {schema} {progress}": -strength for schema in SCHEMAS for progress in bad}
    weights |= {f"request: {schema} {progress}": strength for schema in SCHEMAS for progress in good}
    rows = [[weight, 0.0] for weight in weights.values()]
    model = ConditionalRandomField.from_weights([True, False], list(weights), rows, [[0, 0], [0, 0]])
    return Labeller(model, schemas=SCHEMAS)
