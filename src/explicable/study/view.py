"""What a participant is shown: nothing that is hidden from people, nothing that tells who made a plan."""

from dataclasses import dataclass, field
from typing import Literal

from pydantic import BaseModel

from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.study.conduct import Standing
from explicable.study.game import Moment
from explicable.study.materials import Material
from explicable.study.pictures import Scene, Translate
from explicable.study.sentences import changed
from explicable.study.words import Language

Phase = Literal["question", "moving", "waiting", "over"]

_MOST_LOOKS = 10_000


class CommandView(BaseModel):
    """A command that the person can give, or could have given before its room was visited."""

    operator: str
    object: str
    name: str
    is_possible: bool
    is_present: bool


class View(BaseModel):
    """A task as it stands, for the page.

    ``number`` counts the steps so far; ``phase`` says what is due: an answer, the next step after ``wait_s``
    seconds, a command, or nothing more. ``task`` and ``operator`` are there for simulated participants only.
    """

    stage: str
    position: int
    num_tasks: int
    revision: int
    number: int
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


@dataclass(frozen=True, slots=True)
class _Look:
    """How a task looks: the same whenever it is in the same state by the same step."""

    picture: str | None
    sentence: str
    announced: str
    commands: list[CommandView]


@dataclass(frozen=True)
class Views:
    """Describes in words and pictures where sessions stand; what has been drawn is remembered.

    Parameters
    ----------
    language
        What participants read.
    """

    language: Language
    _looks: dict[object, _Look] = field(default_factory=dict, compare=False, repr=False)

    def view(self, standing: Standing) -> View:
        """Describe where a session stands."""
        session, material, moment = standing.session, standing.material, standing.moment
        if material is None or moment is None:
            return View(
                stage=session.stage,
                position=session.position,
                num_tasks=standing.num_tasks,
                revision=session.revision,
                number=0,
                phase="over",
                is_replay=False,
            )
        game, condition = material.game, material.condition
        request = game.request(moment)
        look = self._look(material, moment, request.action if request else None)
        true, false = _changes(material, moment)
        is_simulated = session.origin == "simulated"
        return View(
            stage=session.stage,
            position=session.position,
            num_tasks=standing.num_tasks,
            revision=session.revision,
            number=len(moment.steps),
            phase=phase_of(material, moment),
            is_replay=game.length is not None,
            picture=look.picture,
            sentence=look.sentence,
            announced=look.announced,
            became_true=[material.wording.fact(atom) for atom in true],
            became_false=[material.wording.fact(atom) for atom in false],
            commands=look.commands,
            wait_s=condition.step_s if request or game.length is not None else condition.idle_step_s,
            task=material.task.name if is_simulated else None,
            condition=condition.name if is_simulated else None,
            operator=operator_of(moment) if is_simulated else None,
        )

    def _look(self, material: Material, moment: Moment, target: GroundAtom | None) -> _Look:
        last = moment.steps[-1] if moment.steps else None
        step = last and (last.agent, last.action)
        names = material.task.name, material.condition.name
        key = (*names, material.game.state(moment), step, moment.announced, target)
        look = self._looks.get(key)
        if look is None:
            if len(self._looks) >= _MOST_LOOKS:
                self._looks.clear()
            look = self._looks[key] = _Look(
                _picture(material, moment, target, self.language.text),
                _said(material, last.action) if last else "",
                _said(material, moment.announced) if moment.announced else "",
                commands_of(material, moment, target),
            )
        return look


def _said(material: Material, action: GroundAtom) -> str:
    return material.wording.sentence(action, material.problem.agent_of(action).name)


def operator_of(moment: Moment) -> str | None:
    """Return the step announced, or else the last one."""
    if moment.announced:
        return format_action(moment.announced)
    return format_action(moment.steps[-1].action) if moment.steps else None


def phase_of(material: Material, moment: Moment) -> Phase:
    """Say what is due in a task."""
    game = material.game
    if game.question(moment) is not None:
        return "question"
    if game.is_over(moment):
        return "over"
    return "moving" if game.upcoming(moment) is not None else "waiting"


def _changes(material: Material, moment: Moment) -> tuple[list[GroundAtom], list[GroundAtom]]:
    """Return what the last step changed, where no picture shows it."""
    if (material.pictures is not None and material.pictures.shows_changes) or not moment.steps:
        return [], []
    before = _facts(material, Moment(moment.steps[:-1]))
    return changed(before, _facts(material, moment))


def _facts(material: Material, moment: Moment) -> frozenset[GroundAtom]:
    task = material.game.setting.truth.task
    atoms = task.atoms(material.game.state(moment))
    return frozenset(atom for atom in atoms if " " not in atom[0])  # without the stage's own switches


def _believed(material: Material, moment: Moment) -> frozenset[GroundAtom]:
    """Return the facts as the person has them: believed at the start, then changed as the steps did."""
    start, now = _facts(material, Moment()), _facts(material, moment)
    return frozenset(material.problem.mental.init) - (start - now) | (now - start)


def _picture(
    material: Material, moment: Moment, target: GroundAtom | None, translate: Translate
) -> str | None:
    if material.pictures is None:
        return None
    last = moment.steps[-1].action if moment.steps else None
    facts = _facts(material, moment) if material.pictures.shows_changes else _believed(material, moment)
    scene = Scene(facts, target, last, moment.announced)
    return material.pictures.draw(scene, translate(material.pictures.title))


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
