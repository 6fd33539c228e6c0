"""The package as such: types, documentation, notebooks, the program."""

from __future__ import annotations

import ast
import doctest
import importlib
import importlib.metadata
import inspect
import os
import pkgutil
import re
import signal
import subprocess
import sys
import time
import warnings
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


def test_modules_import_each_other_without_a_circle():
    modules = {path.stem: ast.parse(path.read_text()) for path in Path(myospring.__file__).parent.glob("*.py")}
    imports = [(name, node) for name, tree in modules.items() for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    uses = {name: set() for name in modules}
    for name, node in imports:
        package, _, module = (node.module or "").partition(".")
        if package == "myospring":
            # `from myospring import _native` names a module, `from myospring import Cell` the package itself.
            found = {module} if module else {one.name if one.name.startswith("_") else "__init__" for one in node.names}
            uses[name] |= found & modules.keys()
    assert len(uses["__init__"]) > 10
    while free := [name for name, used in uses.items() if not used]:
        for name in free:
            del uses[name]
        for used in uses.values():
            used.difference_update(free)
    assert not uses, f"these modules import each other in circles: {uses}"


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
    assert "<script" in str(page) and "&lt;script" in page._repr_html_()


def test_a_beat_tells_the_tension_that_it_reached(cell, beat):
    land = myospring.simulate(cell, model="land_2017", integrator="quasi-static")
    for one in (beat, land):
        told = float(re.search(r"up to ([0-9.]+) kPa", repr(one))[1])
        assert told == pytest.approx(one.metrics["peak_tension"], rel=5e-3)


def test_what_cannot_be_saved_is_refused_in_the_words_of_python(beat, tmp_path):
    with pytest.raises(myospring.UnknownNameError, match="gifs.*did you mean `gif`"):
        beat.save(tmp_path / "one", outputs=["gifs"])
    assert not (tmp_path / "one").exists()
    beat.save(tmp_path / "one", outputs="none")
    with pytest.raises(OSError, match="force=True") as refused:
        beat.save(tmp_path / "one", outputs="none")
    assert "--" not in str(refused.value)


def test_a_picture_in_place_of_a_cell_is_told_how_to_become_one():
    for call in (
        lambda cell: myospring.simulate(cell),
        lambda cell: myospring.simulate_batch([[1.0]], ["peak_tension"], cell),
        lambda cell: myospring.fit(([0.0], [1.0]), cell),
    ):
        with pytest.raises(TypeError, match=r'Cell.from_image\("cell.png", pixel_size_um='):
            call("cell.png")
        with pytest.raises(TypeError, match="from_outline"):
            call(Path("cell.roi"))


def test_warnings_are_pythons_own_once_and_at_the_line_of_the_caller(cell):
    small = {"min_area_um2": 5000.0, "any_size": True, "spacing_um": 4.0, "pixel_size_um": 0.5}
    mask = [[20 < column < 220 and 10 < row < 50 for column in range(240)] for row in range(60)]
    with pytest.warns(myospring.MyospringWarning) as said:
        own = myospring.Cell.from_mask(mask, **small)
    assert [str(one.message) for one in said] == own.warnings and own.warnings
    assert {one.filename for one in said} == {__file__}
    with warnings.catch_warnings(record=True) as again:
        warnings.simplefilter("always")
        beat = myospring.simulate(own, integrator="quasi-static")
    # Those of the cell were said before.
    assert [str(one.message) for one in again] == [text for text in beat.warnings if text not in own.warnings]
    assert {one.filename for one in again} <= {__file__}


def test_a_beat_is_drawn(beat):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    axes = beat.plot()
    assert [one.get_ylabel() for one in axes][1:] == ["Tension (kPa)", "Shortening (%)"]


def test_the_wheel_carries_the_licences_of_all_that_it_is_made_of():
    """`cargo xtask licences` collects them before a wheel is made."""
    files = {Path(file).name: file for file in importlib.metadata.files("myospring")}
    assert {"LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt", "Noto-Sans-OFL.txt"} <= set(files)
    assert "SIL OPEN FONT LICENSE" in files["Noto-Sans-OFL.txt"].read_text()
    third = files["THIRD-PARTY.txt"].read_text()
    for name in ("uPlot, in report.html", "Noto Sans, in figures", "serde ", "clap "):
        assert f"\n{name}" in third, name


def test_the_program_is_the_same_one(run):
    assert run("--version").stdout.strip() == f"myospring {myospring.__version__}"


def test_the_program_gives_its_exit_code_and_heeds_ctrl_c(program, tmp_path):
    assert subprocess.run([program, "run", "nothing.toml"], capture_output=True, cwd=tmp_path).returncode == 2
    running = subprocess.Popen([program, "run", "--beats", "50", "--output", "long"], cwd=tmp_path,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    assert running.wait(timeout=20) in (-signal.SIGINT, 128 + signal.SIGINT)


DOCS = HERE.parents[1] / "docs"
# The one page on NumPy is run by `verification/python/read_results.py`, in the results that it reads.
PAGES = sorted(str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md") if "```python\n" in page.read_text() and page.name != "results.md")


# Those that take longest; what they call has tests of its own.
LEFT_TO_FULL = ("how-to/clusters.md", "how-to/films.md", "how-to/thick-cells.md")
ALL_CASES = "MYOSPRING_ALL_CASES" in os.environ


@pytest.mark.parametrize("page", [
    pytest.param(page, marks=pytest.mark.skipif(page in LEFT_TO_FULL and not ALL_CASES, reason="`cargo xtask test --full` runs it"))
    for page in PAGES
])
def test_the_python_of_a_page_runs(page, tmp_path):
    """The blocks of the page, one after the other, as one script."""
    for package in ("SALib", "distributed"):
        pytest.importorskip(package)
    page = (DOCS / page).read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    script = tmp_path / "script.py"
    # A file, which a worker may import: what it prints comes once.
    script.write_text("import matplotlib\nmatplotlib.use('agg')\n" + "\n".join(blocks))
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MPLCONFIGDIR": str(tmp_path)})
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Index(value=") <= 1


def test_the_example_of_a_study_runs_once_whatever_executor_follows(tmp_path):
    page = (DOCS / "how-to" / "clusters.md").read_text()
    first = re.search(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[1]
    script = tmp_path / "script.py"
    script.write_text(first.replace("size = 128", "size = 8") + """
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as executor:
        again = myospring.run_study(STUDY, executor)
    assert (again.metrics == result.metrics).all()
""")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Index(value=") == 1


def test_files_of_the_package_use_each_other_without_a_circle() -> None:
    folder = Path(myospring.__file__).parent
    uses = {
        path.stem: {
            node.module.split(".")[1]
            for node in ast.walk(ast.parse(path.read_text("utf-8")))
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("myospring.")
        }
        for path in folder.glob("_*.py")
    }
    assert "_cell" in uses["_beat"]
    # What uses nothing that is left goes, until nothing is left or only circles.
    while free := [name for name, used in uses.items() if not used & uses.keys()]:
        uses = {name: used for name, used in uses.items() if name not in free}
    assert not uses


def test_the_reference_names_everything():
    page = (DOCS / "reference" / "python.md").read_text()
    missing = [name for name in myospring.__all__ if not name.startswith("_") and f"`{name}" not in page]
    assert missing == []
