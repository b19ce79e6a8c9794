"""Two robots and two people at once: one robot over HTTP, one behind a real broker, the people simulated."""

import threading
from contextlib import ExitStack

from mosquitto import BrokerProcess
from rigs import PATIENCE_S, until

from explicable.execution import prepare
from explicable.execution.dispatch import Dispatcher
from explicable.execution.dispatch_run import DispatchLimits
from explicable.execution.episodes import Ending
from explicable.execution.robots import Failed, Finished, SimulatedRobot, SimulatedWorld
from explicable.execution.robots.mqtt import Broker, MqttClient, MqttFleet
from explicable.execution.robots.rest import RestServer
from explicable.execution.robots.rest_client import RestClient
from explicable.first_response import World, encode
from explicable.model.grounding import ground
from explicable.model.schedule import make_schedule
from explicable.search import search

TOKEN = "a token of sixteen"  # noqa: S105 (it guards nothing)


class SharedWorld(SimulatedWorld):
    """A world in which robots act from threads of their own."""

    def __init__(self, task):
        super().__init__(task)
        self.lock = threading.Lock()

    def take(self, action):
        with self.lock:
            return super().take(action)

    def carry_out(self, side):
        number = side.order.number
        side.report(Finished(number) if self.take(side.order.action) else Failed(number, "not possible"))


def test_a_schedule_is_carried_out_over_http_and_mqtt_at_once(tmp_path):
    problem = encode(World(("@..*", "####", "*..@")), num_people=2)
    task = ground(problem.composite)
    schedule = make_schedule(problem, task, tuple(map(task.action, search(task).operators)))
    world = SharedWorld(task)
    with ExitStack() as stack:
        process = BrokerProcess(tmp_path)
        stack.callback(process.end)
        broker, stop = Broker(port=process.port), threading.Event()
        server = stack.enter_context(RestServer({"r1": TOKEN}))
        fleet = stack.enter_context(MqttFleet(broker, ["r2"]))
        stack.enter_context(MqttClient(broker, "r2", world.carry_out))
        client = RestClient(server.host, server.port, "r1", TOKEN)

        def drive():
            while not stop.is_set():
                if client.pull(0.2) and client.side.order:
                    world.carry_out(client.side)

        thread = threading.Thread(target=drive)
        thread.start()
        stack.callback(thread.join)
        stack.callback(stop.set)
        crew = [server.robots["r1"], fleet.robots["r2"]]
        crew += [SimulatedRobot(agent.name, world) for agent in problem.agents if agent.kind == "human"]
        until(lambda: all(member.state().connected for member in crew))
        run = Dispatcher(prepare(problem), schedule, crew, limits=DispatchLimits(total_s=PATIENCE_S)).run()
    assert (run.ending, run.num_plans, run.lost) == (Ending.REACHED, 0, frozenset())
    assert sorted(done.step.action for done in run.steps) == sorted(schedule.actions)
    assert task.is_goal(world.state)
