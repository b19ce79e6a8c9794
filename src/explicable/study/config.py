"""A study as its researcher writes it down: ``study.toml`` (docs/study.md)."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from explicable.first_response.encoding import Semantics
from explicable.planning.team_plan import DEFAULT_ALPHA
from explicable.study.game import Ask
from explicable.study.recruitment import unknown_field

FILE = "study.toml"

Text = Annotated[str, Field(min_length=1, max_length=20_000)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$")]
Inside = Annotated[str, Field(pattern=r"^[1-9] in [1-9]$")]
Seconds = Annotated[float, Field(ge=0, le=60)]


class _Table(BaseModel):
    """A table of the file: unknown keys are errors, values are not bent to fit."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Play(_Table):
    """How maps are played.

    Parameters
    ----------
    semantics
        See the method page, section 5.
    mode
        ``commanded`` and ``autonomous`` as there; ``teaming``: the robot follows joint plans that a labeller
        finds explicable, and plans anew when the person deviates.
    labeller, alpha, planning_s
        For ``teaming``: the labeller's file, the price of an inexplicable step, seconds for a plan.
    ask
        Whether people are asked about a robot's step after or before it is taken.
    step_s, idle_step_s
        Seconds that the robot waits before each step, with and without a command.
    """

    semantics: Semantics = "exclusive"
    mode: Literal["commanded", "autonomous", "teaming"] = "commanded"
    labeller: Text | None = None
    alpha: Annotated[float, Field(ge=0, le=1e6)] = DEFAULT_ALPHA
    planning_s: Annotated[float, Field(gt=0, le=10)] = 0.3
    ask: Ask = "after"
    step_s: Seconds = 1.0
    idle_step_s: Seconds = 1.0

    @model_validator(mode="after")
    def _has_labeller(self) -> Self:
        if self.mode == "teaming" and self.labeller is None:
            raise ValueError("live teaming needs a labeller: labeller = FILE (see `explicable train`)")
        return self

    @property
    def waits(self) -> bool:
        """Whether the robot never moves without a command: under ``exclusive`` it can't, in any mode."""
        return self.mode == "commanded" or self.semantics == "exclusive"


class Condition(Play):
    """An experimental condition: a name, and what differs from the table ``play``."""

    name: Name = "all"


class Task(_Table):
    """What is put before people: a map to play, or a plan to watch and label.

    Parameters
    ----------
    name
        Goes into the data; people never see it.
    map, domain, problem, human_domain, human_problem
        The map, or the team problem as PDDL; files, relative to the study's folder.
    plan
        Plan file to replay; without it the map is played.
    source
        What made the plan, such as ``ff``; goes into the data, people never see it.
    picture
        Renderer: ``first-response`` (maps), ``places`` (boxes for what is where), ``none`` (words alone). A
        task with a map is a map's picture by default, another is words.
    people
        How many people should finish this task in each condition (played) or altogether (replayed).
    """

    name: Name
    map: Text | None = None
    domain: Text | None = None
    problem: Text | None = None
    human_domain: Text | None = None
    human_problem: Text | None = None
    plan: Text | None = None
    source: Text = "study"
    picture: Literal["first-response", "places", "none"] | None = None
    people: Annotated[int, Field(ge=1, le=100_000)] = 5

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if self.picture == "first-response" and self.map is None:
            raise ValueError("a picture of a first-response map needs the map: map = FILE")
        is_pictured = self.picture == "first-response" and self.domain is not None
        if (self.map is None) == (self.domain is None) and not is_pictured:
            raise ValueError("a task has either a map, or a domain and a problem")
        if self.domain is not None and (self.problem is None or self.plan is None):
            raise ValueError("a task with a domain needs a problem and a plan")
        return self

    @property
    def kind(self) -> Literal["play", "replay"]:
        """Whether a map is played, or a plan is replayed."""
        return "play" if self.plan is None else "replay"

    @property
    def renderer(self) -> Literal["first-response", "places", "none"]:
        """What draws it: a map need not name it."""
        return self.picture or ("none" if self.map is None else "first-response")

    @property
    def files(self) -> list[str]:
        """The files that it names."""
        names = (self.map, self.domain, self.problem, self.human_domain, self.human_problem, self.plan)
        return [name for name in names if name is not None]


class Practice(Task):
    """What people practise on: a map to play, or a plan to watch; it has no name of its own."""

    name: Name = "practice"


