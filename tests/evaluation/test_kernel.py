"""Experiments become trials, trials records: the same whoever does them, and whatever comes between."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from small_studies import PLANS, write_study

from explicable.cli import EXIT_BAD_INPUT, EXIT_TRIALS_FAILED, EXIT_USAGE
from explicable.cli import run as command_line
from explicable.errors import InputError, UsageError
from explicable.evaluation.experiments import builtin_experiments, parse_experiment, read_experiment
from explicable.evaluation.records import RecordFile, Trial, make_record, without_measurements
from explicable.evaluation.runner import run_experiments


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return write_study(tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def finished(study, tmp_path_factory):
    """The records of an undisturbed run in one process."""
    folder = tmp_path_factory.mktemp("one-process")
    return run_experiments([read_experiment(study)], folder)["small"], folder


def same(records, others):
    return json.dumps(without_measurements(records)) == json.dumps(without_measurements(others))


def test_two_processes_write_the_same_records(study, finished, tmp_path):
    records = run_experiments([read_experiment(study)], tmp_path, jobs=2)["small"]
    assert len(records) == 4
    assert all(record["outcome"] == "done" for record in records)
    assert same(records, finished[0])
    lines = [(folder / "records" / "small.jsonl").read_text() for folder in (tmp_path, finished[1])]
    assert all(line.count("\n") == 4 for line in lines)


def test_an_interrupted_run_goes_on(study, finished, tmp_path):
    _, done = finished
    lines = (done / "records" / "small.jsonl").read_bytes().splitlines(keepends=True)
    part = tmp_path / "records" / "small.jsonl"
    part.parent.mkdir()
    failed = json.dumps(json.loads(lines[1]) | {"outcome": "failed"}).encode() + b"\n"
    part.write_bytes(lines[2] + failed + lines[0][: len(lines[0]) // 2])
    told = []
    records = run_experiments(
        [read_experiment(study)], tmp_path, tell=lambda name, done, all_: told.append((name, done, all_))
    )["small"]
    assert told == [("small", done, 4) for done in (1, 2, 3, 4)]
    assert same(records, finished[0])
    assert part.read_bytes().splitlines()[2] == lines[2].strip()  # to the last digit: it was not run again
    (stretch,) = json.loads((tmp_path / "run.json").read_text())["stretches"]
    assert (stretch["workers"], stretch["trials"]) == ("--jobs 1", 3)


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_ended_from_outside_a_run_goes_on(study, finished, tmp_path, ending):
    command = [sys.executable, "-m", "explicable", "evaluate", "--study", study, "-o", tmp_path]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    records = tmp_path / "records" / "small.jsonl"
    while process.poll() is None and not records.exists():
        time.sleep(0.01)
    assert records.exists()
    process.send_signal(ending)
    process.wait()
    again = run_experiments([read_experiment(study)], tmp_path)["small"]
    assert same(again, finished[0])
    stretches = json.loads((tmp_path / "run.json").read_text())["stretches"]
    assert sum(stretch["trials"] for stretch in stretches) in {3, 4}  # the last before the end is not sure


def test_workers_end_with_who_asked_for_them(study, tmp_path):
    command = [sys.executable, "-m", "explicable", "evaluate", "--study", study, "-o", tmp_path]
    with subprocess.Popen([*command, "--jobs", "2"], stdout=subprocess.PIPE) as process:
        while process.poll() is None and not (tmp_path / "records" / "small.jsonl").exists():
            time.sleep(0.01)
        process.kill()
        process.communicate(timeout=200)  # returns when no worker has the output open any more


def test_dask_workers_may_die_and_come_back(study, finished, tmp_path):
    """Every worker is killed twice while it works; new ones take over."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as cluster:
        killed = []

        def kill_workers(_, num_done, __):
            if num_done in {1, 2} and num_done not in killed:
                killed.append(num_done)
                for worker in list(cluster.workers.values()):
                    os.kill(worker.pid, signal.SIGKILL)

        records = run_experiments(
            [read_experiment(study)], tmp_path, scheduler=cluster.scheduler_address, tell=kill_workers
        )["small"]
    assert killed == [1, 2]
    assert same(records, finished[0])


