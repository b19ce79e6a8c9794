"""Draw the execution monitor's table into docs/execution.md: `python tools/draw_monitor.py`."""

import re
from pathlib import Path

from explicable.execution import draw_monitor
from explicable.model.files import write_whole

PAGE = Path(__file__).parents[1] / "docs" / "execution.md"
DIAGRAM = re.compile(r"```mermaid\nstateDiagram-v2\n.*?```\n", re.DOTALL)

if __name__ == "__main__":
    page, num_drawn = DIAGRAM.subn(f"```mermaid\n{draw_monitor()}```\n", PAGE.read_text())
    if num_drawn != 1:
        raise SystemExit(f"{PAGE} has {num_drawn} diagrams of the monitor, not one")
    write_whole(PAGE, page)
