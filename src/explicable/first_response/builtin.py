"""The maps that come with the package: files, each made from a seed of the generator."""

from importlib import resources
from typing import Literal

from explicable.errors import UsageError
from explicable.first_response.generator import generate
from explicable.first_response.map_file import parse_map
from explicable.first_response.world import World

BUILTIN_SEEDS = {"training": range(1, 17), "test": range(101, 105)}
"""The seed of each map that comes with the package, in the order of the maps' numbers."""


def builtin_maps(kind: Literal["training", "test"] = "training") -> dict[str, World]:
    """Return the maps that come with the package, 16 for training or 4 for tests, by name.

    Raises
    ------
    UsageError
        Unknown kind.

    Examples
    --------
    >>> list(builtin_maps("test"))
    ['test-01', 'test-02', 'test-03', 'test-04']
    """
    if kind not in BUILTIN_SEEDS:
        raise UsageError(f"built-in maps are for {' or '.join(BUILTIN_SEEDS)}, not {kind!r}")
    folder = resources.files("explicable.first_response") / "maps"
    names = [f"{kind}-{number:02}" for number in range(1, len(BUILTIN_SEEDS[kind]) + 1)]
    return {name: parse_map((folder / f"{name}.map").read_text("utf-8"), f"{name}.map") for name in names}


def generate_builtin(kind: Literal["training", "test"]) -> dict[str, World]:
    """Make the maps that come with the package anew from their recorded seeds.

    Examples
    --------
    >>> generate_builtin("test") == builtin_maps("test")
    True
    """
    import numpy as np

    worlds = {}
    for number, seed in enumerate(BUILTIN_SEEDS[kind], 1):
        name = f"{kind}-{number:02}"
        world = generate(np.random.default_rng(seed))
        worlds[name] = World(world.rows, {"name": name, "seed": str(seed)})
    return worlds
