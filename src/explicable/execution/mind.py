"""What a simulated participant believes, and how it judges, learns and chooses by that.

A `Mind` is a value; every function here returns a new one. Chance comes from the generator handed in.
"""

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from explicable.execution.outlook import Outlook
from explicable.execution.participants import Participant
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State

if TYPE_CHECKING:
    import numpy as np

Belief = tuple[GroundAtom, bool]
"""A fact, and whether it is taken to be true."""


class Mind(NamedTuple):
    """A participant's view of a game under way.

    Parameters
    ----------
    state
        The state that the participant takes the game to be in.
    requests
        What it has asked for and not got, the latest last.
    tried
        The human steps by which it has asked since a request was last fulfilled; it does not go back to them.
    inferred
        Facts, with their truth values, that it has worked out from what the robot avoided, and may forget.
    """

    state: State
    requests: tuple[Request, ...] = ()
    tried: frozenset[GroundAtom] = frozenset()
    inferred: tuple[Belief, ...] = ()

    @property
    def request(self) -> Request | None:
        """The last thing asked for and not got: what the robot is taken to be after."""
        return self.requests[-1] if self.requests else None


def regret(outlook: Outlook, participant: Participant, mind: Mind, action: GroundAtom) -> float:
    """Return what a robot step costs more than the best way that the participant believes in.

    ``cost(step) + V(state after) - V(state)``, V being the cost-to-go to the participant's horizon. Infinite
    for a step believed impossible; 0 where the participant sees no way at all.
    """
    step = outlook.step(mind.state, action)
    if step is None:
        return math.inf
    before = _cost_to_go(outlook, participant, mind, mind.state)
    if before == math.inf:
        return 0.0
    (operator, after), request = step, mind.request
    cost = outlook.task.cost(operator)
    if participant.horizon == "request" and request is not None and action in request.fulfilled_by:
        return cost - before
    return cost + _cost_to_go(outlook, participant, mind, after) - before


def _cost_to_go(outlook: Outlook, participant: Participant, mind: Mind, state: State) -> float:
    """Return the cost-to-go from a state by which the participant now judges."""
    request = mind.request
    if participant.horizon == "mission":
        return outlook.mission_cost(state)
    if request is not None:
        return outlook.fulfilment_cost(state, request)
    if not outlook.ranked_asks(mind.state):
        return outlook.mission_cost(state)  # there is nothing to ask for: the robot goes on by itself
    if participant.initiative:
        return min((cost for cost, _ in outlook.ranked_asks(state)), default=0)
    return 0  # something could be asked for and is not: the best the robot can do is wait


def label_step(participant: Participant, step_regret: float, rng: "np.random.Generator") -> bool:
    """Answer whether a robot step was explicable, by its regret.

    Examples
    --------
    >>> import numpy as np
    >>> label_step(Participant("simulated-1", slack=1.0), 2.0, np.random.default_rng(0))
    False
    """
    chance = acceptance(participant, step_regret)
    explicable = bool(rng.random() < chance) if participant.judgement == "boltzmann" else chance == 1.0
    return explicable != (rng.random() < participant.noise)


def acceptance(participant: Participant, step_regret: float) -> float:
    """Return the probability that a participant finds a step of some regret explicable, if it answers aright.

    Examples
    --------
    >>> acceptance(Participant("simulated-1", slack=1.0), 2.0)
    0.0
    >>> acceptance(Participant("simulated-1", judgement="boltzmann"), 0.0)
    1.0
    """
    if participant.judgement == "boltzmann":
        # p(step) / p(best) = exp(-regret / T): the softmax's normaliser cancels.
        return math.exp(-max(step_regret, 0.0) / participant.temperature)
    return float(step_regret <= participant.slack)


def watch(setting: Setting, mind: Mind, action: GroundAtom, before: State, after: State) -> Mind:
    """Return the mind after it saw a step happen, from ``before`` to ``after`` in the truth.

    A step believed impossible shows that the facts it needed hold; one with unexpected effects shows the
    effects.
    """
    belief, state, requests, tried, inferred = setting.belief, *mind
    believed = belief.after(state, action)
    if believed is None:
        state = _concede(setting, state, action, before)
        believed = belief.after(state, action)
    if believed is None or not setting.same_schemas:
        believed = _take_in(setting, state if believed is None else believed, before, after)
    if action in belief.fulfilling:
        left = tuple(request for request in requests if action not in request.fulfilled_by)
        tried = tried if len(left) == len(requests) else frozenset()
        requests = left
    elif action in belief.requests:
        asked = belief.requests[action]
        requests = (*(request for request in requests if request != asked), asked)
        tried |= {action}
    standing = tuple([request for request in requests if belief.stands(believed, request)])
    return Mind(believed, standing, tried, inferred)


def give_up(mind: Mind, request: Request) -> Mind:
    """Return the mind after it was told that a request can't be fulfilled."""
    return mind._replace(requests=tuple(other for other in mind.requests if other != request))


def _concede(setting: Setting, state: State, action: GroundAtom, truth: State) -> State:
    """Take over those differing facts which a step seen to happen must have needed."""
    belief = setting.belief
    for operator in belief.task.operators_of(action):
        for atom, value in belief.stage.needs(operator):
            if setting.truth.task.holds(atom, truth) == value:
                state = belief.stage.believe(state, atom, true=value)
    return state


