"""What a study is made of, read and prepared: problems, plans, pictures, words."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from explicable.errors import InputError, PlanError
from explicable.execution import Setting, prepare
from explicable.first_response import World, encode, read_map
from explicable.labelling import Labeller
from explicable.model.files import read_text
from explicable.model.plan import format_action, read_plan
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem
from explicable.pddl import read_team_problem
from explicable.study.config import FILE, Condition, Study, Task
from explicable.study.game import Game, play_by_commands, replay
from explicable.study.pictures import MapPictures, Pictures
from explicable.study.places import place_pictures
from explicable.study.protocol import ConflictError
from explicable.study.sentences import Wording
from explicable.study.study_file import read_study
from explicable.study.teaming import LabelledPlanner, Teaming
from explicable.study.words import Language, language

PRACTICE = "practice"
"""Name of the practice task in the data."""


@dataclass(frozen=True, slots=True)
class Material:
    """One task under one condition, ready to be put before people."""

    task: Task
    condition: Condition
    problem: TeamProblem
    game: Game
    wording: Wording
    pictures: Pictures | None


@dataclass(frozen=True)
class Materials:
    """A study with all that it names; tasks are prepared when they are first needed, and kept.

    Parameters
    ----------
    folder
        The study's folder.
    study
        Its file, read.
    hash
        SHA-256 of everything that it is made of.
    """

    folder: Path
    study: Study
    hash: str
    _prepared: dict[tuple[str, str], Material] = field(default_factory=dict, repr=False, compare=False)
    _settings: dict[tuple[str, ...], Setting] = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def tasks(self) -> Mapping[str, Task]:
        """All tasks by name, practice included."""
        return {**{task.name: task for task in self.study.task}, PRACTICE: self.study.practice}

    @cached_property
    def conditions(self) -> Mapping[str, Condition]:
        """The conditions by name."""
        return {condition.name: condition for condition in self.study.conditions}

    @cached_property
    def language(self) -> Language:
        """What participants read."""
        return language(self.study.language)

    def material(self, task: str, condition: str) -> Material:
        """Return a task, prepared for a condition.

        Raises
        ------
        ConflictError
            If the study does not have them, or no longer.
        """
        if (task, condition) not in self._prepared:
            if task not in self.tasks or condition not in self.conditions:
                raise ConflictError("the study has changed, and what you had begun is no longer in it")
            self._prepared[task, condition] = self._prepare(self.tasks[task], self.conditions[condition])
        return self._prepared[task, condition]

    def check(self) -> None:
        """Prepare every task and read every text, so that what is wrong is said before people come."""
        for name in self.study.texts.model_dump(exclude_none=True):
            self.text(name)
        for condition in self.conditions:
            for task in self.tasks:
                self.material(task, condition)

    def text(self, name: str) -> str | None:
        """Return one of the study's own texts (Markdown), if it has it."""
        file = getattr(self.study.texts, name)
        if file is None:
            return None
        path = resolve(self.folder, file)
        return read_text(path)

    def _prepare(self, task: Task, condition: Condition) -> Material:
        world = read_map(resolve(self.folder, task.map)) if task.map else None
        setting = self._setting(task, world, condition)
        domain = setting.problem.composite.domain
        plan = self._plan(task, setting) if task.plan else None
        if plan is not None:
            game = Game(setting, condition.ask, replay(plan), len(plan))
        elif condition.mode == "teaming":
            teaming = Teaming(setting, self._planner(condition))
            game = Game(setting, condition.ask, teaming.choose, expected=teaming.expected)
        else:
            game = Game(setting, condition.ask, play_by_commands(setting, condition.mode))
        wording = Wording(domain, self.study.sentences, self.study.facts)
        pictures = self._pictures(task, world, setting)
        if pictures is not None:
            translate = self.language.text
            wording = replace(
                wording,
                sentences={**pictures.sentences(translate), **wording.sentences},
                names=pictures.names(translate),
            )
        wording.check()
        return Material(task, condition, setting.problem, game, wording, pictures)

    def _pictures(self, task: Task, world: World | None, setting: Setting) -> Pictures | None:
        """Return the renderer that the task names; of a map it need not name any."""
        if task.renderer == "first-response" and world:
            return MapPictures(world)
        if task.renderer == "none":
            return None
        inside = {name: _arguments(text) for name, text in self.study.places.items()}
        truth, mental = setting.truth.task, setting.problem.mental.init
        pictures = place_pictures([*map(truth.fact, range(truth.num_facts)), *mental], inside)
        if not pictures.places:
            named = ", ".join(inside)
            message = (
                f"task {task.name!r}: nothing is anywhere by the predicates {named}; name others in [places]"
            )
            raise InputError(message, path=self.folder / FILE)
        return pictures

    def _setting(self, task: Task, world: World | None, condition: Condition) -> Setting:
        semantics = condition.semantics if world and not task.domain else ""
        names = (task.map, task.domain, task.problem, task.human_domain, task.human_problem)
        key = (semantics, *(name or "" for name in names))
        if key not in self._settings:
            if world and not task.domain:
                problem = encode(world, condition.semantics)
            else:
                files = [resolve(self.folder, name) if name else None for name in names[1:]]
                problem = read_team_problem(*files)  # type: ignore[arg-type]  # the first two are there
            self._settings[key] = prepare(problem)
        return self._settings[key]

    def _planner(self, condition: Condition) -> LabelledPlanner:
        path = resolve(self.folder, condition.labeller or "")
        return LabelledPlanner(Labeller.load(path), condition.alpha, condition.planning_s)

    def _plan(self, task: Task, setting: Setting) -> tuple[GroundAtom, ...]:
        path = resolve(self.folder, task.plan or "")
        plan, state = read_plan(path), setting.truth.task.initial_state
        if not plan:
            raise PlanError("a plan without steps can't be shown", path=path)
        for number, action in enumerate(plan, start=1):
            after = setting.truth.after(state, action)
            if after is None:
                message = f"step {number}, {format_action(action)}, can't be executed there"
                raise PlanError(f"{message} (task {task.name!r})", path=path)
            state = after
        return plan


