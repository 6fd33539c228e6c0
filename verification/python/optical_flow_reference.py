"""Lets scikit-image follow a published film; verification/src/motion.rs compares ours with it.

usage: optical_flow_reference.py FILM FILE

FILM is films/sarcgraph_sample_2.avi of the published data, FILE the table to write
(verification/reference/optical_flow.csv). Frames are decoded by ffmpeg. The environment (Python 3.11):

    pip install numpy==2.4.6 scikit-image==0.26.0

`optical_flow_ilk` is the iterative Lucas-Kanade of Le Besnerais and Champagnat 2005: a flow of whole windows by least
squares on the grey values, without gradients of the flow, without normalisation, from coarse to fine over a pyramid of
the picture itself. Its windows of 23 pixels are as wide as our subsets.
"""

import subprocess
import sys

import numpy as np
from skimage.registration import optical_flow_ilk

# The frame that ours takes for rest, and frames over three beats.
REST = 45
FRAMES = [10, 16, 22, 28, 40, 58, 64, 69, 74, 90, 104, 110, 116, 121, 130]
# Pixels between the places, and beside the frame that are left out.
STEP, RIM = 16, 24


def read(film):
    stream = ["ffmpeg", "-loglevel", "error", "-i", film, "-f", "rawvideo", "-pix_fmt", "gray", "-"]
    bytes_ = subprocess.run(stream, check=True, capture_output=True).stdout
    return np.frombuffer(bytes_, dtype=np.uint8).reshape(-1, 400, 400).astype(np.float32) / 255.0


def main(film, file):
    frames = read(film)
    lines = ["frame,column,row,right_px,down_px"]
    for frame in FRAMES:
        down, right = optical_flow_ilk(frames[REST], frames[frame], radius=11, num_warp=10, prefilter=True)
        for row in range(RIM, 400 - RIM + 1, STEP):
            for column in range(RIM, 400 - RIM + 1, STEP):
                lines.append(f"{frame},{column},{row},{right[row, column]:.3f},{down[row, column]:.3f}")
    with open(file, "w", encoding="ascii") as table:
        table.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
