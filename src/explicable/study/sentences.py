"""Steps and facts in words, for any PDDL domain."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from explicable.errors import InputError
from explicable.model.problem import Domain, GroundAtom

_FIELD = re.compile(r"\{([^{}]*)\}")


@dataclass(frozen=True, slots=True)
class Wording:
    """How a domain's steps and facts are said.

    Parameters
    ----------
    domain
        Gives schemas and predicates their parameters' names.
    sentences, facts
        Templates by action schema and by predicate. ``{agent}`` is who acts, ``{name}`` the argument of the
        parameter ``?name``, ``{1}``, ``{2}``, ... the arguments by number.
    names
        What an object is called; its own name where it is not in it.
    """

    domain: Domain
    sentences: Mapping[str, str] = field(default_factory=dict)
    facts: Mapping[str, str] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)

    def check(self) -> None:
        """Check that every template names a schema or predicate, and its parameters.

        Raises
        ------
        InputError
            With the template's name.
        """
        for kind, templates in (("sentences", self.sentences), ("facts", self.facts)):
            for name, template in templates.items():
                parameters = self._parameters(name, kind)
                if parameters is None:
                    continue  # of another domain of the same study
                words = self._fields(parameters, parameters, "agent")
                for used in _FIELD.findall(template):
                    if used not in words:
                        raise InputError(
                            f"{kind}.{name}: there is no {{{used}}}; known are {', '.join(words)}"
                        )

    def sentence(self, action: GroundAtom, agent: str) -> str:
        """Say a step.

        Examples
        --------
        >>> Wording(Domain("d", frozenset(), {}, {}, (), (), ())).sentence(("pick-up", "arm", "cup"), "arm")
        'Arm: pick up cup.'
        """
        template = self.sentences.get(action[0])
        if template is None:
            arguments = [self._name(name) for name in action[1:] if name != agent]
            words = " ".join([action[0].replace("-", " ").replace("_", " "), ", ".join(arguments)]).strip()
            return _begun(f"{self._name(agent)}: {words}.")
        return self._filled(template, action, "sentences", agent)

    def fact(self, atom: GroundAtom) -> str:
        """Say a fact.

        Examples
        --------
        >>> Wording(Domain("d", frozenset(), {}, {}, (), (), ())).fact(("on-table", "cup"))
        'on table: cup'
        >>> Wording(Domain("d", frozenset(), {}, {}, (), (), ())).fact(("holding", "arm", "cup"))
        'arm holding cup'
        """
        template = self.facts.get(atom[0])
        if template is None:
            words = atom[0].replace("-", " ").replace("_", " ")
            arguments = [self._name(name) for name in atom[1:]]
            if len(arguments) == 2:  # (at cart dock), (holding arm cup): as most domains mean it
                return f"{arguments[0]} {words} {arguments[1]}"
            return f"{words}: {', '.join(arguments)}" if arguments else words
        return self._filled(template, atom, "facts", "")

    def _filled(self, template: str, atom: GroundAtom, kind: str, agent: str) -> str:
        words = self._fields(self._parameters(atom[0], kind) or (), atom[1:], agent)
        return _begun(_FIELD.sub(lambda match: words.get(match[1], match[0]), template))

    def _fields(self, parameters: Iterable[str], arguments: Iterable[str], agent: str) -> dict[str, str]:
        named = [self._name(argument) for argument in arguments]
        by_name = {
            parameter.removeprefix("?"): name for parameter, name in zip(parameters, named, strict=False)
        }
        by_number = {str(number): name for number, name in enumerate(named, start=1)}
        return {**by_number, **by_name, "agent": self._name(agent)}

    def _parameters(self, name: str, kind: str) -> tuple[str, ...] | None:
        declared = self.domain.actions if kind == "sentences" else self.domain.predicates
        found = next((d for d in declared if d.name == name), None)
        return None if found is None else tuple(parameter.name for parameter in found.parameters)

    def _name(self, name: str) -> str:
        return self.names.get(name, name)


def changed(
    before: frozenset[GroundAtom], after: frozenset[GroundAtom]
) -> tuple[list[GroundAtom], list[GroundAtom]]:
    """List the facts that have become true, and those that have become false.

    Examples
    --------
    >>> changed(frozenset({("a",)}), frozenset({("b",)}))
    ([('b',)], [('a',)])
    """
    return sorted(after - before), sorted(before - after)


def _begun(sentence: str) -> str:
    return sentence[:1].upper() + sentence[1:]
