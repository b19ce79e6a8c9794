"""The first-response domain of the paper: maps, how they are made, encoded as team problems, and drawn."""

from explicable.first_response.builtin import builtin_maps
from explicable.first_response.encoding import Semantics, encode
from explicable.first_response.generator import generate
from explicable.first_response.map_file import format_map, parse_map, read_map
from explicable.first_response.picture_key import key_entries
from explicable.first_response.rendering import render
from explicable.first_response.scene import render_scene, scene_key
from explicable.first_response.world import Cell, View, World, distances, shortest_path

__all__ = [
    "Cell",
    "Semantics",
    "View",
    "World",
    "builtin_maps",
    "distances",
    "encode",
    "format_map",
    "generate",
    "key_entries",
    "parse_map",
    "read_map",
    "render",
    "render_scene",
    "scene_key",
    "shortest_path",
]
