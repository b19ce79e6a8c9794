"""What is left is the least of what the machine and any control group have."""

import sys

import pytest

from explicable.model.memory import available_memory_bytes, resident_memory_bytes

GROUP = "system.slice/robot.service"


def write(root, **files):
    for name, text in files.items():
        path = root / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_an_unknown_machine_has_no_limit(tmp_path):
    assert available_memory_bytes(tmp_path) == sys.maxsize


@pytest.mark.parametrize(
    ("line", "mount", "names", "no_limit"),
    [
        ("0::", "sys/fs/cgroup", ("memory.max", "memory.current", "inactive_file"), "max"),
        (
            "4:cpu,memory:",
            "sys/fs/cgroup/memory",
            ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
            "9223372036854771712",
        ),
    ],
)
def test_the_tightest_control_group_counts(tmp_path, line, mount, names, no_limit):
    limit, usage, cache = names
    write(
        tmp_path,
        proc__meminfo="MemTotal: 9000 kB\nMemAvailable:    8000 kB\n",
        proc__self__cgroup=f"7:pids:/other\n{line}/{GROUP}\n",
    )
    assert available_memory_bytes(tmp_path) == 8000 * 1024
    group = tmp_path / mount / GROUP
    write(group, **{limit: f"{no_limit}\n", usage: "5000\n"})
    assert available_memory_bytes(tmp_path) == 8000 * 1024
    write(group.parent, **{limit: "7000000\n", usage: "3000000\n"})
    assert available_memory_bytes(tmp_path) == 4_000_000
    write(group.parent, **{"memory.stat": f"anon 5\n{cache} 500000\n"})
    assert available_memory_bytes(tmp_path) == 4_500_000
    write(group, **{limit: "4000\n"})  # more is used than allowed
    assert available_memory_bytes(tmp_path) == 1


def test_this_process_holds_something():
    assert 0 < resident_memory_bytes() < 1 << 40