def _arguments(text: str) -> tuple[int, int]:
    """Read which argument is in which other, such as ``1 in 2``."""
    thing, place = text.split(" in ")
    return int(thing), int(place)


def read_materials(folder: str | Path) -> Materials:
    """Read a study with the files that it names; tasks are prepared later, see `Materials.check`.

    Raises
    ------
    InputError
        If something is missing or wrong.
    """
    folder = Path(folder)
    study = read_study(folder)
    try:
        return Materials(folder, study, study_hash(folder, study))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path=error.filename) from error


def resolve(folder: Path, name: str) -> Path:
    """Return the path of a file of the study, which lies in its folder.

    Raises
    ------
    InputError
        If the name leads out of the folder, or is none.

    Examples
    --------
    >>> resolve(Path("study"), "../secret")
    Traceback (most recent call last):
    explicable.errors.InputError: study/study.toml: '../secret' lies outside the study's folder
    """
    try:
        inside = (folder / name).resolve().is_relative_to(folder.resolve())
    except (ValueError, RuntimeError, OSError) as error:  # a null byte; links in a circle
        raise InputError(f"{name!r} is no name of a file", path=folder / FILE) from error
    if not inside:
        raise InputError(f"{name!r} lies outside the study's folder", path=folder / FILE)
    return folder / name


def study_hash(folder: Path, study: Study) -> str:
    """Return the SHA-256 of the study's file and of every file that it names."""
    names = [FILE, *study.practice.files, *study.texts.model_dump(exclude_none=True).values()]
    names += [name for task in study.task for name in task.files]
    names += [condition.labeller for condition in study.conditions if condition.labeller is not None]
    digest = hashlib.sha256()
    for name in dict.fromkeys(names):
        digest.update(hashlib.sha256(resolve(folder, name).read_bytes()).digest())
    return digest.hexdigest()
