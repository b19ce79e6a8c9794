"""Where a session stands: its course, its tasks, and the task under way."""

from dataclasses import dataclass

from explicable.study.game import Moment
from explicable.study.materials import Material
from explicable.study.protocol import Stage


@dataclass(frozen=True, slots=True)
class Session:
    """A session as the database has it, as far as its course goes."""

    id: str
    participant: str
    origin: str
    condition: str
    stage: str
    position: int
    attempts: int
    revision: int
    code: str
    seen: float


@dataclass(frozen=True, slots=True)
class Assignment:
    """One of a session's tasks, as the database has it."""

    id: int
    task: str
    status: str
    announced: str | None
    started: float | None


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a session stands: its tasks, the practice first, and material and moment of one under way."""

    session: Session
    assignments: tuple[Assignment, ...]
    material: Material | None = None
    moment: Moment | None = None

    @property
    def num_tasks(self) -> int:
        """The number of tasks, without the practice."""
        return len(self.assignments) - 1

    @property
    def stage(self) -> Stage:
        """The stage."""
        return Stage(self.session.stage)

    @property
    def is_teaming(self) -> bool:
        """Whether the robot may have to plan to go on."""
        return self.material is not None and self.material.condition.mode == "teaming"

    @property
    def offer(self) -> Moment | None:
        """How the task will stand when the robot's next step is shown, if that is asked about.

        A page shows it by itself when it is due, unless a command comes first, and says so with what the
        person does next (``shown``): only then is it written down. A robot that plans may think again, so
        its steps are asked for.
        """
        if self.material is None or self.moment is None or self.is_teaming:
            return None
        return self.material.game.offer(self.moment)
