"""Effects and their costs: text -> model, each name checked where it stands."""

from dataclasses import dataclass, field

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import TRUE, Atom, Effect, Formula, FunctionTerm, Parameter
from explicable.pddl.formulas import FormulaReader, Scope, scope_of
from explicable.pddl.vocabulary import KEYWORDS


@dataclass(slots=True)
class EffectList:
    """What an action does, as collected while its effect is read."""

    effects: list[Effect] = field(default_factory=list)
    cost: list[int | FunctionTerm] = field(default_factory=list)


class EffectReader(FormulaReader):
    """Reads effects at a cursor, and the formulas within."""

    __slots__ = ()

    def read_effect(self, scope: Scope) -> EffectList:
        """Read the effect of an action; ``()`` does nothing."""
        found = EffectList()
        self._read_effect(scope, (), None, found)
        return found

    def _read_effect(
        self, scope: Scope, parameters: tuple[Parameter, ...], condition: Formula | None, found: EffectList
    ) -> None:
        """Read one effect under the `forall` parameters and the `when` condition around it."""
        cursor = self._cursor
        cursor.take_bracket("(")
        start = cursor.start
        match cursor.ahead:
            case ")":
                pass
            case "and":
                cursor.take()
                while not cursor.closes():
                    self._read_effect(scope, parameters, condition, found)
            case "forall" | "when" if condition is not None:
                raise cursor.error(f"'{cursor.ahead}' can't stand inside 'when'")
            case "forall":
                self._requirements.use(":conditional-effects", start)
                cursor.take()
                inner = self.read_parameters()
                if twice := scope_of(parameters).keys() & scope_of(inner).keys():
                    raise cursor.source.error(f"parameter '{min(twice)}' is declared twice", start)
                self._read_effect(scope | scope_of(inner), parameters + inner, condition, found)
            case "when":
                self._requirements.use(":conditional-effects", start)
                cursor.take()
                self._read_effect(scope, parameters, self.read_formula(scope), found)
            case "increase":
                if parameters or condition is not None:
                    raise cursor.error("conditional costs are not supported", UnsupportedFeatureError)
                found.cost.append(self._read_increase(scope))
            case "not":
                cursor.take()
                cursor.take_bracket("(")
                atom = self._read_effect_atom(scope)
                found.effects.append(Effect(atom, False, condition or TRUE, parameters))
            case _:
                atom = self._read_effect_atom(scope)
                found.effects.append(Effect(atom, True, condition or TRUE, parameters))
                return
        cursor.take_bracket(")")

    def _read_effect_atom(self, scope: Scope) -> Atom:
        if self._cursor.ahead in KEYWORDS:
            self._refuse_head()
        return self._read_atom(scope)

    def _read_increase(self, scope: Scope) -> int | FunctionTerm:
        """Read the rest of ``(increase (total-cost) amount)`` up to its closing bracket."""
        cursor = self._cursor
        cursor.take()
        start = cursor.taken
        if self.read_function_term(scope) != FunctionTerm("total-cost", ()):
            message = "numeric effects other than on 'total-cost' ('increase') are not supported"
            raise cursor.source.error(message, start, UnsupportedFeatureError)
        self._requirements.use(":action-costs", start)
        if cursor.ahead != "(":
            return self.read_amount()
        start = cursor.start
        amount = self.read_function_term(scope)
        if amount.name == "total-cost":
            message = "a cost that depends on 'total-cost' is not supported"
            raise cursor.source.error(message, start, UnsupportedFeatureError)
        return amount
