"""The grounded task: operators and facts by number, states as packed bytes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NewType

from explicable import _core
from explicable.errors import PlanError, UsageError
from explicable.model.explanation import object_to_step
from explicable.model.memory import available_memory_bytes
from explicable.model.problem import GroundAtom, Problem

State = NewType("State", bytes)
"""A packed state: immutable, hashable, and of meaning to its task only."""


@dataclass(frozen=True, slots=True)
class Execution:
    """An executed plan: the operators, the states before and after each, and what they cost together."""

    operators: tuple[int, ...]
    states: tuple[State, ...]
    cost: int


@dataclass(frozen=True)
class Task:
    """A grounded task. Made by `explicable.model.grounding.ground`.

    Facts that are true at the start and never deleted are no facts of the task; conditions on them are left
    out. A negated atom that some condition asks for is a fact of its own, the complement: `fact` returns
    ``("not", ...)`` for it. Where the goal is a disjunction, one artificial fact stands for it, which
    *auxiliary* operators achieve at no cost: they may end a search, but are no steps of a plan, and their
    action is the empty tuple.

    Parameters
    ----------
    problem
        The lifted problem.
    core
        The compiled task, shared by all tasks that differ in the goal only.
    objects
        Names by number.
    goal
        Facts to be made true.
    goal_reachable
        False if not even the delete relaxation reaches the goal.
    """

    problem: Problem
    core: _core.Task
    objects: tuple[str, ...]
    goal: tuple[int, ...]
    goal_reachable: bool = True

    @property
    def num_facts(self) -> int:
        """Number of facts."""
        return self.core.num_facts

    @property
    def num_operators(self) -> int:
        """Number of operators."""
        return self.core.num_operators

    @cached_property
    def initial_state(self) -> State:
        """The state at the start."""
        return State(self.core.pack(self.core.initial))

    @cached_property
    def search_memory_bytes(self) -> int:
        """What a search may hold by default: three fifths of what was left at the task's first search.

        Asked once, since the operating system takes up to a millisecond to answer.
        """
        return available_memory_bytes() // 5 * 3

    def action(self, operator: int) -> GroundAtom:
        """Return ``(schema, object, ...)`` of an operator; the empty tuple if it is auxiliary."""
        action = self._actions.get(operator)
        if action is None:
            schema = self.core.operator_schema(operator)
            if schema == _core.AUXILIARY:
                return ()
            names = [self.objects[argument] for argument in self.core.operator_arguments(operator)]
            action = self._actions[operator] = (self.problem.domain.actions[schema].name, *names)
        return action

    @cached_property
    def actions(self) -> tuple[GroundAtom, ...]:
        """The `action` of each operator, for those who need all of them."""
        schemas, names = self.problem.domain.actions, self.objects
        ends = self.core.array("operator_arguments.offsets").tolist()
        arguments = [names[argument] for argument in self.core.array("operator_arguments.values").tolist()]
        return tuple(
            () if schema == _core.AUXILIARY else (schemas[schema].name, *arguments[begin:end])
            for schema, begin, end in zip(
                self.core.array("operator_schema").tolist(), ends[:-1], ends[1:], strict=True
            )
        )

    def fact(self, fact: int) -> GroundAtom:
        """Return ``(predicate, object, ...)`` of a fact; ``("not", predicate, ...)`` of a complement."""
        predicate = self.core.fact_predicate(fact)
        if predicate == _core.AUXILIARY:
            return ("goal achieved",)
        names = tuple(self.objects[argument] for argument in self.core.fact_arguments(fact))
        if predicate < 0:
            return ("not", self.problem.domain.predicates[~predicate].name, *names)
        return (self.problem.domain.predicates[predicate].name, *names)

    def cost(self, operator: int) -> int:
        """Return what an operator costs."""
        return self.core.cost(operator)

    def operators_of(self, action: GroundAtom) -> tuple[int, ...]:
        """Return the operators of an action.

        Several if its precondition is a disjunction, none if it is never possible.
        """
        operators = self._operators.get(action)
        if operators is None:
            schema = self._schema_numbers.get(action[0]) if action else None
            numbers = self._numbers(action[1:])
            if schema is None or numbers is None:
                return ()
            operators = tuple(self.core.find_operators(schema, numbers))
            if operators:  # what is no action is not kept: anybody may ask anything
                self._operators[action] = operators
        return operators

    def fact_number(self, atom: GroundAtom) -> int | None:
        """Return the number of a fact, or None if the atom never changes or is never true."""
        fact = self._facts.get(atom)
        if fact is None:
            predicate = self._predicate_numbers.get(atom[0]) if atom else None
            numbers = self._numbers(atom[1:])
            if predicate is None or numbers is None:
                return None
            fact = self.core.find_fact(predicate, numbers)
            if fact < 0:
                return None
            self._facts[atom] = fact
        return fact

    def applicable(self, state: State) -> list[int]:
        """Operators that a state allows, in order."""
        return self.core.applicable(state)

    def is_applicable(self, state: State, operator: int) -> bool:
        """Whether a state allows an operator."""
        return self.core.is_applicable(state, operator)

    def successor(self, state: State, operator: int) -> State:
        """Return the state after an operator, which must be applicable."""
        return State(self.core.successor(state, operator))

    def follow(self, state: State, operators: Sequence[int]) -> State:
        """Return the state after some operators, each of which must be applicable in its turn."""
        return State(self.core.follow(state, operators))

    def is_goal(self, state: State) -> bool:
        """Whether the goal holds in a state."""
        if not self.goal_reachable:
            return False
        if self.core.holds(state, self.goal):
            return True
        ends = self._auxiliary_operators
        return bool(ends) and any(
            self.core.is_applicable(state, operator) and self.goal == tuple(self.core.adds(operator))
            for operator in ends
        )

    def atoms(self, state: State) -> frozenset[GroundAtom]:
        """Atoms that are true in a state and not in all states."""
        atoms = self._fact_atoms
        return frozenset(atom for fact in self.core.true_facts(state) if (atom := atoms[fact]) is not None)

    def holds(self, atom: GroundAtom, state: State) -> bool:
        """Whether an atom, be it a fact or constant, is true in a state."""
        fact = self.fact_number(atom)
        return atom in self._initial_atoms if fact is None else self.core.holds(state, [fact])

    def state_of(self, atoms: Iterable[GroundAtom]) -> State:
        """Return the state in which the given facts are true, and no others.

        Atoms that are always true may be given too.

        Raises
        ------
        UsageError
            If an atom is true in no reachable state, or two of them exclude each other.
        """
        facts = set()
        for atom in atoms:
            fact = self.fact_number(atom)
            if fact is not None:
                facts.add(fact)
            elif atom not in self._initial_atoms:
                raise UsageError(f"({' '.join(atom)}) is never true in this task")
        facts.update(complement for complement, fact in self._complements if fact not in facts)
        try:
            return State(self.core.pack(sorted(facts)))
        except ValueError as error:
            raise UsageError(str(error)) from error

    def with_goal(self, atoms: Iterable[GroundAtom]) -> "Task":
        """Return the same task with another goal, a conjunction of atoms; the two share all data."""
        goal = set()
        reachable = True
        for atom in atoms:
            fact = self.fact_number(atom)
            if fact is not None:
                goal.add(fact)
            elif atom not in self._initial_atoms:
                reachable = False
        return replace(self, goal=tuple(sorted(goal)), goal_reachable=reachable)

    def execute(self, actions: Iterable[GroundAtom], state: State | None = None) -> Execution:
        """Execute a plan from a state, by default the initial one.

        Raises
        ------
        PlanError
            At the first step that is not applicable; names the step, its number and what it lacks.
        """
        states = [self.initial_state if state is None else state]
        operators: list[int] = []
        for number, action in enumerate(actions, start=1):
            possible = [o for o in self.operators_of(action) if self.is_applicable(states[-1], o)]
            if not possible:
                objection = object_to_step(self.problem, action, partial(self.holds, state=states[-1]))
                raise PlanError(f"step {number}, ({' '.join(action)}), {objection}", step=number)
            operators.append(possible[0])
            states.append(self.successor(states[-1], possible[0]))
        return Execution(tuple(operators), tuple(states), sum(map(self.cost, operators)))

    @cached_property
    def _actions(self) -> dict[int, GroundAtom]:
        """Those that were asked for, by operator."""
        return {}

    @cached_property
    def _operators(self) -> dict[GroundAtom, tuple[int, ...]]:
        """Of the actions that were asked about."""
        return {}

    @cached_property
    def _facts(self) -> dict[GroundAtom, int]:
        """Those that were asked about, by atom."""
        return {}

    def _numbers(self, names: Sequence[str]) -> list[int] | None:
        numbers = self._object_numbers
        try:
            return [numbers[name] for name in names]
        except KeyError:
            return None

    @cached_property
    def _object_numbers(self) -> dict[str, int]:
        return {name: number for number, name in enumerate(self.objects)}

    @cached_property
    def _schema_numbers(self) -> dict[str, int]:
        return {action.name: number for number, action in enumerate(self.problem.domain.actions)}

    @cached_property
    def _predicate_numbers(self) -> dict[str, int]:
        return {predicate.name: number for number, predicate in enumerate(self.problem.domain.predicates)}

    @cached_property
    def _initial_atoms(self) -> frozenset[GroundAtom]:
        return frozenset(self.problem.init)

    @cached_property
    def _fact_atoms(self) -> list[GroundAtom | None]:
        predicates = self.core.array("fact_predicate")
        return [self.fact(fact) if predicate >= 0 else None for fact, predicate in enumerate(predicates)]

    @cached_property
    def _complements(self) -> list[tuple[int, int]]:
        """Each complement with the fact that it negates."""
        return [
            (fact, self.core.find_fact(~predicate, self.core.fact_arguments(fact)))
            for fact, predicate in enumerate(self.core.array("fact_predicate"))
            if predicate < 0 and predicate != _core.AUXILIARY
        ]

    @cached_property
    def _auxiliary_operators(self) -> list[int]:
        return self.core.find_operators(_core.AUXILIARY, [])
