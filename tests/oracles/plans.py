"""All plans of a small task, by trying everything."""


def all_plans(task, max_steps, is_wanted=lambda _: True):
    """Every plan, as operators, of up to so many steps that ends where it first reaches the goal.

    `is_wanted` tells of an action whether it may be in the plan.
    """
    pending = [((), task.initial_state)]
    while pending:
        plan, state = pending.pop()
        if task.is_goal(state):
            yield plan
        elif len(plan) < max_steps:
            applicable = (o for o in task.applicable(state) if is_wanted(task.action(o)))
            pending.extend(((*plan, o), task.successor(state, o)) for o in applicable)
