"""Studies give the same bits wherever their members are worked on, and lose nothing."""

from __future__ import annotations

import json
import multiprocessing
import os
import pickle
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import numpy as np
import pytest

import myospring
from myospring import _engine

# Thousands of quick members, and some hundred with a mesh.
CELLS = """
kind = "cell"
metrics = ["peak_tension", "action_potential_duration_90"]
[run.stimulus]
beats = 4
[parameters]
tau_si = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
tau_so1 = { distribution = "uniform", low = 0.9, high = 1.1, relative = true }
peak_tension = { distribution = "uniform", low = "20 kPa", high = 60 }
[sampling]
sampler = "saltelli"
size = 256
[keep]
peak_tension = [30, 50]
"""
BEATS = """
metrics = ["peak_shortening", "active_work"]
[run.shape]
spacing = "5 um"
[parameters]
tau_si = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
peak_tension = { distribution = "uniform", low = "20 kPa", high = "510 kPa" }
[sampling]
sampler = "latin-hypercube"
size = 240
"""
STUDIES = {"cells": CELLS, "beats": BEATS}


class Serial:
    """A study by the program, on one thread and in two parts, and by Python on one thread."""

    def __init__(self, name: str, folder: Path, program: str) -> None:
        self.text = STUDIES[name]
        self.path = folder / f"{name}.toml"
        self.path.write_text(self.text)

        def run(*arguments: str) -> None:
            done = subprocess.run([program, "study", *arguments], cwd=folder, capture_output=True, text=True)
            # A member that fails is a row, and told by the code 1.
            assert done.returncode in (0, 1), done.stderr

        run("run", self.path.name, "--output", f"{name}_program", "--jobs", "1", "--quiet")
        for part in ("1/2", "2/2"):
            run("run", self.path.name, "--output", f"{name}_parts", "--shard", part, "--quiet")
        run("merge", self.path.name, "--output", f"{name}_parts")
        self.table = (folder / f"{name}_program" / "members.csv").read_bytes()
        self.numbers = (folder / f"{name}_program" / "study.json").read_bytes()
        assert (folder / f"{name}_parts" / "members.csv").read_bytes() == self.table
        self.result = myospring.run_study(self.path, threads=1)

    def equals(self, result: myospring.StudyResult) -> None:
        """To the last bit."""
        assert result.metrics.tobytes() == self.result.metrics.tobytes()
        assert (result.status, result.reasons) == (self.result.status, self.result.reasons)

    def has_the_files_of(self, folder: Path) -> None:
        assert (folder / "members.csv").read_bytes() == self.table
        assert (folder / "study.json").read_bytes() == self.numbers


@pytest.fixture(scope="module")
def serial(tmp_path_factory, program):
    folder = tmp_path_factory.mktemp("serial")
    return {name: Serial(name, folder, program) for name in STUDIES}


class KillsOne:
    """Kills one of some processes, which the test has started, once the first batch of a study is done."""

    def __init__(self, patch, processes) -> None:
        self.killed = None
        take = _engine.StudyTasks.take

        def and_kill(tasks, answer) -> None:
            take(tasks, answer)
            if self.killed is None:
                self.killed = processes()[0]
                os.kill(self.killed, signal.SIGKILL)

        patch.setattr(_engine.StudyTasks, "take", and_kill)


@pytest.mark.parametrize("name", STUDIES)
def test_python_and_the_program_write_the_same_files(serial, name, tmp_path):
    study = serial[name]
    shown = []
    result = myospring.run_study(
        study.path, output=tmp_path / "out", batch_seconds=0.5, progress=lambda *of: shown.append(of)
    )
    study.equals(result)
    study.has_the_files_of(tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"members.parquet", "study.toml", "figures"}
    study.has_the_files_of(result.save(tmp_path / "elsewhere"))
    assert shown[0][:2] == ("members", 0) and shown[-1][1:] == (len(result.status), len(result.status))