def test_the_command_reports_and_says_what_failed(study, finished, tmp_path, capsys):
    experiment = read_experiment(study)
    trials = experiment.trials()
    file = RecordFile(tmp_path / "records" / "small.jsonl")
    for record in finished[0][:-1]:
        file.append(record)
    file.append(make_record(trials[-1], error="PlanError: <it> broke"))
    (tmp_path / "run.json").write_text((finished[1] / "run.json").read_text())
    arguments = ["evaluate", "--study", str(study), "-o", str(tmp_path), "--report-only"]
    assert command_line(arguments) == EXIT_TRIALS_FAILED
    assert "4 trials, 1 failed" in capsys.readouterr().out
    page = (tmp_path / "report.html").read_text()
    assert "PlanError: &lt;it&gt; broke" in page
    assert "Unexplained failures" in page


def test_a_record_that_cannot_be_written_names_its_file():
    with pytest.raises(OSError, match=r"No space left on device: '/dev/full'$"):
        RecordFile("/dev/full").append({})


def test_records_of_another_version_are_refused(finished, tmp_path, capsys):
    other = write_study(tmp_path, PLANS.replace("seed = 5", "seed = 6"))
    assert command_line(["evaluate", "--study", str(other), "-o", str(finished[1])]) == EXIT_USAGE
    assert "another version" in capsys.readouterr().err


def test_what_goes_wrong_in_a_trial_is_its_record():
    from explicable.evaluation.trials import perform

    record = perform(Trial("e", "plans", {"judges": "strangers"}, 0, (0, 0)))
    assert record["outcome"] == "failed"
    assert record["error"].startswith("UsageError: there is no family 'strangers'")
    assert "/" not in record["error"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "question"),
        ('question = "?"\nkind = "riddles"', "unknown kind of trial 'riddles'"),
        ('question = "?"\nkind = "plans"\nrepeats = 0', "repeats must be at least 1"),
        ('question = "?"\nkind = "plans"\ncolour = 1', "unknown word 'colour'"),
        ('question = "?"\nkind = "plans"\nseed = "x"', "seed can't be 'x'"),
        ('question = "?"\nkind = "plans"\n[settings]\nalpah = 1', "no setting 'alpah'"),
        ('question = "?"\nkind = "plans"\n[settings]\nplans = ["best"]', "unknown plans best"),
        ("question = ", "not an experiment"),
    ],
)
def test_a_damaged_study_is_refused(text, message, tmp_path, capsys):
    path = write_study(tmp_path, text)
    with pytest.raises(InputError, match=message):
        read_experiment(path)
    assert command_line(["evaluate", "--study", str(path)]) == EXIT_BAD_INPUT
    assert str(path) in capsys.readouterr().err


def test_a_damaged_record_is_named(tmp_path):
    file = RecordFile(tmp_path / "r.jsonl")
    file.path.write_text('{"outcome": "done"}\n')
    with pytest.raises(InputError, match=r"r\.jsonl:1: not a record"):
        file.read()


def test_no_scheduler_is_a_clear_error(study, tmp_path, monkeypatch):
    monkeypatch.setattr("explicable.evaluation.workers.CONNECT_S", 1)
    with pytest.raises(UsageError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        run_experiments([read_experiment(study)], tmp_path, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(UsageError, match=r"address is like tcp://HOST:PORT, not 'nowhere'"):
        run_experiments([read_experiment(study)], tmp_path, scheduler="nowhere")


def test_every_trial_of_a_cell_has_its_own_seed_and_cells_share_them():
    for experiment in builtin_experiments():
        trials = experiment.trials()
        assert len({trial.key for trial in trials}) == len(trials)
        seeds = {trial.seed for trial in trials}
        assert seeds == {(experiment.seed, repeat) for repeat in range(experiment.repeats)}
        assert [Trial.from_key(trial.key) for trial in trials] == trials


def test_a_quick_run_is_smaller():
    full, quick = (
        sum(len(e.trials()) for e in builtin_experiments(quick=is_quick)) for is_quick in (False, True)
    )
    assert quick < full / 4


def test_cells_are_the_product_of_lists():
    text = (
        'question = "?"\nkind = "plans"\n[[cells]]\nalpha = [1, 2]\nnum_maps = [3, 4]\n[[cells]]\nnoise = 0.1'
    )
    cells = parse_experiment(text, "e").cells
    assert [dict(cell) for cell in cells] == [
        {"alpha": 1, "num_maps": 3},
        {"alpha": 1, "num_maps": 4},
        {"alpha": 2, "num_maps": 3},
        {"alpha": 2, "num_maps": 4},
        {"noise": 0.1},
    ]
