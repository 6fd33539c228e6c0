"""Workers of Dask and ranks of MPI, killed at random moments: the study has the bits of one that nobody disturbed.

usage: killed_workers.py [ROUNDS] [SEED] [CELLS]

In each round of Dask (20 unless stated) a study of beats on two workers loses one at a random moment, whose work the other one and the
new one do. MPI ends all ranks where one dies: the same command then goes on, on as many ranks, from the batches that were kept; it is
killed again until the study is done. At last a study of CELLS cells (none unless stated) by one and two threads and workers of Dask, and by
two workers of which one is killed, at most ten times. Needs `distributed`, and `mpi4py` with `mpiexec`; what is not there is skipped, and said.
"""

import contextlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import myospring
from killed_campaign import STUDY as CELLS

STUDY = """
metrics = ["peak_shortening", "active_work"]
[run.shape]
spacing = "5 um"
[parameters]
tau_si = { distribution = "uniform", low = 0.98, high = 1.02, relative = true }
peak_tension = { distribution = "uniform", low = "20 kPa", high = "510 kPa" }
[sampling]
sampler = "latin-hypercube"
size = 960
"""

RANK = f"""
import sys
import myospring
from mpi4py.futures import MPIPoolExecutor
if __name__ == "__main__":
    with MPIPoolExecutor() as executor:
        myospring.run_study({STUDY!r}, executor, output=sys.argv[1], batch_seconds=0.5)
"""


def killed_later(processes, most_s, found):
    """Kills one of some processes at a random moment."""

    def kill():
        time.sleep(found.uniform(0, most_s))
        try:
            if alive := processes():
                os.kill(found.choice(alive), signal.SIGKILL)
                killed.append(1)
        except ProcessLookupError:
            # It was done before.
            pass

    killed = []
    thread = threading.Thread(target=kill)
    thread.start()
    return thread, killed


def dask(rounds, found, folder, serial, seconds):
    from distributed import Client, LocalCluster

    lost = 0
    for number in range(rounds):
        output = folder / f"dask{number}"
        with (
            LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=folder) as cluster,
            Client(cluster) as client,
        ):
            workers = list(client.run(os.getpid).values())
            thread, killed = killed_later(lambda workers=workers: workers, seconds, found)
            result = myospring.run_study(STUDY, client.get_executor(pure=False), output=output, batch_seconds=0.5)
            thread.join()
        lost += len(killed)
        assert result.metrics.tobytes() == serial.metrics.tobytes(), number
        assert table(output) == table(folder / "serial"), number
    print(f"Dask: {rounds} rounds, {lost} workers killed, all with the bits of one thread")


def many_cells(cells, found, folder):
    """A long study: the seconds by one and two threads and workers, and by two workers of which one is killed again and again."""
    from distributed import Client, LocalCluster

    kills = 10
    text = CELLS.format(cells=cells)

    def timed(name, **how):
        start = time.monotonic()
        myospring.run_study(text, output=folder / name, **how)
        seconds = time.monotonic() - start
        assert table(folder / name) == table(folder / "thread1"), name
        return seconds

    def by_workers(name, workers, within=None):
        """Returns the seconds, and how many workers were killed: at random moments of a time, if one is given."""
        options = {"dashboard_address": None, "local_directory": folder}
        with (
            LocalCluster(n_workers=workers, threads_per_worker=1, **options) as cluster,
            Client(cluster) as client,
        ):
            client.wait_for_workers(workers)
            over, killed = threading.Event(), []

            def kill():
                while within and len(killed) < kills and not over.wait(found.uniform(0, within / kills)):
                    pids = {nanny.pid for nanny in cluster.workers.values()} - {None, *killed}
                    if pids:
                        one = found.choice(sorted(pids))
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(one, signal.SIGKILL)
                            killed.append(one)

            thread = threading.Thread(target=kill)
            thread.start()
            # A batch is given up after as many tries as there are kills, and not before.
            seconds = timed(name, executor=client.get_executor(pure=False), tries=kills)
            over.set()
            thread.join()
        return seconds, len(killed)

    for threads in (1, 2):
        print(f"{cells} cells: {timed(f'thread{threads}', threads=threads):.0f} s by {threads} threads", flush=True)
    for workers in (1, 2):
        seconds, _ = by_workers(f"worker{workers}", workers)
        print(f"{cells} cells: {seconds:.0f} s by {workers} workers of Dask", flush=True)
    seconds, killed = by_workers("killed", 2, within=seconds)
    print(f"{cells} cells: {seconds:.0f} s by 2 workers of Dask, of which one was killed {killed} times; all tables are the same")


def mpi(rounds, found, folder, seconds):
    mpiexec = shutil.which("mpiexec", path=pathlib.Path(sys.executable).parent) or shutil.which("mpiexec")
    if mpiexec is None:
        print("mpi4py skipped: there is no mpiexec; the package mpich brings one")
        return
    script = folder / "ranks.py"
    script.write_text(RANK)
    lost = 0
    for number in range(rounds):
        output = folder / f"mpi{number}"
        command = [mpiexec, "-n", "3", sys.executable, "-m", "mpi4py.futures", str(script), str(output)]
        while True:
            running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            thread, killed = killed_later(lambda running=running: ranks_of(running.pid), 1.5 * seconds, found)
            code = running.wait()
            thread.join()
            lost += len(killed)
            if code == 0:
                break
            assert killed, f"ranks that nobody killed ended with the code {code}"
        assert table(output) == table(folder / "serial"), number
    print(f"MPI: {rounds} studies on 3 ranks, {lost} times a rank killed, all with the bits of one thread")


def ranks_of(pid):
    """Processes of Python below a process."""
    below, ranks = [pid], []
    while below:
        one = below.pop()
        for children in pathlib.Path(f"/proc/{one}/task").glob("*/children"):
            try:
                found = [int(child) for child in children.read_text().split()]
                ranks += [child for child in found if command_of(child).startswith(sys.executable)]
                below += found
            except OSError:
                continue
    return ranks


def command_of(pid):
    return pathlib.Path(f"/proc/{pid}/cmdline").read_text()


def table(folder):
    return (folder / "members.csv").read_bytes()


if __name__ == "__main__":
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else os.getpid()
    cells = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    print(f"seed {seed}", flush=True)
    found = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        start = time.monotonic()
        serial = myospring.run_study(STUDY, output=folder / "serial", threads=1)
        seconds = time.monotonic() - start
        for package, work in (
            ("distributed", lambda: dask(rounds, found, folder, serial, seconds)),
            ("mpi4py", lambda: mpi(rounds, found, folder, seconds)),
        ):
            try:
                __import__(package)
            except ImportError as error:
                print(f"{package} skipped: {error}")
            else:
                work()
                if cells and package == "distributed":
                    many_cells(cells, found, folder)
