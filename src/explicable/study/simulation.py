"""Simulated participants who take part in a study over HTTP, as people's browsers do.

They are test instruments: their link is signed by the study itself, and every row that comes of them says
``simulated``.
"""

import asyncio
import html
import json
import math
import re
import secrets
import sys
import time
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypedDict, Unpack
from urllib.parse import urljoin

import numpy as np

from explicable.errors import InputError
from explicable.execution import Family
from explicable.study.client import Answer, Client
from explicable.study.materials import Materials
from explicable.study.onlooker import Onlooker, shown
from explicable.study.security import Keys

_VIEW = re.compile(r' data-view="([^"]*)"')
_HIDDEN = re.compile(r'<input type="hidden" name="(\w+)" value="([^"]*)"')
_MAX_TRIES = 2400
_RETRY_S = 0.25
_FIRST_ANSWER_S = 30


class _Options(TypedDict, total=False):
    params: dict[str, str]
    data: dict[str, str]
    json: dict[str, Any]
    headers: dict[str, str]


@dataclass
class Tally:
    """What came of simulated participants.

    Attributes
    ----------
    num_finished, num_refused
        How many got to the end, and how many found no place.
    num_resent
        Requests that were sent again because nobody answered, or the server could not then.
    labels
        Every label that the server acknowledged: session, task's position, steps taken, label.
    answer_s, answered
        Seconds that each acknowledged label took, and when it came, by the clock `time.perf_counter`.
    """

    num_finished: int = 0
    num_refused: int = 0
    num_resent: int = 0
    labels: list[tuple[str, int, int, bool]] = field(default_factory=list)
    answer_s: list[float] = field(default_factory=list)
    answered: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Simulation:
    """How simulated participants take part.

    Parameters
    ----------
    link
        The study's address.
    materials
        The study: they have to know the maps that they see.
    keys
        The study's own, which sign their links.
    family
        From which they are drawn.
    seed
        Of all their chance.
    pace_s
        Seconds between the labels of each: half before the robot's step, half before the answer.
    arrival_s
        Seconds over which they come.
    until
        When they stop wherever they are, by the clock `time.perf_counter`.
    """

    link: str
    materials: Materials
    keys: Keys
    family: Family
    seed: int = 0
    pace_s: float = 0.0
    arrival_s: float = 0.0
    until: float = math.inf

    def is_over(self) -> bool:
        """Tell whether it is time to stop."""
        return time.perf_counter() >= self.until

    def run(self, num: int, *, at_once: int = 8, tell: Callable[[Tally], None] = lambda _: None) -> Tally:
        """Let a number of participants take part, some of them at once.

        Raises
        ------
        InputError
            If there is no study at the link, or it answers as none should.
        """
        with asyncio.Runner(loop_factory=_loop_factory()) as runner:
            return runner.run(self._run(num, at_once, tell))

    async def _run(self, num: int, at_once: int, tell: Callable[[Tally], None]) -> Tally:
        tally, turn = Tally(), asyncio.Semaphore(at_once)

        async def take_part(number: int) -> None:
            await asyncio.sleep(self.arrival_s * number / num)
            async with turn:
                await _Visit(self, number, tally).take_part()
                tell(tally)

        async with asyncio.TaskGroup() as group:
            for number in range(1, num + 1):
                group.create_task(take_part(number))
        return tally


def _loop_factory() -> "Callable[[], asyncio.AbstractEventLoop] | None":
    """Return what makes the loop that the server has as well, where there is one."""
    if sys.platform == "win32":
        return None
    import uvloop

    return uvloop.new_event_loop


