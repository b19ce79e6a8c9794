"""First-response maps as team planning problems.

The robot's problem holds the map as it is, the person's the map as they believe it. Schemas and objects are
the same in both. They differ in one fact for each hidden obstacle: the person takes its cell to be clear.
"""

from dataclasses import replace
from typing import Literal, get_args

from explicable.errors import UsageError
from explicable.first_response.world import Cell, View, World, cell_name
from explicable.model.problem import (
    ActionSchema,
    And,
    Atom,
    Domain,
    Effect,
    GroundAtom,
    Parameter,
    Predicate,
    Problem,
)
from explicable.model.team import TeamProblem

Semantics = Literal["persistent", "exclusive"]

PERSON = "person"
"""Name of the human who gives the commands; of several, see `person_name`."""


def robot_name(index: int) -> str:
    """Name the robot that starts at ``world.robots[index]``.

    Examples
    --------
    >>> robot_name(0)
    'r1'
    """
    return f"r{index + 1}"


def person_name(index: int) -> str:
    """Name one of the people.

    Examples
    --------
    >>> person_name(0), person_name(1)
    ('person', 'person-2')
    """
    return f"{PERSON}-{index + 1}" if index else PERSON


def encode(world: World, semantics: Semantics = "persistent", *, num_people: int = 1) -> TeamProblem:
    """Express a map as a team problem (method page, section 5).

    Parameters
    ----------
    world
        The map. Each ``@`` is a robot, ``r1``, ``r2``, ... in reading order; the human is ``person``. Cells
        of walls do not occur. Robots do not stand in each other's way.
    semantics
        ``persistent``: a command permits a visit from then on and is never withdrawn; moves are not tied to a
        command; a room may be commanded anew, which makes it the present target again. ``exclusive``: one
        command is in force; robots move only under a command; a new one replaces it, and visiting the room
        fulfils it.

    num_people
        Humans who give commands; they believe the same. Under ``exclusive``, too, one command is in force.

    Raises
    ------
    UsageError
        Unknown semantics, or nobody who commands.

    Examples
    --------
    >>> from explicable.first_response.world import World
    >>> team = encode(World(("@x*", "..o")))
    >>> sorted(set(team.mental.init) - set(team.robot.init))
    [('clear', 'c-0-1')]
    >>> [schema.name for schema in team.robot.domain.actions]
    ['command', 'move', 'remove-obstacle', 'visit-room']
    """
    if semantics not in get_args(Semantics):
        raise UsageError(f"semantics must be one of {', '.join(get_args(Semantics))}, not {semantics!r}")
    if num_people < 1:
        raise UsageError(f"somebody must command, not {num_people} people")
    names = _cell_names(world)
    facts = _shared_facts(world, names)
    problem = Problem(
        name="first-response-map",
        domain=first_response_domain(semantics),
        objects=_objects(world, names, num_people),
        init=(*facts, *_clear_facts(world, names, "robot")),
        goal=And(tuple(Atom("visited", (names[cell],)) for cell in world.marks)),
        values={},
    )
    believed = replace(problem, init=(*facts, *_clear_facts(world, names, "human")))
    return TeamProblem(robot=problem, human=believed)


def first_response_domain(semantics: Semantics = "persistent") -> Domain:
    """Return the domain of all first-response maps.

    A *room* is a cell that is marked; who gives commands is a *human*, who acts on them is a *robot*.
    Preconditions are positive throughout. Only the exclusive domain has a quantified effect; it grounds to
    plain deletes.

    Examples
    --------
    >>> sorted(first_response_domain("exclusive").requirements)
    [':conditional-effects', ':strips', ':typing']
    """
    exclusive = semantics == "exclusive"
    predicates = [
        Predicate("at", (_ROBOT, _CELL)),
        Predicate("adjacent", (_FROM, _TO)),
        Predicate("clear", (_CELL,)),
        Predicate("obstacle", (_CELL,)),
        Predicate("unvisited", (_ROOM,)),
        Predicate("visited", (_ROOM,)),
        Predicate("commanded", (_ROOM,)),
    ]
    if exclusive:
        predicates.append(Predicate("under-command", ()))
    return Domain(
        name=f"first-response-{semantics}",
        requirements=frozenset({":strips", ":typing"} | ({":conditional-effects"} if exclusive else set())),
        types={
            "agent": ("object",),
            "robot": ("agent",),
            "human": ("agent",),
            "cell": ("object",),
            "room": ("cell",),
        },
        constants={},
        predicates=tuple(predicates),
        functions=(),
        actions=_exclusive_actions() if exclusive else _persistent_actions(),
    )


