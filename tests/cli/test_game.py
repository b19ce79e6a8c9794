import json
import os
import signal
import subprocess
import sys

import pytest

from explicable.execution import read_episode
from explicable.labelling import read_traces

MAP = "#######\n#@.x*.#\n#...*.#\n#######\n"


def explicable(*arguments, answers="", **options):
    command = [sys.executable, "-c", "from explicable.cli import main; main()", *map(str, arguments)]
    return subprocess.run(
        command, input=answers, capture_output=True, text=True, timeout=600, check=False, **options
    )


@pytest.fixture
def map_file(tmp_path):
    path = tmp_path / "small.map"
    path.write_text(MAP)
    return path


def test_a_whole_game_through_a_pipe_is_played_recorded_replayed_and_learnt_from(map_file, tmp_path):
    game, svg, traces = tmp_path / "game.jsonl", tmp_path / "game.svg", tmp_path / "traces.jsonl"
    played = explicable("play", map_file, "-o", game, answers="q\nb\n" + "y\nn\n" * 3 + "a\n" + "y\n" * 10)
    assert played.returncode == 0, played.stderr
    assert "no such room; there are A, B" in played.stdout
    assert "goal reached" in played.stdout
    assert "x" not in played.stdout.split("Which")[0]  # the person sees the floor plan from before
    recorded = read_episode(game)
    assert recorded.trace.origin == "person"
    assert recorded.trace.steps[0].action == ("command", "person", "c-2-4")
    assert [step.label for step in recorded.trace.steps[1:4]] == [True, False, True]
    replayed = explicable("replay", game, "--svg", svg, "--trace", traces)
    assert replayed.returncode == 0, replayed.stderr
    assert "makes no sense" in replayed.stdout
    assert svg.read_text().startswith("<svg")
    assert "<animate" in svg.read_text()
    assert read_traces(traces)[0].steps == recorded.trace.steps
    assert json.loads(explicable("replay", game, "--json").stdout)["same"] is True


@pytest.mark.parametrize("strategy", ["follower", "nearest", "ff"])
def test_a_person_who_leaves_ends_the_game_which_is_still_on_record(map_file, tmp_path, strategy):
    game = tmp_path / "game.jsonl"
    played = explicable(
        "play", map_file, "--strategy", strategy, "--semantics", "exclusive", "-o", game, answers="a\ny\n"
    )
    assert played.returncode == 0, played.stderr
    assert "aborted" in played.stdout
    assert read_episode(game).trace.notes["ending"] == "aborted"


def test_a_new_command_can_take_the_place_of_an_answer(map_file, tmp_path):
    game = tmp_path / "game.jsonl"
    explicable("play", map_file, "--semantics", "exclusive", "-o", game, answers="a\nb\n" + "y\n" * 20)
    steps = [step.action for step in read_episode(game).trace.steps]
    assert [step[-1] for step in steps if step[0] == "command"][:2] == ["c-1-4", "c-2-4"]
    assert read_episode(game).num_changes == 1


def test_a_record_that_does_not_replay_says_so(map_file, tmp_path):
    game = tmp_path / "game.jsonl"
    explicable("play", map_file, "-o", game, answers="a\n")
    game.write_text(game.read_text().replace('"digest": "', '"digest": "0'))
    svg, traces = tmp_path / "game.svg", tmp_path / "traces.jsonl"
    replayed = explicable("replay", game, "--svg", svg, "--trace", traces)
    assert replayed.returncode == 3
    assert "on record" in replayed.stderr
    assert not svg.exists()
    assert not traces.exists()
    game.write_text("{}")
    refused = explicable("replay", game)
    assert (refused.returncode, refused.stdout) == (3, "")


def test_ctrl_c_ends_the_game_which_is_still_on_record(map_file, tmp_path):
    game = tmp_path / "game.jsonl"
    command = [sys.executable, "-c", "from explicable.cli import main; main()", "play", map_file, "-o", game]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    ) as playing:
        shown = b""
        while b"Which room" not in shown:
            part = playing.stdout.read1()
            assert part, shown  # else it ended by itself
            shown += part
        playing.send_signal(signal.SIGINT)
        playing.stdin.close()
        assert playing.wait(600) == 130
    assert read_episode(game).trace.notes["ending"] == "aborted"


def test_a_simulated_participant_can_play_in_ones_place(map_file, tmp_path):
    game = tmp_path / "game.jsonl"
    played = explicable("play", map_file, "--simulated", "myopic", "--seed", 2, "-o", game)
    assert played.returncode == 0, played.stderr
    assert read_episode(game).trace.origin == "simulated"
    assert explicable("replay", game).returncode == 0
    assert explicable("play", map_file, "--simulated", "saints").returncode == 2


def test_an_impossible_alpha_is_refused_before_the_game(map_file):
    played = explicable("play", map_file, "--alpha", "nan")
    assert (played.returncode, played.stdout) == (2, "")
    assert "alpha must be" in played.stderr


def test_a_record_that_breaks_off_or_is_all_wrong_is_told_of_briefly(map_file, tmp_path):
    game, short, wrong = tmp_path / "game.jsonl", tmp_path / "short.jsonl", tmp_path / "wrong.jsonl"
    assert explicable("play", map_file, "-o", game, "--simulated", "myopic").returncode == 0
    lines = game.read_text().splitlines(keepends=True)
    short.write_text("".join(lines[:-1]))
    replayed = explicable("replay", short)
    assert replayed.returncode == 3
    assert "breaks off" in replayed.stderr
    wrong.write_text("".join([*lines, *20 * lines[1:2]]))
    replayed = explicable("replay", wrong)
    assert replayed.returncode == 3
    assert len(replayed.stderr.splitlines()) == 11
