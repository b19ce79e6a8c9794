"""A validator that shares no code with explicable: Fast Downward's reader, the plain meaning of lifted PDDL.

Usage: `python validate.py DOMAIN PROBLEM PLAN`, in the environment of the peers; prints one JSON object.
"""

import json
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from fast_downward.translate import options, pddl, pddl_parser

Binding = dict[str, str]
State = frozenset[tuple[str, ...]]


class Validator:
    """Executes plans on the task that two PDDL files describe."""

    def __init__(self, domain: Path, problem: Path) -> None:
        options.set_options([str(domain), str(problem)])
        self.task = pddl_parser.open(domain_filename=str(domain), problem_filename=str(problem))
        assert not self.task.axioms, "derived predicates are not read"
        supertypes = {t.name: {t.name, *t.supertype_names} for t in self.task.types}
        self.objects = {
            name: [o.name for o in self.task.objects if name in supertypes[o.type_name]]
            for name in supertypes
        }
        self.actions = {action.name: action for action in self.task.actions}
        atoms = [fact for fact in self.task.init if isinstance(fact, pddl.Atom)]
        self.initial = frozenset((atom.predicate, *atom.args) for atom in atoms)
        values = [fact for fact in self.task.init if not isinstance(fact, pddl.Atom)]
        self.values = {(v.fluent.symbol, *v.fluent.args): v.expression.value for v in values}

    def bindings(self, parameters: list, binding: Binding) -> Iterator[Binding]:
        """Extend `binding` to `parameters` in every way that their types allow."""
        for names in product(*(self.objects[p.type_name] for p in parameters)):
            yield binding | {p.name: name for p, name in zip(parameters, names, strict=True)}

    def holds(self, condition: pddl.conditions.Condition, state: State, binding: Binding) -> bool:
        """Say whether a condition of the reader holds."""
        match condition:
            case pddl.Literal():
                atom = (condition.predicate, *(binding.get(a, a) for a in condition.args))
                return condition.negated != (atom in state)
            case pddl.UniversalCondition():
                every = self.bindings(condition.parameters, binding)
                return all(self.holds(part, state, b) for b in every for part in condition.parts)
            case pddl.ExistentialCondition():
                every = self.bindings(condition.parameters, binding)
                return any(self.holds(part, state, b) for b in every for part in condition.parts)
            case pddl.Disjunction():
                return any(self.holds(part, state, binding) for part in condition.parts)
            case pddl.Conjunction() | pddl.Truth():
                return all(self.holds(part, state, binding) for part in condition.parts)
            case pddl.conditions.Falsity():
                return False
        raise TypeError(condition)

    def cost(self, action: pddl.Action, binding: Binding) -> int:
        """Cost of a step: 1 without a metric, as the planning competition counts."""
        if not self.task.use_min_cost_metric:
            return 1
        if action.cost is None:
            return 0
        amount = action.cost.expression
        if isinstance(amount, pddl.NumericConstant):
            return amount.value
        return self.values[(amount.symbol, *(binding.get(a, a) for a in amount.args))]

    def step(self, words: list[str], state: State) -> tuple[State, int]:
        """Successor of `state` and cost of the step; raises ValueError if it is not applicable."""
        action = self.actions[words[0]]
        binding = {p.name: name for p, name in zip(action.parameters, words[1:], strict=True)}
        for parameter in action.parameters:
            if binding[parameter.name] not in self.objects[parameter.type_name]:
                raise ValueError(f"{binding[parameter.name]} is not of type {parameter.type_name}")
        if not self.holds(action.precondition, state, binding):
            raise ValueError("its precondition does not hold")
        changes: dict[bool, set] = {True: set(), False: set()}
        for effect in action.effects:
            for each in self.bindings(effect.parameters, binding):
                if self.holds(effect.condition, state, each):
                    literal = effect.literal
                    changes[literal.negated].add((literal.predicate, *(each.get(a, a) for a in literal.args)))
        return (state - changes[True]) | changes[False], self.cost(action, binding)

    def execute(self, plan: str) -> dict:
        """Judge the text of a plan file."""
        state, total, length = self.initial, 0, 0
        for line in plan.lower().splitlines():
            words = line.split(";")[0].replace("(", " ").replace(")", " ").split()
            if not words:
                continue
            try:
                state, cost = self.step(words, state)
            except (KeyError, ValueError) as error:
                return {"valid": False, "why": f"step {length + 1} ({' '.join(words)}): {error}"}
            total, length = total + cost, length + 1
        if not self.holds(self.task.goal, state, {}):
            return {"valid": False, "why": "the goal does not hold at the end"}
        return {"valid": True, "plan_cost": total, "plan_length": length}


if __name__ == "__main__":
    domain, problem, plan = map(Path, sys.argv[1:])
    print(json.dumps(Validator(domain, problem).execute(plan.read_text())))