class _Visit:
    """One simulated participant's visit."""

    def __init__(self, simulation: Simulation, number: int, tally: Tally) -> None:
        self.simulation, self.tally = simulation, tally
        self.rng = np.random.default_rng((simulation.seed, number))
        self.participant = simulation.family.draw(number, self.rng)
        self.client = Client(simulation.link)
        self.token = ""

    async def take_part(self) -> None:
        try:
            page = await self.consent()
            while not self.simulation.is_over() and (fields := _fields(page)):
                page = await self.go_on(page, fields) or await self.fetch("GET", "/session")
        finally:
            self.client.close()
        if 'class="code"' in page:
            self.tally.num_finished += 1
        elif not _fields(page):
            self.tally.num_refused += 1

    async def consent(self) -> str:
        """Come by a signed link and consent; return the first page."""
        name = self.simulation.keys.sign("simulated", self.participant.name)
        page = await self.fetch("GET", "/", params={"simulated": name})
        form = dict(re.findall(r'<input type="hidden" name="(ticket)" value="([^"]*)"', page))
        return await self.fetch("POST", "/consent", data={**form, "decision": "yes"}, accepts=(200, 409))

    async def go_on(self, page: str, fields: dict[str, str]) -> str:
        """Do what a page asks for; return the next page, or nothing where it has to be fetched."""
        study, stage = self.simulation.materials.study, fields["stage"]
        self.token = fields["token"]
        answers: dict[str, str] = {}
        if stage in {"practice", "tasks"}:
            await self.task(_view(page))
            return ""
        if stage == "comprehension":
            answers = {f"question-{n}": question.answer for n, question in enumerate(study.question, 1)}
        elif stage == "ratings":
            answers = {f"rating-{r.name}": str(self.rng.integers(1, 11)) for r in study.rating}
            answers.update({f"check-{n}": check.answer for n, check in enumerate(study.check, 1)})
        return await self.fetch("POST", "/session", data={**fields, **answers})

    async def task(self, view: dict[str, Any]) -> None:
        """Play or watch one task to its end."""
        place = view["stage"], view["position"]
        material = self.simulation.materials.material(view["task"], view["condition"])
        onlooker = Onlooker(material, self.participant, self.rng)
        while (view["stage"], view["position"]) == place and not self.simulation.is_over():
            path, body = onlooker.decide(view)
            if self.simulation.pace_s and path != "/api/command":
                await asyncio.sleep(self.simulation.pace_s / 2 * float(self.rng.uniform(0.5, 1.5)))
            if path == "/api/step" and view["next"] is not None:
                view = shown(view)  # nothing has come before it
                continue
            began = time.perf_counter()
            view = await self.send(path, body)
            if path == "/api/answer":
                self.tally.answer_s.append(time.perf_counter() - began)
                self.tally.answered.append(time.perf_counter())
                session = self.client.cookies.get("study") or ""
                self.tally.labels.append((session, place[1], body["number"], body["explicable"]))

    async def send(self, path: str, body: dict[str, Any]) -> dict[str, Any]:
        body = {"request_id": secrets.token_hex(16), "client_time": time.time(), **body}
        response = await self.request("POST", path, json=body, headers={"X-Token": self.token})
        return response.json()

    async def fetch(
        self, method: str, path: str, accepts: tuple[int, ...] = (200,), **options: Unpack[_Options]
    ) -> str:
        response = await self.request(method, path, accepts, **options)
        return response.text

    async def request(
        self, method: str, path: str, accepts: tuple[int, ...] = (200,), **options: Unpack[_Options]
    ) -> Answer:
        """Send a request, again and again as it is while nobody answers."""
        problem = "no answer"
        for attempt in range(_MAX_TRIES):
            self.tally.num_resent += attempt > 0
            try:
                response = await self.client.request(method, path, **options)
            except OSError as error:
                problem = str(error) or type(error).__name__
            else:
                if response.status in accepts:
                    return response
                problem = f"{response.status}: {response.text[:200]}"
                if response.status < 500 and response.status != 429:
                    break
            await asyncio.sleep(_RETRY_S)
        raise InputError(f"{method} {path}: {problem}", path=self.simulation.link)


def check_served(link: str, study_hash: str) -> None:
    """Check that a study is served at a link, before participants go there.

    Raises
    ------
    InputError
        If nobody answers, or another study is served there.
    """
    try:
        with urllib.request.urlopen(urljoin(link, "/health"), timeout=_FIRST_ANSWER_S) as answer:  # noqa: S310 (by whoever runs it)
            told = json.load(answer)
    except (OSError, ValueError) as error:
        reason = getattr(error, "reason", error)
        raise InputError(f"no study answers there: {reason}", path=link) from error
    if not isinstance(told, dict) or told.get("study") != study_hash:
        raise InputError("another study is served there, or its files have changed since", path=link)


def _view(page: str) -> dict[str, Any]:
    """Return the view that a task's page brings along."""
    (found,) = _VIEW.findall(page)
    return dict(json.loads(html.unescape(found)))


def _fields(page: str) -> dict[str, str]:
    """Return the hidden fields of a session's page; none where it has ended."""
    fields = {name: html.unescape(value) for name, value in _HIDDEN.findall(page)}
    return fields if "token" in fields else {}