_HUMAN = Parameter("?h", ("human",))
_ROBOT = Parameter("?r", ("robot",))
_CELL = Parameter("?c", ("cell",))
_ROOM = Parameter("?c", ("room",))
_FROM = Parameter("?from", ("cell",))
_TO = Parameter("?to", ("cell",))


def _persistent_actions() -> tuple[ActionSchema, ...]:
    command = ActionSchema(
        name="command",
        parameters=(_HUMAN, _ROOM),
        precondition=_all("unvisited ?c"),
        effects=_effects("commanded ?c"),
    )
    visit = ActionSchema(
        name="visit-room",
        parameters=(_ROBOT, _ROOM),
        precondition=_all("at ?r ?c", "commanded ?c", "unvisited ?c"),
        effects=_effects("visited ?c", "not unvisited ?c"),
    )
    return (command, *_motions(), visit)


def _exclusive_actions() -> tuple[ActionSchema, ...]:
    # Of a delete and an add of the same atom the add prevails: the new command stays.
    other = Parameter("?other", ("room",))
    withdraw = Effect(Atom("commanded", (other.name,)), positive=False, parameters=(other,))
    command = ActionSchema(
        name="command",
        parameters=(_HUMAN, _ROOM),
        precondition=_all("unvisited ?c"),
        effects=(withdraw, *_effects("commanded ?c", "under-command")),
    )
    visit = ActionSchema(
        name="visit-room",
        parameters=(_ROBOT, _ROOM),
        precondition=_all("at ?r ?c", "commanded ?c"),
        effects=_effects("visited ?c", "not unvisited ?c", "not commanded ?c", "not under-command"),
    )
    return (command, *_motions("under-command"), visit)


def _motions(*conditions: str) -> tuple[ActionSchema, ...]:
    """Return the two ways to change place, each tied to the conditions."""
    there = ("at ?r ?to", "not at ?r ?from")
    move = ActionSchema(
        name="move",
        parameters=(_ROBOT, _FROM, _TO),
        precondition=_all("at ?r ?from", "adjacent ?from ?to", "clear ?to", *conditions),
        effects=_effects(*there),
    )
    remove = ActionSchema(
        name="remove-obstacle",
        parameters=(_ROBOT, _FROM, _TO),
        precondition=_all("at ?r ?from", "adjacent ?from ?to", "obstacle ?to", *conditions),
        effects=_effects(*there, "clear ?to", "not obstacle ?to"),
    )
    return move, remove


def _all(*atoms: str) -> And:
    return And(tuple(_atom(atom.split()) for atom in atoms))


def _effects(*literals: str) -> tuple[Effect, ...]:
    effects = []
    for literal in literals:
        negation, *words = literal.split()
        if negation == "not":
            effects.append(Effect(_atom(words), positive=False))
        else:
            effects.append(Effect(_atom([negation, *words])))
    return tuple(effects)


def _atom(words: list[str]) -> Atom:
    return Atom(words[0], tuple(words[1:]))


def _cell_names(world: World) -> dict[Cell, str]:
    walls = world.walls
    return {
        (row, column): cell_name((row, column))
        for row in range(world.height)
        for column in range(world.width)
        if (row, column) not in walls
    }


def _objects(world: World, names: dict[Cell, str], num_people: int) -> dict[str, tuple[str, ...]]:
    objects: dict[str, tuple[str, ...]] = {person_name(index): ("human",) for index in range(num_people)}
    objects.update((robot_name(index), ("robot",)) for index in range(len(world.robots)))
    objects.update(dict.fromkeys(names.values(), ("cell",)))
    objects.update((names[cell], ("room",)) for cell in world.marks)
    return objects


def _shared_facts(world: World, names: dict[Cell, str]) -> list[GroundAtom]:
    """Return the initial facts that robot and person agree on."""
    facts: list[GroundAtom] = []
    facts += [("at", robot_name(index), names[cell]) for index, cell in enumerate(world.robots)]
    facts += [("unvisited", names[cell]) for cell in world.marks]
    facts += [("obstacle", names[cell]) for cell in sorted(world.obstacles)]
    for (row, column), name in names.items():
        for cell in ((row, column + 1), (row + 1, column)):
            if cell in names:
                facts += (("adjacent", name, names[cell]), ("adjacent", names[cell], name))
    return facts


def _clear_facts(world: World, names: dict[Cell, str], view: View) -> list[GroundAtom]:
    not_clear = world.blocked(view) | world.obstacles
    return [("clear", name) for cell, name in names.items() if cell not in not_clear]
