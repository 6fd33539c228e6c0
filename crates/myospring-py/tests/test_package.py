"""The package as such: types, documentation, notebooks, the program."""

from __future__ import annotations

import doctest
import importlib
import inspect
import os
import pkgutil
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest

import myospring

HERE = Path(__file__).parents[1]


def test_signatures_are_those_of_the_table_of_settings():
    made = subprocess.run([sys.executable, HERE / "generate.py", "--check"], capture_output=True, text=True)
    assert made.returncode == 0, made.stdout + made.stderr


def test_names_are_unique_and_end_in_their_unit():
    from myospring import _native

    rows = [row for row in _native.settings() if row["key"] != "shape.outline"]
    names = [row["name"] for row in rows]
    assert len(set(names)) == len(names)
    for row in rows:
        if row["kind"] == "quantity" and row["unit"]:
            unit = row["unit"].replace("uM", "micromolar").lower().replace("^", "").replace("/", "_per_")
            assert row["name"].endswith("_" + unit), row["name"]


def test_examples_in_the_documentation_run():
    modules = [myospring] + [
        importlib.import_module(f"myospring.{module.name}")
        for module in pkgutil.iter_modules(myospring.__path__)
        if module.name != "_native"
    ]
    results = [doctest.testmod(module) for module in modules]
    assert sum(result.failed for result in results) == 0
    assert sum(result.attempted for result in results) > 10


def test_every_public_name_is_explained():
    for name in myospring.__all__:
        thing = getattr(myospring, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
    text = myospring.simulate.__doc__
    for name in inspect.signature(myospring.simulate).parameters:
        assert re.search(rf"^ *{name} : ", text, re.MULTILINE), name


def test_notebooks_show_cells_and_beats(cell, beat):
    for svg in (cell._repr_svg_(), beat._repr_svg_()):
        assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert "peak shortening" in beat._repr_html_()
    page = beat.animate()
    text = page if isinstance(page, str) else page.data
    assert "<script" in text or "&lt;script" in text


def test_a_beat_is_drawn(beat):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    axes = beat.plot()
    assert [one.get_ylabel() for one in axes][1:] == ["Tension (kPa)", "Shortening (%)"]


def test_the_program_is_the_same_one(run):
    assert run("--version").stdout.strip() == f"myospring {myospring.__version__}"


def test_the_program_gives_its_exit_code_and_heeds_ctrl_c(program, tmp_path):
    assert subprocess.run([program, "run", "nothing.toml"], capture_output=True, cwd=tmp_path).returncode == 2
    running = subprocess.Popen([program, "run", "--beats", "50", "--output", "long"], cwd=tmp_path,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    assert running.wait(timeout=20) in (-signal.SIGINT, 128 + signal.SIGINT)


@pytest.mark.parametrize("page", ["python.md", "clusters.md"])
def test_the_tutorial_runs(page, tmp_path):
    """The blocks of the page, one after the other, as one script."""
    for package in ("SALib", "distributed"):
        pytest.importorskip(package)
    page = (HERE.parents[1] / "docs" / page).read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    script = "import matplotlib\nmatplotlib.use('agg')\n" + "\n".join(blocks)
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MPLCONFIGDIR": str(tmp_path)})
    assert done.returncode == 0, done.stderr