def _take_in(setting: Setting, state: State, before: State, after: State) -> State:
    """Take over what a step really changed."""
    truth, belief = setting.truth.task, setting.belief.task
    old, new = truth.atoms(before), truth.atoms(after)
    believed = belief.atoms(state)
    # One atom a variable: what is seen drives out what it excludes.
    values = {}
    for atom in (*(believed - (old - new)), *(new - old)):
        fact = belief.fact_number(atom)
        if fact is not None:
            values[belief.core.fact_variable(fact)] = atom
    return belief.state_of(values.values())


def infer(
    setting: Setting, participant: Participant, mind: Mind, truth: State, rng: "np.random.Generator"
) -> Mind:
    """Return the mind after the robot avoided the way believed best, seen from the state before its step.

    The first fact on that way that the truth denies is worked out with the participant's probability to
    learn. A participant never learns what is not so.
    """
    return learn(setting, participant, mind, find_error(setting, participant, mind, truth), rng)


def find_error(setting: Setting, participant: Participant, mind: Mind, truth: State) -> Belief | None:
    """Return what is believed on the way believed best, and is not so; of several such facts, the first."""
    way = _best_way(setting.belief, participant, mind)
    for operator in way or ():
        for atom, value in setting.belief.stage.needs(operator):
            if setting.truth.task.holds(atom, truth) != value:
                return atom, value
    return None


def learn(
    setting: Setting, participant: Participant, mind: Mind, error: Belief | None, rng: "np.random.Generator"
) -> Mind:
    """Return the mind after it had the chance to see an error; see `infer`."""
    return mind if error is None or rng.random() >= participant.learning else correct(setting, mind, error)


def correct(setting: Setting, mind: Mind, error: Belief) -> Mind:
    """Return the mind after it has worked out that a belief is wrong."""
    atom, value = error
    state = setting.belief.stage.believe(mind.state, atom, true=not value)
    return mind._replace(state=state, inferred=(*mind.inferred, (atom, not value)))


def _best_way(outlook: Outlook, participant: Participant, mind: Mind) -> tuple[int, ...] | None:
    if participant.horizon == "request" and mind.request is not None:
        return outlook.fulfilment_way(mind.state, mind.request)
    waits = participant.horizon == "request" and outlook.ranked_asks(mind.state)
    return None if waits else outlook.mission_way(mind.state)


def keep(setting: Setting, mind: Mind, kept: Sequence[bool]) -> Mind:
    """Return the mind of whose inferred facts these are kept, in their order, and the others forgotten."""
    state = mind.state
    for (atom, value), still_known in zip(mind.inferred, kept, strict=True):
        if not still_known:
            state = setting.belief.stage.believe(state, atom, true=not value)
    return mind._replace(state=state, inferred=tuple(itertools.compress(mind.inferred, kept)))


def choose(
    setting: Setting,
    participant: Participant,
    mind: Mind,
    rng: "np.random.Generator",
    refused: frozenset[GroundAtom] = frozenset(),
) -> GroundAtom | None:
    """Return the human step that the participant takes now, or None to let the robot go on.

    With a request under way, a new one is made only if it looks strictly better than to see the old one
    through, and none that has been tried since something was last fulfilled: so a game can't swing to and fro
    for ever. Among equally good ones chance decides. Where there is nothing to ask for, the participant does
    its own part of the best joint way that it sees, as soon as that does no harm.
    """
    belief, current = setting.belief, mind.request
    ranked = []
    for asking_cost, operator in belief.ranked_asks(mind.state):
        action = belief.task.action(operator)
        if action not in mind.tried and action not in refused:
            cost = asking_cost
            if participant.horizon == "mission":
                asked = belief.task.successor(mind.state, operator)
                see_through = _cost_to_see_through(belief, participant, asked, belief.requests[action])
                cost = belief.task.cost(operator) + see_through
            ranked.append((cost, action))
    best = min((cost for cost, _ in ranked), default=math.inf)
    if current is not None and best >= _cost_to_see_through(belief, participant, mind.state, current):
        return None
    if ranked:
        equals = [action for cost, action in ranked if cost == best]
        return equals[int(rng.integers(len(equals)))]
    return None if current is not None else _own_step(setting, mind, refused)


def _cost_to_see_through(belief: Outlook, participant: Participant, state: State, request: Request) -> float:
    """Return what it costs to let a request be fulfilled, and on a mission to finish after that."""
    cost = belief.fulfilment_cost(state, request)
    if participant.horizon == "mission" and cost < math.inf:
        cost += belief.mission_cost(belief.fulfilled(state, request))
    return cost


def _own_step(setting: Setting, mind: Mind, refused: frozenset[GroundAtom]) -> GroundAtom | None:
    """Return a human step of the best joint way, the first that can be taken already at no extra cost.

    What a robot should do before may have to wait for just that, unknown to the participant.
    """
    belief, state = setting.belief, mind.state
    for operator in belief.mission_way(state) or ():
        action = belief.task.action(operator)
        if (
            setting.problem.agent_of(action).kind == "human"
            and action not in refused
            and belief.task.is_applicable(state, operator)
        ):
            saved = belief.mission_cost(state) - belief.mission_cost(belief.task.successor(state, operator))
            if saved == belief.task.cost(operator):
                return action
    return None
