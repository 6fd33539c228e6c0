"""Lets SarcGraph find sarcomeres in published pictures; verification/src/sarcomeres.rs compares ours with them.

usage: sarcgraph_reference.py IMAGES FILE

IMAGES is the folder `images` of the published data, FILE the table to write (verification/reference/sarcgraph.csv).
SarcGraph 0.3.0 pins versions that the other programs of `cargo xtask verify` cannot live with, so it has an
environment of its own (Python 3.11):

    pip install numpy==1.24.4 pandas==1.5.3 scipy==1.10.1 scikit-image==0.20.0 scikit-learn==1.2.2 \
        networkx==2.8.4 sk-video==1.1.10 matplotlib==3.7.5 numba looseversion pyyaml
    pip install --no-deps trackpy==0.6.1 sarcgraph==0.3.0

It is given the Gaussian of its default (1 pixel) and lengths of 1 to 3 um, 1.9 um on average. Its x runs down the
rows of a picture, its y along the columns, its angle counter-clockwise from the columns' direction.
"""

import pathlib
import sys
import tempfile

from sarcgraph import SarcGraph

# Picture and side of a pixel in um, as SOURCES.md estimates it.
PICTURES = [
    ("sarcgraph_e1_rest.png", 0.18),
    ("sarcgraph_e2_rest.png", 0.18),
    ("sarcgraph_e5_fluorescence.png", 0.27),
    ("sarcgraph_sample_5.png", 0.18),
]


def main(images, file):
    lines = ["picture,pixel_um,column,row,length_um,angle_deg"]
    for name, pixel in PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            graph = SarcGraph(
                output_dir=folder,
                input_type="image",
                sigma=1.0,
                avg_sarc_length=1.9 / pixel,
                min_sarc_length=1.0 / pixel,
                max_sarc_length=3.0 / pixel,
            )
            found, _ = graph.sarcomere_detection(input_file=str(pathlib.Path(images, name)))
        for _, one in found.iterrows():
            degrees = one.angle * 180.0 / 3.141592653589793
            place = f"{one.y:.1f},{one.x:.1f}"
            lines.append(f"{name},{pixel},{place},{one.length * pixel:.3f},{degrees:.1f}")
    pathlib.Path(file).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
