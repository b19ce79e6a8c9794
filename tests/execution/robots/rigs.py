"""What the adapters' tests share: a corridor, and steps that a far end answers as it is told."""

from explicable.execution.robots import Blocked, Fact, Failed, Finished
from explicable.first_response import World, encode
from explicable.model.grounding import ground

WORLD = World(("@...*", "xxxxx"))
FINISHES = (("move", "r1", "c-0-0", "c-0-1"), ("move", "r1", "c-0-1", "c-0-2"))
FAILS = ("move", "r1", "c-0-2", "c-0-1")
BLOCKS = ("move", "r1", "c-0-3", "c-0-4")
HANGS = ("move", "r1", "c-0-1", "c-0-0")
STEPS = {"finishes": FINISHES, "fails": FAILS, "blocks": BLOCKS, "hangs": HANGS}


def corridor():
    return ground(encode(WORLD).composite)


def scripted_report(order):
    """What a far end says of an order; None: it is about it until cancelled."""
    if order.action in FINISHES:
        return Finished(order.number, (Fact(("at", "r1", order.action[3])),))
    if order.action == FAILS:
        return Failed(order.number, "wheel stuck")
    if order.action == BLOCKS:
        return Blocked(order.number, (Fact(("clear", "c-0-4"), true=False),))
    return None
