"""Posts and tissue of a published synthetic film, as `myospring track --posts` follows them, beside the truth.

usage: synthetic_microbundle.py EXAMPLE PROGRAM

EXAMPLE is the folder `Example` of https://github.com/HibaKob/SyntheticMicroBundle (MIT, not part of this project):
a frame of a real tissue between two posts, and positions of a finite-element tissue over 25 steps (Kobeissi et al.
2024, doi 10.1371/journal.pone.0298863). PROGRAM is the built program. The frame is warped by the displacements of
those positions, as published, but smoothly over the whole frame, so that the posts move as the tissue at them does;
noise of 0, 1 and 3 % of the range of grey values is added. What is followed: the posts, as they are found, and two
squares within the tissue, as they are stated. The truth is the mean displacement of each. The environment (Python 3.11):

    pip install numpy==2.4.6 scipy==1.17.1 tifffile==2026.3.3
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import tifffile
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.ndimage import gaussian_filter, map_coordinates

example, program = pathlib.Path(sys.argv[1]), sys.argv[2]
# As in the published code: um to mm, and a model that is four times smaller.
SCALE = 4 * 1e-3
FOLDER = "FEA_Results_Homog_MaxAct0.08_VFA_Z_Lite"
PIXEL_UM, FRAMES_PER_S, STIFFNESS = 4.0, 25, 1000.0

frame = tifffile.imread(example / "Frames/Frames_D1T4_Before/Frame0000.tif").astype(float)
inside = np.argwhere(tifffile.imread(example / "Masks/D1T4_Before_Mask.tif") > 0)
rest = np.loadtxt(example / "Tissue_Slice_Coordinates.txt") / SCALE
moved = np.stack([np.loadtxt(example / FOLDER / f"pos_{axis}_lite.txt") for axis in "xy"]) / SCALE
middle = (inside.min(axis=0) + 0.5 * np.ptp(inside, axis=0))[::-1]
shift = middle - (rest.min(axis=0) + 0.5 * np.ptp(rest, axis=0))
rest += shift
# Relative to the first step: step, point, axis.
displaced = (moved - moved[:, :, :1]).transpose(2, 1, 0)

height, width = frame.shape
columns, rows = np.meshgrid(np.arange(width), np.arange(height))


def field(displacement):
    """The displacement at each pixel, smooth, and outside of the tissue that of its nearest place."""
    linear = LinearNDInterpolator(rest, displacement)(columns, rows)
    nearest = NearestNDInterpolator(rest, displacement)(columns, rows)
    whole = np.where(np.isnan(linear), nearest, linear)
    return np.stack([gaussian_filter(whole[..., axis], 6) for axis in range(2)])


def warped(flow):
    """The frame moved by a flow of material points, by fixed-point iteration for where each pixel came from."""
    came = np.stack([columns, rows]).astype(float)
    for _ in range(20):
        there = np.stack([map_coordinates(part, came[::-1], order=1, mode="nearest") for part in flow])
        came = np.stack([columns, rows]) - there
    return map_coordinates(frame, came[::-1], order=3, mode="nearest")


flows = [field(step) for step in displaced]
still = [warped(flow) for flow in flows]
contrast = np.ptp(frame)


def mean_of(flow, post):
    """The mean displacement of a post or a square, pixels."""
    column, row = post["middle_px"]
    half = 0.5 * post.get("diameter_px", 20)
    own = (abs(columns - column) <= half) & (abs(rows - row) <= half)
    return np.array([part[own].mean() for part in flow])


def followed(folder, film, *more):
    output = folder / "posts"
    command = [program, "track", film, "--posts", "--pixel-size", f"{PIXEL_UM} um", "--frame-rate", str(FRAMES_PER_S)]
    command += ["--post-stiffness", "1 uN/um", "--output", output, "--force", "--quiet", *more]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    report = json.loads((output / "posts.json").read_text())
    with open(output / "posts.csv") as file:
        table = list(csv.DictReader(file))
    return report, table


def told(name, noise, report, table):
    one, other = report["posts"]
    axis = np.subtract(other["middle_px"], one["middle_px"])
    axis = axis / np.hypot(*axis)
    first = report["rest_frame"]
    at = lambda frame: (mean_of(flows[frame], one) - mean_of(flows[frame], other)) @ axis
    truth = np.array([PIXEL_UM * (at(int(float(row["frame"]))) - at(first)) for row in table])
    found = np.array([float(row["approach_um"]) for row in table])
    stated = np.median([float(row["post_1_error_um"]) for row in table])
    off = np.sqrt(np.mean((found - truth) ** 2))
    peak = abs(truth).argmax()
    force = found[peak] / truth[peak] - 1
    print(
        f"| {name} | {100 * noise:.0f} % | {truth[peak]:.1f} | {off:.2f} | {report['approach_error_um']:.2f} ({stated:.2f} a post) | {100 * force:+.1f} % |"
    )


print("| what | noise | largest approach, um | off, um (rms) | stated error, um | force at the peak |")
print("|---|---|---|---|---|---|")
generator = np.random.default_rng(1)
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for noise in (0.0, 0.01, 0.03):
        film = folder / "film.tif"
        frames = [picture + noise * contrast * generator.standard_normal(picture.shape) for picture in still]
        tifffile.imwrite(film, np.clip(frames, 0, 65535).astype(np.uint16))
        report, table = followed(folder, film)
        told("posts, as found", noise, report, table)
        column, row = middle
        squares = f"{column - 40:.0f},{row:.0f},20x20 {column + 40:.0f},{row:.0f},20x20"
        report, table = followed(folder, film, "--post-places", squares)
        told("squares in the tissue", noise, report, table)