def test_a_result_is_arrays_and_a_table_and_can_be_pickled(serial):
    result = serial["cells"].result
    members = 256 * 5
    assert result.values.shape == (members, 3) and result.metrics.shape == (members, 2)
    assert result.names == ["peak_tension", "tau_si", "tau_so1"] and result.units["peak_tension"] == "kPa"
    tension = result.metrics[:, 0]
    np.testing.assert_array_equal(result.kept, (tension >= 30) & (tension <= 50))
    written = json.loads(serial["cells"].numbers)
    for one in written["sensitivity"]:
        ranked = result.sensitivity[one["metric"]]
        first, row = next(iter(ranked.items())), one["parameters"][0]
        assert row["parameter"].endswith("." + first[0]) and first[1].total.value == row["total"]["value"]
    assert result.usual["peak_tension"] == written["usual"][0]["value"]
    frame = result.to_dataframe()
    assert frame.index.name == "member" and frame.loc[1, "tau_si"] == result.values[0, 1]
    again = pickle.loads(pickle.dumps(result))
    assert again.metrics.tobytes() == result.metrics.tobytes()
    assert again.sensitivity == result.sensitivity
    assert "1280 members" in repr(result) and "kept" in result._repr_html_()


def test_a_dict_a_text_and_a_file_are_the_same_study(serial):
    import tomllib

    study = tomllib.loads(CELLS)
    study["sampling"]["size"] = np.int64(16)
    of_dict = myospring.run_study(study)
    of_text = myospring.run_study(CELLS.replace("256", "16"))
    assert of_dict.metrics.tobytes() == of_text.metrics.tobytes()
    with pytest.raises(myospring.UnknownNameError, match="nearest are tau_si"):
        myospring.run_study(CELLS.replace("tau_si", "tau_sii"))
    with pytest.raises(ValueError, match="size"):
        myospring.run_study(CELLS.replace("256", "0"))
    for of_nothing in ({"kind": "cell"}, 'kind = "cell"'):
        with pytest.raises(ValueError, match=r"^\[sampling\] is missing; .* size = 100"):
            myospring.run_study(of_nothing)
    with pytest.raises(ValueError, match=r"^unknown field `sampler`"):
        myospring.run_study({"sampler": "morris"})
    with pytest.raises(FileNotFoundError, match="nothing.toml"):
        myospring.run_study("nothing.toml")
    with pytest.raises(ValueError, match="0.5 to 30 s"):
        myospring.run_study(CELLS, batch_seconds=60)


def test_ctrl_c_ends_a_study_within_a_second_and_what_is_done_is_kept(serial, tmp_path):
    from test_batch import interrupted

    for name, size in [("cells", "size = 30000"), ("beats", "size = 4000")]:
        text = STUDIES[name].replace("size = 256", size).replace("size = 240", size)
        folder = tmp_path / name
        # A second, and another one where others use the machine.
        assert interrupted(lambda: myospring.run_study(text, output=folder, threads=2, batch_seconds=0.5)) < 2
        # What was kept is read by the next one, which is interrupted, too.
        before = (folder / "progress.jsonl").read_bytes()
        assert interrupted(lambda: myospring.run_study(text, output=folder, threads=2)) < 2
        assert (folder / "progress.jsonl").read_bytes().startswith(before)


def test_a_killed_study_goes_on_in_python_and_in_the_program(serial, program, tmp_path):
    study, killed, other = serial["beats"], tmp_path / "killed", tmp_path / "other"
    script = "import sys, myospring\nmyospring.run_study(sys.argv[1], output=sys.argv[2], threads=1, batch_seconds=0.5)"
    parent = subprocess.Popen([sys.executable, "-c", script, study.path, killed])
    journal = killed / "progress.jsonl"
    while not journal.exists() or journal.read_bytes().count(b"\n") < 4:
        assert parent.poll() is None, "it has ended too early"
        time.sleep(0.005)
    parent.kill()
    parent.wait()
    known = journal.read_bytes().count(b"\n")
    assert 4 <= known < len(study.result.status)
    shutil.copytree(killed, other)
    shown = []
    study.equals(myospring.run_study(study.path, output=killed, progress=lambda *of: shown.append(of)))
    assert shown[0][1] == known
    study.has_the_files_of(killed)
    done = subprocess.run([program, "study", "run", study.path, "--output", other], capture_output=True, text=True)
    assert f"{known} of 240 members are done" in done.stderr, done.stderr
    study.has_the_files_of(other)


