"""What the adapters' tests share: a corridor, and steps that a far end answers as it is told."""

import time

from explicable.execution.robots import Blocked, Fact, Failed, Finished
from explicable.first_response import World, encode
from explicable.model.grounding import ground

WORLD = World(("@...*", "xxxxx"))
FINISHES = (("move", "r1", "c-0-0", "c-0-1"), ("move", "r1", "c-0-1", "c-0-2"))
FAILS = ("move", "r1", "c-0-2", "c-0-1")
BLOCKS = ("move", "r1", "c-0-3", "c-0-4")
HANGS = ("move", "r1", "c-0-1", "c-0-0")
PATIENCE_S = 300.0  # nothing takes that long; it is there so that what hangs ends
STEPS = {"finishes": FINISHES, "fails": FAILS, "blocks": BLOCKS, "hangs": HANGS, "patience_s": PATIENCE_S}


def until(holds):
    """Wait for what other threads and processes are about to bring about."""
    ends_at = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < ends_at, "this should have come about"
        time.sleep(0.01)


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
