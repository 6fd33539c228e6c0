"""The schemas that editors use: what the program takes passes, what it refuses does not."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

jsonschema = pytest.importorskip("jsonschema")
tomllib = pytest.importorskip("tomllib")

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def schemas(program):
    def schema(kind):
        return json.loads(subprocess.run([program, "schema", kind], check=True, capture_output=True).stdout)

    made = {kind: schema(kind) for kind in ("run", "study")}
    return {kind: jsonschema.Draft202012Validator(schema) for kind, schema in made.items()}


def mistakes(validator, text):
    return [error.message for error in validator.iter_errors(tomllib.loads(text))]


def test_all_that_comes_with_the_project_passes(schemas, run):
    files = [*ROOT.glob("examples/*.toml"), *ROOT.glob("crates/myospring/presets/*.toml")]
    for file in files:
        assert mistakes(schemas["run"], file.read_text()) == [], file
    for file in ROOT.glob("examples/studies/*.toml"):
        assert mistakes(schemas["study"], file.read_text()) == [], file
    assert mistakes(schemas["run"], run("init").stdout) == []
    assert mistakes(schemas["study"], run("study", "init").stdout) == []


@pytest.mark.parametrize("size", ["10 um", "10um", "10 µm", "10 \u03bcm", "1e1 um", "0.01 mm", "10 microns", " 10 um "])
def test_a_quantity_passes_however_the_program_reads_it(schemas, size):
    assert mistakes(schemas["run"], f'[material]\nthickness = "{size}"') == []


@pytest.mark.parametrize(
    "text",
    [
        '[material]\nthickness = "50"',
        '[material]\nthickness = "50 kPa"',
        '[material]\nthickness = "0,5 um"',
        '[material]\nthicknes = "5 um"',
        '[cell]\nmodel = "land"',
        '[shape]\nbuilt_in = "ventricle"',
    ],
)
def test_what_the_program_refuses_does_not_pass(schemas, text):
    assert mistakes(schemas["run"], text)
    study = text.replace("[", "[run.") + '\n[sampling]\nsampler = "latin-hypercube"\nsize = 3'
    assert mistakes(schemas["study"], study)


@pytest.mark.parametrize(
    "text",
    [
        'kind = "beat"',
        '[sampling]\nsampler = "morris"\nsize = 3',
        '[sampling]\nsampler = "sobol"\nsize = 3',
        '[parameters]\nc_0 = { distribution = "uniform", low = 1 }\n[sampling]\nsampler = "grid"\nlevels = 3',
    ],
)
def test_a_study_that_cannot_be_does_not_pass(schemas, text):
    assert mistakes(schemas["study"], text)


def test_a_file_that_is_begun_names_its_schema_which_lies_beside_it(run, tmp_path):
    run("init", "beat.toml", cwd=tmp_path)
    run("study", "init", "study.toml", cwd=tmp_path)
    for file in ("beat.toml", "study.toml"):
        first = (tmp_path / file).read_text().splitlines()[0]
        assert first.startswith("#:schema ")
        assert json.loads((tmp_path / first.removeprefix("#:schema ")).read_text())["$id"].startswith("urn:myospring:")
    # A file of that name that is no schema of ours stays.
    (tmp_path / "myospring-run.schema.json").write_text("mine")
    run("init", "other.toml", cwd=tmp_path)
    assert (tmp_path / "myospring-run.schema.json").read_text() == "mine"