def test_processes_give_the_same_bits_also_where_one_is_killed(serial, tmp_path, monkeypatch):
    study = serial["cells"]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        kills = KillsOne(monkeypatch, lambda: list(pool._processes))
        result = myospring.run_study(study.path, pool, output=tmp_path / "out", batch_seconds=0.5)
    assert kills.killed is not None
    study.equals(result)
    study.has_the_files_of(tmp_path / "out")


@pytest.mark.parametrize("method", ["fork", "forkserver"])
def test_processes_of_every_kind_and_threads_give_the_same_bits(serial, method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    study = serial["beats"]
    context = multiprocessing.get_context(method)
    study.equals(myospring.run_study(study.path, lambda: ProcessPoolExecutor(2, mp_context=context), threads=2))
    with ThreadPoolExecutor(3) as threads:
        study.equals(myospring.run_study(study.path, threads, batch_seconds=0.5))


class KilledWorker(Exception):
    """As that of `distributed`."""


class Deadly(Executor):
    """Works at once, but whatever some members are in dies: alone, or with the whole executor."""

    def __init__(self, members: set[int], with_all: bool) -> None:
        self.members, self.with_all = members, with_all
        self.broken = False
        self.submitted = 0

    def submit(self, work, key, head, numbers, *arguments):
        if self.broken:
            raise BrokenProcessPool("it is broken")
        self.submitted += 1
        future: Future = Future()
        future.set_running_or_notify_cancel()
        if self.members & set(numbers.tolist()):
            self.broken = self.with_all
            future.set_exception(BrokenProcessPool("a process died") if self.with_all else KilledWorker("thrice"))
        else:
            future.set_result(work(key, head, numbers, *arguments))
        return future


@pytest.mark.parametrize("with_all", [False, True])
def test_members_whose_workers_die_again_and_again_fail_with_the_reason_and_are_tried_anew(serial, with_all, tmp_path, monkeypatch):
    study = serial["beats"]
    made = []
    monkeypatch.setattr(_engine, "LARGEST", 16)

    def make():
        made.append(Deadly({100}, with_all))
        return made[-1]

    result = myospring.run_study(study.path, make, output=tmp_path / "out", batch_seconds=0.5)
    died = [reason is not None and "worker died 3 times" in reason for reason in result.reasons]
    assert 1 <= sum(died) <= 16 and died[99]
    assert result.status[99] == "failed" and np.isnan(result.metrics[99]).all()
    alive = ~np.array(died)
    assert result.metrics[alive].tobytes() == study.result.metrics[alive].tobytes()
    # Three pools died of it, and none for others that went with it.
    assert len(made) == (4 if with_all else 1)
    study.equals(myospring.run_study(study.path, output=tmp_path / "out"))
    study.has_the_files_of(tmp_path / "out")


def test_workers_that_die_of_anything_end_the_study_with_what_is_done(serial, monkeypatch):
    monkeypatch.setattr(_engine, "LARGEST", 8)
    with pytest.raises(RuntimeError, match="3 batches in a row were lost"):
        myospring.run_study(serial["beats"].path, lambda: Deadly(set(range(1, 241)), True))
    with pytest.raises(RuntimeError, match="Give a function that makes an executor"):
        myospring.run_study(serial["beats"].path, Deadly({1}, True))


def test_an_engine_is_given_a_few_batches_at_a_time_of_about_the_time_that_was_asked_for():
    pace = _engine.Pace("beat", 2.0)
    assert pace.size(10_000_000, 2) == 4
    pace.seen(4, 0.08)
    assert pace.size(10_000_000, 2) == 100 and pace.size(20, 2) == 5 and pace.size(1, 64) == 1
    cells = _engine.Pace("cell", 1.0)
    cells.seen(128, 0.01)
    assert cells.size(10_000_000, 8) == 12_800 and cells.size(3, 8) == 3


def test_dask_gives_the_same_bits_also_where_a_worker_is_killed(serial, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=tmp_path
    )
    with cluster, distributed.Client(cluster) as client:
        for name, study in serial.items():
            with monkeypatch.context() as patch:
                kills = KillsOne(patch, lambda: list(client.run(os.getpid).values()))
                result = myospring.run_study(
                    study.path, client.get_executor(pure=False), output=tmp_path / name, batch_seconds=0.5
                )
            assert kills.killed is not None
            study.equals(result)
            study.has_the_files_of(tmp_path / name)


def test_mpi_gives_the_same_bits_on_two_ranks(serial, tmp_path):
    pytest.importorskip("mpi4py", reason="mpi4py is not installed", exc_type=ImportError)
    beside = shutil.which("mpiexec", path=Path(sys.executable).parent)
    mpiexec = beside or shutil.which("mpiexec")
    if mpiexec is None:
        pytest.skip("there is no mpiexec; the package mpich brings one")
    study = serial["beats"]
    script = tmp_path / "study.py"
    script.write_text(
        "import sys\n"
        "import numpy as np\n"
        "from mpi4py.futures import MPIPoolExecutor\n"
        "import myospring\n"
        "if __name__ == '__main__':\n"
        "    with MPIPoolExecutor() as executor:\n"
        "        result = myospring.run_study(sys.argv[1], executor, batch_seconds=0.5)\n"
        "    np.save(sys.argv[2], result.metrics)\n"
    )
    command = [mpiexec, "-n", "2", sys.executable, "-m", "mpi4py.futures", script, study.path, tmp_path / "metrics.npy"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert np.load(tmp_path / "metrics.npy").tobytes() == study.result.metrics.tobytes()


def test_salib_finds_the_indices_of_the_program(serial):
    analyze = pytest.importorskip("SALib.analyze.sobol")
    result = serial["cells"].result
    problem = {"num_vars": 3, "names": result.names, "bounds": [[0, 1]] * 3}
    for metric, answers in zip(result.metric_names, result.metrics.T):
        found = analyze.analyze(problem, answers, calc_second_order=False, seed=1)
        for at, name in enumerate(result.names):
            ours = result.sensitivity[metric][name]
            assert ours.first.value == pytest.approx(found["S1"][at], abs=1e-12)
            assert ours.total.value == pytest.approx(found["ST"][at], abs=1e-12)
            # Other resamples of the same bootstrap.
            assert ours.total.confidence == pytest.approx(found["ST_conf"][at], rel=0.5, abs=1e-3)


def test_rows_of_salib_are_a_study_and_a_batch_to_the_same_bits(cell, tmp_path, program):
    sample = pytest.importorskip("SALib.sample.sobol")
    tau = myospring.parameters()["tau_si"].value
    problem = {"num_vars": 2, "names": ["peak_tension", "tau_si"], "bounds": [[20, 60], [0.98 * tau, 1.02 * tau]]}
    rows = sample.sample(problem, 8, calc_second_order=False)
    metrics = ["peak_shortening", "active_work"]
    study = {"metrics": metrics, "run": {"shape": {"spacing": "4 um"}, "cell": {"integrator": "adaptive"}}}
    result = myospring.run_study(study, rows=rows, names=problem["names"], output=tmp_path / "out")
    np.testing.assert_array_equal(result.values, rows)
    batch = myospring.simulate_batch(
        rows, ["peak_tension_kpa", "tau_si"], cell, metrics=metrics, cell_integrator="adaptive"
    )
    assert batch.tobytes() == result.metrics.tobytes()
    table = (tmp_path / "out" / "members.csv").read_bytes()
    subprocess.run([program, "study", "run", "study.toml", "--output", "again"], cwd=tmp_path / "out", check=True, capture_output=True)
    assert (tmp_path / "out" / "again" / "members.csv").read_bytes() == table
    with pytest.raises(ValueError, match="give .N, K. with K names"):
        myospring.run_study(study, rows=rows, names=["peak_tension"])
    for key in ("parameters", "sampling"):
        with pytest.raises(ValueError, match=rf"\[{key}\] would not be used: leave it out"):
            myospring.run_study(study | {key: {}}, rows=rows, names=problem["names"])
