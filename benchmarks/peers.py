"""The programs that run side by side: their commands, where they leave their plans, and what else they say.

The peers live in an environment of their own (`peers.txt`); nothing of theirs is ever imported by explicable.
"""

import json
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from measure import Cost

HERE = Path(__file__).resolve().parent
OURS = "explicable"
WARM = "explicable, warm"
FD_LAZY = "FD lazy"
FD_LAMA = "FD LAMA-first"
FD_EAGER = "FD eager"
FD_TRANSLATE = "FD translate"
CRFSUITE = "crfsuite"
PLAIN = "plain"
LABELLED = "labelled"
RATE_S = 3  # seconds that eager search may take

_FF = "let(hff, eval_modify_costs(ff(), cost_type=one), "
_SEARCHES = {
    FD_LAZY: f"{_FF}lazy_greedy([hff], preferred=[hff], cost_type=one))",
    # The search of the driver's alias `lama-first`.
    FD_LAMA: "let(hlm, eval_modify_costs(landmark_sum("
    "lm_factory=lm_reasonable_orders_hps(lm_rhw()), pref=false), cost_type=one), "
    f"{_FF}"
    "lazy_greedy([hff, hlm], preferred=[hff, hlm], cost_type=one, reopen_closed=false)))",
    FD_EAGER: f"{_FF}eager_greedy([hff], cost_type=one, max_time={RATE_S}))",
}


def report(costs: dict[str, Cost]) -> dict:
    """Read the JSON object that a probe printed last; it replaces what was measured from outside."""
    last = costs[next(reversed(costs))]
    return json.loads(last.stdout.splitlines()[-1]) if last.exit_code == 0 else {}


def downward_statistics(costs: dict[str, Cost]) -> dict:
    """Fast Downward's evaluations, and its CPU time from the end of reading on."""
    log = costs["search"].stdout
    start = re.search(r"^\[t=([\d.]+)s.*done reading input", log, re.MULTILINE)
    end = re.search(r"^\[t=([\d.]+)s.*Evaluated (\d+) state", log, re.MULTILINE)
    if not start or not end:
        return {}
    return {"search_s": float(end[1]) - float(start[1]), "evaluations": int(end[2])}


@dataclass(frozen=True, slots=True)
class Stage:
    """One process of a program, started in a directory that holds `domain.pddl` and `problem.pddl`."""

    name: str
    command: tuple[str, ...]
    stdin: str | None = None


@dataclass(frozen=True, slots=True)
class Program:
    """A planner or grounder: stages that run one after the other.

    `plan` names the file that then holds a plan, None if none is asked for; `read` takes further figures from
    what the stages printed. A slow one may be granted fewer runs, and fewer CPU seconds, than the rest.
    """

    name: str
    stages: tuple[Stage, ...]
    plan: str | None = "plan"
    read: Callable[[dict[str, Cost]], dict] | None = None
    most_runs: int | None = None
    most_cpu_s: float | None = None


@dataclass(frozen=True, slots=True)
class Peers:
    """All programs; the peers' in the virtual environment `home`."""

    home: Path

    @property
    def python(self) -> str:
        """The interpreter of the peers' environment."""
        return str(self.home / "bin" / "python")

    def planners(self) -> list[Program]:
        """Ours twice, in a fresh process and in a warm one, then the peers, whole processes all."""
        script = Path(sys.executable).with_name("explicable")
        fresh = Stage("plan", (str(script), "plan", "domain.pddl", "problem.pddl", "--output", "plan"))
        return [
            Program(OURS, (fresh,)),
            Program(WARM, (_probe(sys.executable, "plan"),), read=report),
            self._fast_downward(FD_LAZY),
            self._fast_downward(FD_LAMA),
            self._lapkt("DUAL-BFWS"),
            replace(self._lapkt("BFWS-f5"), most_runs=1),
            Program("mimir", (_probe(self.python, "plan_mimir"),), most_runs=1, most_cpu_s=10),
            replace(self._pyperplan(), most_runs=1, most_cpu_s=5),
        ]

    def rates(self) -> list[Program]:
        """Eager greedy best-first search with the FF heuristic and unit costs, for `RATE_S` seconds."""
        ours = Program(OURS, (_probe(sys.executable, "rate", str(RATE_S)),), plan=None, read=report)
        return [ours, self._fast_downward(FD_EAGER, plan=None, read=downward_statistics)]

    def labelled(self) -> list[Program]:
        """Search without and with a labeller."""
        probes = (_probe(sys.executable, "labelled", answer) for answer in ("no", "yes"))
        return [
            Program(n, (p,), plan=None, read=report) for n, p in zip((PLAIN, LABELLED), probes, strict=True)
        ]

    def grounders(self) -> list[Program]:
        """Readers and grounders, warm."""
        pythons = {
            "ground": sys.executable,
            "ground_fd": self.python,
            "ground_mimir": self.python,
            "ground_tarski": self.python,
        }
        names = (OURS, FD_TRANSLATE, "mimir", "tarski")
        probes = [_probe(python, probe) for probe, python in pythons.items()]
        return [Program(n, (p,), plan=None, read=report) for n, p in zip(names, probes, strict=True)]

    def trainers(self) -> list[Program]:
        """Conditional random fields trained on permutation-augmented traces."""
        call = (sys.executable, str(HERE / "crf_training.py"), "--program")
        return [
            Program(name, (Stage("train", (*call, name)),), plan=None, read=report, most_runs=runs)
            for name, runs in ((OURS, None), (CRFSUITE, 1))
        ]

    def _fast_downward(self, name: str, plan: str | None = "plan", read: Callable | None = None) -> Program:
        module = (self.python, "-m", "fast_downward.translate")
        translate = Stage("translate", (*module, "domain.pddl", "problem.pddl", "--sas-file", "task.sas"))
        packaged = "lib/python*/site-packages/up_fast_downward/downward/builds/release/bin/downward"
        binary = str(next(self.home.glob(packaged), "downward"))
        call = (binary, "--internal-plan-file", "plan", "--search", _SEARCHES[name])
        return Program(name, (translate, Stage("search", call, stdin="task.sas")), plan, read)

    def _lapkt(self, name: str) -> Program:
        call = (
            self.python,
            str(self.home / "bin" / "lapkt_cmd.py"),
            "BFWS",
            "-d",
            "domain.pddl",
            "-p",
            "problem.pddl",
        )
        options = ("--search_type", name, "--grounder", "Tarski", "--plan_file", "plan")
        return Program(name, (Stage("plan", call + options),))

    def _pyperplan(self) -> Program:
        call = (self.python, str(self.home / "bin" / "pyperplan"), "-H", "hff", "-s", "gbf")
        return Program(
            "pyperplan", (Stage("plan", (*call, "domain.pddl", "problem.pddl")),), "problem.pddl.soln"
        )


def _probe(python: str, name: str, *arguments: str) -> Stage:
    return Stage(name, (python, str(HERE / "probes.py"), name, "domain.pddl", "problem.pddl", *arguments))
