"""A study of many cells and a batch of many pictures, killed again and again: nothing is lost, and memory grows little.

usage: killed_campaign.py MYOSPRING [--cells N] [--pictures N] [--kills N] [--seed N]

MYOSPRING is the program. Each of both works is done once undisturbed, then once more and killed (SIGKILL) at random moments, after which the
same command goes on. The tables of both must be equal, row by row. Prints one JSON line for each work: its rows, seconds, kills, and the
largest memory of the undisturbed process up to each tenth of its time, MB (on Linux).
"""

import argparse
import csv
import hashlib
import json
import math
import pathlib
import random
import signal
import struct
import subprocess
import tempfile
import threading
import time
import zlib

STUDY = """
kind = "cell"
metrics = ["action_potential_duration_90", "peak_tension"]
[run.cell]
model = "coelho_2021"
[parameters]
tau_fi = {{ distribution = "lognormal", median = 1, log_standard_deviation = 0.10, relative = true }}
tau_si = {{ distribution = "lognormal", median = 1, log_standard_deviation = 0.02, relative = true }}
tau_w_plus = {{ distribution = "lognormal", median = 1, log_standard_deviation = 0.10, relative = true }}
[sampling]
sampler = "latin-hypercube"
size = {cells}
"""


def picture(found, columns=300, rows=160):
    """A striated cell on a dark ground, as a grey PNG of 0.5 um pixels."""
    angle = found.choice((-1, 1)) * found.uniform(0.1, 0.4)
    length, width = found.uniform(180, 230), found.uniform(36, 56)
    period, phase = found.uniform(3.4, 4.2), found.uniform(0, 6)
    lines = bytearray()
    for row in range(rows):
        lines.append(0)
        for column in range(columns):
            x, y = column - columns / 2, row - rows / 2
            along = x * math.cos(angle) + y * math.sin(angle)
            across = y * math.cos(angle) - x * math.sin(angle)
            inside = abs(2 * along / length) ** 3 + abs(2 * across / width) ** 3 < 1
            stripes = 1 + 0.4 * math.cos(2 * math.pi * along / period + phase)
            lines.append(round(min(255, found.gauss(12, 3) ** 2 / 12 + (120 * stripes if inside else 0))))

    def chunk(kind, data):
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes(lines)))
        + chunk(b"IEND", b"")
    )


def peak_mb(process):
    """The largest memory that a process has had, MB; nothing when it has ended."""
    try:
        for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1000
    except FileNotFoundError:
        pass
    return None


def undisturbed(command):
    """Seconds, and the peaks of memory up to each tenth of the time."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    peaks = []

    def watch():
        while process.poll() is None:
            if peak := peak_mb(process):
                peaks.append(peak)
            time.sleep(0.05)

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, error = process.communicate()
    watcher.join()
    # 1: some pictures have no cell, and a row that says so.
    if process.returncode not in (0, 1):
        raise SystemExit(f"{command}: exit code {process.returncode}\n{error}")
    last = len(peaks) - 1
    tenths = [peaks[min(last, len(peaks) * tenth // 10)] for tenth in range(1, 11) if peaks]
    return time.monotonic() - start, [round(peak) for peak in tenths]


def killed(command, kills, takes_s, found):
    """Kills the work at random moments until it was killed so often, then lets it end; returns how often and the seconds of all."""
    start, times = time.monotonic(), 0
    while times < kills:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            # Half of the time on average, so that it is not done before the last kill.
            process.wait(found.uniform(0, takes_s / kills))
            break
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            times += 1
    last = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if last.returncode not in (0, 1):
        raise SystemExit(f"{command}: exit code {last.returncode}\n{last.stderr}")
    return times, time.monotonic() - start


def rows(folder, table):
    """The rows of a table of results, in order, without the seconds that each took."""
    with (folder / table).open(newline="") as file:
        head, *others = csv.reader(file)
    kept = [place for place, column in enumerate(head) if column not in ("segment_s", "beat_s")]
    return [[row[place] for place in kept] for row in (head, *others)]


def digest(table):
    return hashlib.sha256(json.dumps(table).encode()).hexdigest()[:16]


def campaign(name, command, table, wanted, arguments, place, found):
    """Does a work undisturbed and killed, and compares."""
    folders = [place / f"{name}_undisturbed", place / f"{name}_killed"]
    seconds, memory = undisturbed([*command, "--output", str(folders[0])])
    kills, seconds_killed = killed(
        [*command, "--output", str(folders[1])], arguments.kills, seconds, found
    )
    first, second = (rows(folder, table) for folder in folders)
    if first != second:
        raise SystemExit(f"{name}: {table} differs after {kills} kills")
    if len(first) - 1 != wanted:
        raise SystemExit(f"{name}: {len(first) - 1} rows of {wanted}")
    print(
        json.dumps(
            {
                "work": name,
                "rows": len(first) - 1,
                "seconds": round(seconds, 1),
                "memory_mb": memory,
                "kills": kills,
                "seconds_with_kills": round(seconds_killed, 1),
                "digest": digest(first),
            }
        ),
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cells", type=int, default=1_000_000)
    parser.add_argument("--pictures", type=int, default=2000)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    found = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        if arguments.cells:
            study = place / "study.toml"
            study.write_text(STUDY.format(cells=arguments.cells))
            command = [arguments.program, "study", "run", str(study)]
            campaign("study", command, "members.csv", arguments.cells, arguments, place, found)
        if arguments.pictures:
            pictures = place / "pictures"
            pictures.mkdir()
            for number in range(arguments.pictures):
                (pictures / f"cell_{number:05}.png").write_bytes(picture(found))
            command = [arguments.program, "batch", str(pictures), "--pixel-size", "0.5 um"]
            command += ["--integrator", "quasi-static", "--spacing", "4 um"]
            campaign("batch", command, "cells.csv", arguments.pictures, arguments, place, found)


if __name__ == "__main__":
    main()
