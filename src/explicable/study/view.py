"""What a participant is shown: nothing that is hidden from people, nothing that tells who made a plan."""

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


def view_of(standing: Standing, language: Language) -> View:
    """Describe where a session stands in words and pictures."""
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
    game, last = material.game, moment.steps[-1] if moment.steps else None
    request = game.request(moment)
    wording, translate = material.wording, language.text
    sentence = wording.sentence(last.action, last.agent) if last else ""
    announced = ""
    if moment.announced:
        agent = material.problem.agent_of(moment.announced).name
        announced = wording.sentence(moment.announced, agent)
    true, false = _changes(material, moment)
    is_simulated = session.origin == "simulated"
    condition = material.condition
    return View(
        stage=session.stage,
        position=session.position,
        num_tasks=standing.num_tasks,
        revision=session.revision,
        number=len(moment.steps),
        phase=phase_of(material, moment),
        is_replay=game.length is not None,
        picture=_picture(material, moment, request.action if request else None, translate),
        sentence=sentence,
        announced=announced,
        became_true=[wording.fact(atom) for atom in true],
        became_false=[wording.fact(atom) for atom in false],
        commands=commands_of(material, moment, request.action if request else None),
        wait_s=condition.step_s if request or game.length is not None else condition.idle_step_s,
        task=material.task.name if is_simulated else None,
        condition=condition.name if is_simulated else None,
        operator=operator_of(moment) if is_simulated else None,
    )


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
