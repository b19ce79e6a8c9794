"""Experiments small enough for ordinary tests: the code of the full run, with small numbers."""

PLANS = """
question = "Which plan?"
kind = "plans"
seed = 5
repeats = 2

[settings]
num_traces = 4
num_maps = 1
num_judges = 2
plans = ["ff", "shortest", "explicable", "participants"]

[[cells]]
semantics = ["persistent", "exclusive"]
"""


def write_study(folder, text=PLANS, name="small"):
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path
