"""What people see of a task: pictures by the renderer that the study names, and words for its objects."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from explicable.first_response.encoding import robot_name
from explicable.first_response.rendering import room_letters
from explicable.first_response.scene import render_scene, scene_key
from explicable.first_response.world import World, cell_name
from explicable.model.problem import GroundAtom

Translate = Callable[[str], str]


@dataclass(frozen=True, slots=True)
class Scene:
    """A state of a task, for a renderer.

    Parameters
    ----------
    facts
        The true atoms; where the picture does not show all changes, the atoms as the person has them.
    target
        The last command that stands, if any.
    step, announced
        The step just taken, and the one about to be taken.
    """

    facts: Collection[GroundAtom]
    target: GroundAtom | None = None
    step: GroundAtom | None = None
    announced: GroundAtom | None = None


class Pictures(Protocol):
    """A renderer, ready for one task.

    Attributes
    ----------
    shows_changes
        Whether the pictures show all that a step changes, so that words need not.
    title
        The pictures' accessible name, in English.
    """

    @property
    def shows_changes(self) -> bool: ...  # noqa: D102 (above)
    @property
    def title(self) -> str: ...  # noqa: D102 (above)

    def draw(self, scene: Scene, title: str) -> str:
        """Draw a state as SVG, as the person sees it."""
        ...

    def names(self, translate: Translate) -> Mapping[str, str]:
        """Return what the objects are called, where not by their own names."""
        ...

    def sentences(self, translate: Translate) -> Mapping[str, str]:
        """Return templates of the domain's steps, as far as there are any."""
        ...


@dataclass(frozen=True, slots=True)
class MapPictures:
    """The renderer of first-response maps."""

    world: World
    shows_changes: bool = field(default=True, init=False)
    title: str = field(default="Floor plan", init=False)

    def draw(self, scene: Scene, title: str) -> str:
        """Draw a state as SVG, as the person sees it."""
        return render_scene(
            self.world,
            scene.facts,
            target=scene.target[-1] if scene.target else None,
            step=scene.step,
            announced=scene.announced,
            title=title,
        )

    def names(self, translate: Translate) -> dict[str, str]:
        """Return what the objects are called."""
        names = {
            cell_name((row, column)): translate("row {row}, column {column}").format(row=row, column=column)
            for row in range(self.world.height)
            for column in range(self.world.width)
        }
        letters = room_letters(len(self.world.marks))
        for mark, letter in zip(self.world.marks, letters, strict=True):
            names[cell_name(mark)] = translate("room {letter}").format(letter=letter)
        several = len(self.world.robots) > 1
        for index in range(len(self.world.robots)):
            robot = translate("robot {number}").format(number=index + 1)
            names[robot_name(index)] = robot if several else translate("the robot")
        return names

    def sentences(self, translate: Translate) -> Mapping[str, str]:
        """Return the templates of the domain's steps."""
        return {
            "command": translate("The order is to visit {c}."),
            "move": translate("{agent} moves to {to}."),
            "remove-obstacle": translate("{agent} clears the obstacle at {to} and moves there."),
            "visit-room": translate("{agent} visits {c}."),
        }


def map_key(translate: Translate) -> list[tuple[str, str]]:
    """Return the signs of maps with their meanings."""
    return [(sign, translate(meaning)) for sign, meaning in scene_key()]
