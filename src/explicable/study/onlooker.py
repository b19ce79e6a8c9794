"""What a simulated participant sees of a task, and makes of it: with a server or without."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from explicable.execution import Game as Watched
from explicable.execution import Participant, SimulatedPerson
from explicable.labelling import LabelledStep
from explicable.model.plan import format_action, parse_action
from explicable.study.game import Moment
from explicable.study.materials import Material
from explicable.study.view import commands_of, phase_of

if TYPE_CHECKING:
    from explicable.model.problem import GroundAtom


class Onlooker:
    """A simulated participant before one task."""

    def __init__(self, material: Material, participant: Participant, rng: np.random.Generator) -> None:
        expects_initiative = participant.initiative or material.condition.mode != "commanded"
        participant = replace(participant, initiative=expects_initiative)
        setting = material.game.setting
        self.person = SimulatedPerson(setting, participant, rng)
        self.watched = Watched(setting, self.person)
        self.refused: frozenset[GroundAtom] = frozenset()
        self.may_think = False

    def decide(self, view: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        """Return what to send next."""
        is_announced = view["phase"] == "question" and view["number"] == len(self.watched.steps)
        if view["operator"] and (view["number"] > len(self.watched.steps) or is_announced):
            self.watched.take(parse_action(view["operator"]))
            self.may_think = view["phase"] == "question"
        told = {"shown": view["shown"]} if view.get("shown") else {}
        if view["phase"] == "question":
            explicable = bool(self.watched.steps[-1].label)
            return "/api/answer", {"number": view["number"], "explicable": explicable, **told}
        asked = self._ask(view)
        if asked is not None:
            self.may_think = False
            return "/api/command", {"operator": asked}
        return "/api/step", {"number": view["number"]}

    def _ask(self, view: dict[str, Any]) -> str | None:
        possible = [command["operator"] for command in view["commands"] if command["is_possible"]]
        must_ask = view["phase"] == "waiting"
        if not possible or not (must_ask or (self.may_think and self.person.thinks_over())):
            return None
        self.may_think = False
        chosen = self.person.choose(self.refused)
        if chosen is not None and format_action(chosen) in possible:
            return format_action(chosen)
        return possible[0] if must_ask else None


def rehearse(
    material: Material, participant: Participant, rng: np.random.Generator
) -> tuple[LabelledStep, ...]:
    """Let a participant play or watch a task without a server; return the steps with the labels."""
    game, onlooker, moment = material.game, Onlooker(material, participant, rng), Moment()
    while not game.is_over(moment):
        request = game.request(moment)
        path, body = onlooker.decide(
            {
                "phase": phase_of(material, moment),
                "number": len(moment.steps),
                "operator": moment.operator,
                "commands": [
                    command.model_dump()
                    for command in commands_of(material, moment, request.action if request else None)
                ],
            }
        )
        if path == "/api/answer":
            moment = game.answer(moment, explicable=body["explicable"])
        elif path == "/api/command":
            moment = game.command(moment, parse_action(body["operator"]))
        else:
            moment = game.step(moment)
    return moment.steps


def shown(view: dict[str, Any]) -> dict[str, Any]:
    """Return a view after the step that its page shows without asking.

    Examples
    --------
    >>> shown({"stage": "tasks", "number": 3, "next": {"phase": "question", "num_taken": 1, "next": None}})
    {'stage': 'tasks', 'number': 4, 'next': None, 'phase': 'question', 'num_taken': 1}
    """
    return {**view, **view["next"], "number": view["number"] + view["next"]["num_taken"]}
