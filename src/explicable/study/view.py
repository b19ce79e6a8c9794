"""What a participant is shown: nothing that is hidden from people, nothing that tells who made a plan."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from pydantic import BaseModel

from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.study.game import Moment
from explicable.study.materials import Material
from explicable.study.pictures import Scene
from explicable.study.sentences import changed
from explicable.study.standing import Standing
from explicable.study.words import Language

Phase = Literal["question", "moving", "waiting", "over"]

_MOST_DRAWN = 10_000


class CommandView(BaseModel):
    """A command that the person can give, or could have given before its room was visited."""

    operator: str
    object: str
    name: str
    is_possible: bool
    is_present: bool


class Look(BaseModel):
    """What a page shows of a task: the same whenever the task is in the same state by the same step.

    ``phase`` says what is due: an answer, the next step after ``wait_s`` seconds, a command, or nothing more.
    Where ``next`` is there, the page shows it after these seconds, without asking, unless a command was
    given; ``num_taken`` steps are taken with it, and what is sent from then on says so by its ``shown``.
    ``task``, ``condition`` and ``operator`` are there for simulated participants only.
    """

    phase: Phase
    is_replay: bool
    picture: str | None = None
    sentence: str = ""
    announced: str = ""
    became_true: list[str] = []
    became_false: list[str] = []
    commands: list[CommandView] = []
    wait_s: float = 0.0
    task: str | None = None
    condition: str | None = None
    operator: str | None = None
    num_taken: int = 0
    shown: str | None = None
    next: "Look | None" = None


class View(Look):
    """A task as it stands, for the page; ``number`` counts the steps so far."""

    stage: str
    position: int
    num_tasks: int
    revision: int
    number: int


@dataclass(frozen=True)
class Views:
    """Describes in words and pictures where sessions stand; what has been drawn is remembered, as JSON.

    Parameters
    ----------
    language
        What participants read.
    """

    language: Language
    _drawn: dict[object, str] = field(default_factory=dict, compare=False, repr=False)

    def view(self, standing: Standing) -> View:
        """Describe where a session stands."""
        return View.model_validate_json(self.json(standing))

    def json(self, standing: Standing) -> str:
        """Describe where a session stands, as the JSON of a `View`."""
        session, moment = standing.session, standing.moment
        place = {
            "stage": session.stage,
            "position": session.position,
            "num_tasks": standing.num_tasks,
            "revision": session.revision,
            "number": len(moment.steps) if moment else 0,
        }
        return f"{json.dumps(place)[:-1]},{self._look(standing)[1:]}"

    def _look(self, standing: Standing) -> str:
        """Return the JSON of a `Look`."""
        material, moment = standing.material, standing.moment
        if material is None or moment is None:
            return Look(phase="over", is_replay=False).model_dump_json()
        game, last = material.game, moment.steps[-1] if moment.steps else None
        request = game.request(moment)
        key = (
            *(material.task.name, material.condition.name, standing.session.origin),
            game.state(moment),
            last and (last.agent, last.action),
            moment.announced,
            request and request.action,
            game.question(moment),
            game.length and len(moment.steps),
            phase_of(material, moment) if standing.is_teaming else None,  # its plans may change
            _changes(material, moment),
        )
        return self._remembered(key, lambda: self._draw(standing, material, moment).model_dump_json())

    def _remembered(self, key: object, draw: Callable[[], str]) -> str:
        drawn = self._drawn.get(key)
        if drawn is None:
            if len(self._drawn) >= _MOST_DRAWN:
                self._drawn.clear()
            drawn = self._drawn[key] = draw()
        return drawn

    def _draw(self, standing: Standing, material: Material, moment: Moment) -> Look:
        game, condition = material.game, material.condition
        last, request = moment.steps[-1] if moment.steps else None, game.request(moment)
        target = request.action if request else None
        true, false = _changes(material, moment)
        is_simulated = standing.session.origin == "simulated"
        offer = standing.offer if moment is standing.moment else None
        return Look(
            phase=phase_of(material, moment),
            is_replay=game.length is not None,
            picture=self._picture(material, moment, target),
            sentence=_said(material, last.action) if last else "",
            announced=_said(material, moment.announced) if moment.announced else "",
            became_true=[material.wording.fact(atom) for atom in true],
            became_false=[material.wording.fact(atom) for atom in false],
            commands=commands_of(material, moment, target),
            wait_s=condition.step_s if request or game.length is not None else condition.idle_step_s,
            task=material.task.name if is_simulated else None,
            condition=condition.name if is_simulated else None,
            operator=moment.operator if is_simulated else None,
            num_taken=len(moment.steps) - len(standing.moment.steps) if standing.moment else 0,
            shown=None if moment is standing.moment else moment.operator,
            next=self._draw(standing, material, offer) if offer else None,
        )

    def _picture(self, material: Material, moment: Moment, target: GroundAtom | None) -> str | None:
        pictures = material.pictures
        if pictures is None:
            return None
        last = moment.steps[-1].action if moment.steps else None
        key = (
            *(material.task.name, material.condition.name),
            *(material.game.state(moment), target, last, moment.announced),
        )

        def draw() -> str:
            facts = _facts(material, moment) if pictures.shows_changes else _believed(material, moment)
            scene = Scene(facts, target, last, moment.announced)
            return pictures.draw(scene, self.language.text(pictures.title))

        return self._remembered(key, draw)


def _said(material: Material, action: GroundAtom) -> str:
    return material.wording.sentence(action, material.problem.agent_of(action).name)


def phase_of(material: Material, moment: Moment) -> Phase:
    """Say what is due in a task."""
    game = material.game
    if game.question(moment) is not None:
        return "question"
    if game.is_over(moment):
        return "over"
    return "moving" if game.upcoming(moment) is not None else "waiting"


def _changes(material: Material, moment: Moment) -> tuple[tuple[GroundAtom, ...], tuple[GroundAtom, ...]]:
    """Return what the last step changed, where no picture shows it."""
    if (material.pictures is not None and material.pictures.shows_changes) or not moment.steps:
        return (), ()
    before = _facts(material, Moment(moment.steps[:-1]))
    true, false = changed(before, _facts(material, moment))
    return tuple(true), tuple(false)


def _facts(material: Material, moment: Moment) -> frozenset[GroundAtom]:
    task = material.game.setting.truth.task
    atoms = task.atoms(material.game.state(moment))
    return frozenset(atom for atom in atoms if " " not in atom[0])  # without the stage's own switches


def _believed(material: Material, moment: Moment) -> frozenset[GroundAtom]:
    """Return the facts as the person has them: believed at the start, then changed as the steps did."""
    start, now = _facts(material, Moment()), _facts(material, moment)
    return frozenset(material.problem.mental.init) - (start - now) | (now - start)


def commands_of(material: Material, moment: Moment, present: GroundAtom | None) -> list[CommandView]:
    """List everything that can ever be commanded, so that the buttons keep their places."""
    game = material.game
    if game.length is not None:
        return []
    possible = set(game.commands(moment))
    return [
        CommandView(
            operator=format_action(action),
            object=action[-1],
            name=material.wording.names.get(action[-1], action[-1]),
            is_possible=action in possible,
            is_present=action == present,
        )
        for action in sorted(game.setting.truth.requests, key=_cell_order)
    ]


def _cell_order(action: GroundAtom) -> list[tuple[int, str]]:
    """Order names with numbers in them by the numbers: rooms in reading order."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in "-".join(action).split("-")]
