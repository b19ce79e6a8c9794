"""A picture of any domain in which things are somewhere: boxes in boxes, by predicates such as ``at``."""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING

from explicable.study.pictures import Scene, Translate

if TYPE_CHECKING:
    from explicable.model.problem import GroundAtom

_WIDTH = 400
_GAP, _LINE, _LETTER = 8, 30, 9.5
_INK, _PLACE, _THING, _ACTIVE, _ACTIVE_LINE = "#24272e", "#f3f1ea", "#ffffff", "#d5e8f3", "#00567f"


@dataclass(frozen=True, slots=True)
class PlacePictures:
    """The renderer of things in places.

    Parameters
    ----------
    places
        What things can be in and what is itself in nothing: always drawn, in this order.
    inside
        By predicate which of its arguments, counted from 1, is in which other.
    """

    places: tuple[str, ...]
    inside: Mapping[str, tuple[int, int]]
    shows_changes: bool = field(default=False, init=False)
    title: str = field(default="Where things are", init=False)

    def draw(self, scene: Scene, title: str) -> str:
        """Draw a state as SVG: who and what the step is about stands out.

        Examples
        --------
        >>> picture = PlacePictures(("hall", "yard"), {"at": (1, 2)}).draw(
        ...     Scene([("at", "r1", "hall")], step=("go", "r1", "yard", "hall")), "Where things are"
        ... )
        >>> picture.count("<rect"), ">r1<" in picture
        (3, True)
        """
        content = self._content(scene.facts)
        inside = {thing for things in content.values() for thing in things}
        roots = [*self.places, *sorted(set(content) - inside - set(self.places))]
        active = frozenset((scene.announced or scene.step or ())[1:])
        column = self._column(scene.facts)
        boxes = [_make_box(name, content, active, frozenset(), column) for name in roots]
        drawing, width, height = _flow(boxes, _WIDTH)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" role="img"'
            f' font-family="sans-serif" font-size="16"><title>{escape(title)}</title>{drawing}</svg>'
        )

    def names(self, _: Translate) -> Mapping[str, str]:
        """Return what the objects are called: their own names will do."""
        return {}

    def sentences(self, _: Translate) -> Mapping[str, str]:
        """Return templates of the domain's steps: it has none of its own."""
        return {}

    def _column(self, facts: "Collection[GroundAtom]") -> float:
        """Return the width of all places, so that they stay where they are whatever is in them."""
        pairs = [pair for atom in facts if (pair := thing_in_place(atom, self.inside))]
        longest = max(len(name) for name in (*self.places, *(name for pair in pairs for name in pair)))
        num = max(1, min(len(self.places), int((_WIDTH - _GAP) // (longest * _LETTER + 4 * _GAP + _GAP))))
        return (_WIDTH - _GAP) / num - _GAP

    def _content(self, facts: "Collection[GroundAtom]") -> dict[str, list[str]]:
        content: dict[str, list[str]] = defaultdict(list)
        for atom in sorted(facts):
            pair = thing_in_place(atom, self.inside)
            if pair:
                content[pair[1]].append(pair[0])
        return content


def place_pictures(atoms: "Iterable[GroundAtom]", inside: Mapping[str, tuple[int, int]]) -> PlacePictures:
    """Make the renderer for a task: places are what things can be in, and what is never in anything.

    Parameters
    ----------
    atoms
        All that can be true.
    inside
        See `PlacePictures`.

    Examples
    --------
    >>> place_pictures([("at", "r1", "room-10"), ("at", "r1", "room-9")], {"at": (1, 2)}).places
    ('room-9', 'room-10')
    """
    pairs = [pair for atom in atoms if (pair := thing_in_place(atom, inside))]
    things = {thing for thing, _ in pairs}
    return PlacePictures(tuple(sorted({place for _, place in pairs} - things, key=_by_number)), inside)


def thing_in_place(atom: "GroundAtom", inside: Mapping[str, tuple[int, int]]) -> tuple[str, str] | None:
    """Return what an atom says to be in what, if it says so.

    Examples
    --------
    >>> thing_in_place(("carries", "cart", "parcel"), {"carries": (2, 1)})
    ('parcel', 'cart')
    """
    first, second = inside.get(atom[0], (0, 0))
    return (atom[first], atom[second]) if first and max(first, second) < len(atom) else None


@dataclass(frozen=True, slots=True)
class _Box:
    """Something drawn at (0, 0); ``draw`` takes the offset."""

    width: float
    height: float
    draw: Callable[[float, float], str]


def _make_box(
    name: str,
    content: Mapping[str, Sequence[str]],
    active: frozenset[str],
    around: frozenset[str],
    width: float = 0.0,
) -> _Box:
    """Make the box of an object with what is in it; ``around`` are the boxes about it, lest it never ends."""
    inner = [
        _make_box(thing, content, active, around | {name})
        for thing in content.get(name, ())
        if thing not in around | {name}
    ]
    label_width = len(name) * _LETTER + 2 * _GAP
    drawing, inner_width, inner_height = _flow(inner, width) if inner else ("", 0.0, 0.0)
    width, height = max(width, label_width, inner_width), _LINE + inner_height
    is_place = not around
    fill = _ACTIVE if name in active else _PLACE if is_place else _THING
    line = _ACTIVE_LINE if name in active else "#8b909b"
    thickness = 3 if name in active else 1

    def draw(x: float, y: float) -> str:
        return (
            f'<g transform="translate({x:g} {y:g})"><rect width="{width:g}" height="{height:g}" rx="6"'
            f' fill="{fill}" stroke="{line}" stroke-width="{thickness}"/>'
            f'<text x="{_GAP}" y="20" fill="{_INK}">{escape(name)}</text>'
            f'<g transform="translate(0 {_LINE - _GAP})">{drawing}</g></g>'
        )

    return _Box(width, height, draw)


def _flow(boxes: Sequence[_Box], most: float) -> tuple[str, float, float]:
    """Put boxes side by side in lines of a width; return the drawing with its size."""
    parts, x, y, line, widest = [], float(_GAP), float(_GAP), 0.0, 0.0
    for box in boxes:
        if x > _GAP and x + box.width + _GAP > most:
            x, y, line = float(_GAP), y + line + _GAP, 0.0
        parts.append(box.draw(x, y))
        x, line = x + box.width + _GAP, max(line, box.height)
        widest = max(widest, x)
    return "".join(parts), max(widest, 2.0 * _GAP), y + line + _GAP


def _by_number(name: str) -> list[tuple[int, str]]:
    """Order names with numbers in them by the numbers."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in name.replace("_", "-").split("-")]