class Question(_Table):
    """A comprehension question, or an attention check that says openly what to choose."""

    text: Text
    choices: Annotated[list[Text], Field(min_length=2, max_length=10)]
    answer: Text

    @model_validator(mode="after")
    def _has_answer(self) -> Self:
        if self.answer not in self.choices:
            raise ValueError("the answer is not among the choices")
        return self


class Rating(_Table):
    """A statement to rate from 1 to 10 at the end."""

    name: Name
    text: Text
    low: Annotated[str, Field(max_length=200)] = ""
    high: Annotated[str, Field(max_length=200)] = ""


class Texts(_Table):
    """Markdown files, relative to the study's folder; what is left out has the package's own text."""

    consent: Text | None = None
    instructions: Text | None = None
    debrief: Text | None = None


class Recruitment(_Table):
    """Where people come from, and where they are sent back to.

    ``return_url`` may hold ``{code}``, the session's completion code, and the platform's parameters.
    """

    platform: Literal["plain", "prolific", "mturk", "sona"] = "plain"
    return_url: Annotated[str, Field(pattern=r"^https?://[^\s<>\"']+$", max_length=500)] | None = None
    allow_repeats: bool = False

    @model_validator(mode="after")
    def _can_return(self) -> Self:
        name = unknown_field(self.return_url or "", self.platform)
        if name is not None:
            raise ValueError(f"return_url: {self.platform} tells no {{{name}}}")
        return self


class Study(_Table):
    """A whole study.

    Parameters
    ----------
    title, language, contact
        What people see first.
    seed
        Of all chance: who gets which tasks, in which order.
    tasks_each
        Tasks of one person.
    max_attempts
        How often the comprehension questions may be tried.
    time_limit_min
        Minutes without a sign of life after which a session gives its place back.
    practice
        What people practise on; a text names a map.
    question, check
        Comprehension questions; attention checks, which stand among the ratings.
    sentences, facts
        Templates by action schema and by predicate, see `explicable.study.sentences`.
    places
        For the renderer of that name: by predicate which argument is in which other.
    """

    title: Text
    language: Literal["en", "de"] = "en"
    contact: Annotated[str, Field(max_length=500)] = ""
    seed: Annotated[int, Field(ge=0)] = 0
    tasks_each: Annotated[int, Field(ge=1, le=100)] = 4
    max_attempts: Annotated[int, Field(ge=1, le=20)] = 3
    time_limit_min: Annotated[float, Field(gt=0)] = 60.0
    practice: Practice
    play: Play = Play()
    texts: Texts = Texts()
    recruitment: Recruitment = Recruitment()
    condition: Annotated[list[Condition], Field(max_length=100)] = []
    question: Annotated[list[Question], Field(max_length=50)] = []
    check: Annotated[list[Question], Field(max_length=20)] = []
    rating: Annotated[list[Rating], Field(max_length=50)] = []
    sentences: dict[str, Text] = {}
    facts: dict[str, Text] = {}
    places: dict[str, Inside] = {"at": "1 in 2", "in": "1 in 2", "on": "1 in 2"}
    task: Annotated[list[Task], Field(min_length=1, max_length=10_000)]

    @field_validator("practice", mode="before")
    @classmethod
    def _takes_a_map(cls, value: object) -> object:
        return {"map": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        for what, names in (
            ("task", [self.practice.name, *(task.name for task in self.task)]),
            ("condition", [condition.name for condition in self.condition]),
            ("rating", [rating.name for rating in self.rating]),
        ):
            twice = next((name for name in names if names.count(name) > 1), None)
            if twice:
                raise ValueError(f"two {what}s are called {twice!r}")
        for rating in self.rating:
            if rating.name == "comment" or rating.name.startswith("check-"):
                raise ValueError(f"no rating can be called {rating.name!r}: other answers are")
        return self

    @property
    def conditions(self) -> list[Condition]:
        """The conditions; a study that names none has one."""
        return self.condition or [Condition(**self.play.model_dump())]

    @property
    def warnings(self) -> list[str]:
        """What is allowed, but hardly meant."""
        return [
            f"condition {condition.name!r}: in exclusive play the robot never moves without a command, so"
            ' that autonomous play is as commanded play; semantics = "persistent" lets it lead'
            for condition in self.conditions
            if condition.mode == "autonomous" and condition.waits
        ]
