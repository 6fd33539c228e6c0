"""Python and the program give the same numbers, digit for digit."""

from __future__ import annotations

import csv
import json
import pickle

import numpy as np
import pytest

import myospring


def metrics(folder):
    """The numbers of each beat that the program has written."""
    summary = json.loads((folder / "summary.json").read_text())
    beats = []
    for beat in summary["beats"]:
        parts = (beat[part] for part in ("tension", "contraction", "shape", "action_potential"))
        beats.append({metric["name"]: metric["value"] for part in parts for metric in part})
    return beats


@pytest.mark.parametrize(
    ("settings", "options"),
    [
        ({"integrator": "quasi-static"}, ["--integrator", "quasi-static"]),
        ({"duration_ms": 150.0}, ["--duration", "150 ms"]),
        (
            {"integrator": "quasi-static", "model": "bueno_orovio_2008_epi", "peak_tension_kpa": 37.3, "beats": 2,
             "cycle_length_ms": 450, "support": "elastic-bed", "bed_stiffness_kpa_per_um": 0.1 + 0.2},
            ["--integrator", "quasi-static", "--model", "bueno_orovio_2008_epi", "--peak-tension", "37.3 kPa", "--beats",
             "2", "--cycle-length", "450 ms", "--support", "elastic-bed", "--bed-stiffness",
             "0.30000000000000004 kPa/um"],
        ),
    ],
)
def test_a_beat_has_the_programs_numbers_to_the_digits_of_its_files(cell, run, tmp_path, settings, options):
    run("run", "--spacing", "4 um", *options, "--outputs", "none", "--output", "beat", cwd=tmp_path)
    beat = myospring.simulate(cell, **settings)
    saved = beat.save(tmp_path / "saved", outputs=[])
    assert (saved / "traces.csv").read_bytes() == (tmp_path / "beat" / "traces.csv").read_bytes()
    with open(saved / "traces.csv") as file:
        rows = list(csv.DictReader(file))
    for name, column in [("t_ms", "t_ms"), ("ta_kpa", "ta_kPa"), ("length_um", "length_um")]:
        # The file has fewer digits than the array.
        np.testing.assert_allclose(getattr(beat, name), [float(row[column]) for row in rows], rtol=0, atol=1e-5)
    beats = metrics(tmp_path / "beat")
    expected = [{name: np.nan if value is None else value for name, value in one.items()} for one in beats]
    assert len(beat.metrics_by_beat) == len(expected)
    for own, written in zip(beat.metrics_by_beat, expected):
        assert own.keys() == written.keys()
        # The file has seven digits.
        rounded = [float(f"{value:.7g}") for value in own.values()]
        np.testing.assert_array_equal(rounded, list(written.values()))


def test_a_number_that_cannot_be_read_is_none_with_its_reason(cell):
    beat = myospring.simulate(cell, duration_ms=150.0, integrator="quasi-static")
    assert np.isnan(beat.metrics["relaxation_time_90"])
    assert beat.missing["relaxation_time_90"] == "the curve does not reach that level within the beat"
    assert set(beat.missing) == {name for name, value in beat.metrics.items() if np.isnan(value)}


def test_saved_results_are_the_programs_files(beat, run, tmp_path):
    folder = beat.save(tmp_path / "saved", outputs=["vtu", "frames"])
    run("run", "--spacing", "4 um", "--integrator", "quasi-static", "--outputs", "vtu,frames", "--output", "beat",
        cwd=tmp_path)
    files = {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}
    other = tmp_path / "beat"
    assert files == {path.relative_to(other) for path in other.rglob("*") if path.is_file()}
    # Times of the clock, and the hash of the file that has them.
    for name in (name for name in files if name.name not in ("run.json", "myospring.sha256")):
        assert (folder / name).read_bytes() == (other / name).read_bytes(), name
    with pytest.raises(OSError, match="already holds files"):
        beat.save(folder)
    beat.save(folder, force=True, outputs=[])
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(OSError, match="did not write, or that were changed since: notes.txt"):
        beat.save(folder, force=True)
    assert (folder / "notes.txt").read_text(encoding="utf-8") == "mine"


def test_arrays_have_the_shapes_that_are_stated(cell, beat):
    samples, frames, nodes = beat.t_ms.size, beat.frame_t_ms.size, cell.positions.shape[0]
    assert beat.shortening_pct.shape == beat.ta_kpa.shape == beat.u.shape == (samples,)
    assert beat.positions.shape == (frames, nodes, 2)
    assert beat.triangles.shape[1] == 3 and beat.triangles.max() == nodes - 1
    assert beat.fibres.shape == (len(beat.triangles), 2)
    np.testing.assert_allclose(np.hypot(*beat.fibres.T), 1.0)
    assert beat.positions is beat.positions and not beat.positions.flags.writeable
    assert list(beat.to_dataframe().columns)[0] == "t_ms"
    assert list(beat.metrics) == list(beat.units) == [name for name in myospring.METRICS if name in beat.metrics]


def test_a_beat_has_every_metric_there_is_but_those_of_held_ends_s2_and_own_rhythm_where_there_are_none(cell, beat):
    # Only cells that beat by themselves have these.
    rhythm = {"spontaneous_cycle_length", "lowest_diastolic_potential", "diastolic_depolarisation_rate"}
    held = myospring.simulate(cell, integrator="quasi-static", support="clamped-ends", s2_interval_ms=500)
    gel = {"peak_traction_force", "time_to_peak_traction_force", "traction_relaxation_time_50",
           "peak_axial_force", "peak_contractile_moment", "peak_gel_energy"}
    thick = {"thickness_at_rest", "peak_thickening", "volume_change", "top_shortening", "bottom_shortening"}
    tissue = {"conduction_velocity", "activation_time", "activated_part", "local_action_potential_duration_90",
              "repolarisation_spread", "rotation_period", "tip_drift"}
    assert set(held.metrics) == set(myospring.METRICS) - rhythm - gel - thick - tissue
    assert held.metrics["coupling_interval"] == 500
    free = {"end_force_at_rest", "peak_end_force", "time_to_peak_end_force", "end_systolic_force",
            "end_systolic_length", "time_to_end_systole", "work_on_load"}
    alone = {"coupling_interval", "diastolic_interval", "relative_peak_tension", "relative_peak_shortening"}
    assert set(beat.metrics) == set(myospring.METRICS) - free - alone - rhythm - gel - thick - tissue
    assert 1000 < held.metrics["peak_end_force"] < 20000


def test_a_thick_cell_thickens_as_it_shortens_and_keeps_its_volume(beat):
    made = myospring.Cell.builtin(profile="dome", thickness_um=8, spacing_um=2)
    thick = myospring.simulate(made)
    assert abs(thick.metrics["peak_shortening"] - 12.0) < 0.05
    assert abs(thick.metrics["peak_thickening"] - 6.43) < 0.05
    assert abs(thick.metrics["volume_change"]) < 0.5
    points = thick.positions_in_space
    assert points.shape[0] == thick.frame_t_ms.size and points.shape[2] == 3
    assert points[0, :, 2].min() == 0 and abs(points[0, :, 2].max() - 8) < 1e-9
    assert beat.positions_in_space is None
    with pytest.raises(ValueError, match="meshed with 8 um"):
        myospring.simulate(made, thickness_um=6)


def test_a_tissue_says_when_each_place_is_activated(beat):
    strip = myospring.Cell.builtin("tissue_strip", spacing_um=150)
    wave = myospring.simulate(strip, model="bueno_orovio_2008_epi", conduction_velocity_um_per_ms=300, duration_ms=120)
    assert abs(wave.metrics["conduction_velocity"] - 30) < 0.2
    assert wave.metrics["activated_part"] == 100
    times = wave.activation_ms
    assert times.shape == (strip.positions.shape[0],) and not times.flags.writeable
    assert abs(times.max() - wave.metrics["activation_time"]) < 1e-9
    assert np.isnan(wave.local_action_potential_duration_90_ms).all()  # The run ends before.
    assert np.array_equal(pickle.loads(pickle.dumps(wave)).activation_ms, times)
    assert wave.wave_tips.shape == (0, 3)  # A plane wave.
    assert wave.potentials.shape == wave.positions.shape[:2]
    assert wave.potentials.max() > 0 > wave.potentials.min()
    assert beat.activation_ms is None and beat.wave_tips is None and beat.potentials is None


def test_a_cell_pulls_on_its_gel_with_the_forces_that_its_curves_add_up(cell, beat):
    assert beat.forces_on_gel is None
    pulling = myospring.simulate(cell, support="gel", gel_modulus_kpa=10, adhesion="rim")
    forces = pulling.forces_on_gel
    assert forces.shape == pulling.positions.shape
    at = np.searchsorted(pulling.t_ms, pulling.frame_t_ms)
    total = np.hypot(*np.moveaxis(forces, 2, 0)).sum(axis=1)
    np.testing.assert_allclose(total, pulling.to_dataframe()["traction_force"].to_numpy()[at], rtol=1e-4, atol=1e-6)
    assert 500 < pulling.metrics["peak_axial_force"] < pulling.metrics["peak_traction_force"] < 5000
    # Nothing outside moves the gel.
    assert np.abs(forces.sum(axis=1)).max() < 1e-6 * total.max()


def test_on_a_gel_a_table_says_where_the_cell_adheres_and_an_integrator_that_is_stated_is_taken(cell, tmp_path):
    table = tmp_path / "adhesions.csv"
    table.write_text("x_um,y_um,adhesion\n0,0,0.5\n")
    gel = {"support": "gel", "gel_modulus_kpa": 10}
    by_table = myospring.simulate(cell, **gel, adhesion=table, adhesion_stiffness_kpa_per_um=4)
    softer = myospring.simulate(cell, **gel, adhesion_stiffness_kpa_per_um=2)
    np.testing.assert_allclose(by_table.length_um, softer.length_um, rtol=1e-5)
    assert "integrator = \"quasi-static\"" in softer.run_file
    # A stimulus at once, and no more than the start of the beat: each step in time solves for the gel.
    start = {"stimulus_start_ms": 0, "duration_ms": 1}
    in_time = myospring.simulate(cell, **gel, **start, integrator="verlet")
    assert "integrator = \"verlet\"" in in_time.run_file


def test_parameters_of_a_model_change_its_action_potential():
    published = myospring.action_potential("coelho_2021")
    tau = myospring.parameters("coelho_2021")["tau_si"]
    longer = myospring.action_potential("coelho_2021", {"tau_si": 0.9 * tau.value}, cell_integrator="adaptive")
    name = "action_potential_duration_90"
    assert longer.metrics[name] > published.metrics[name] + 5
    assert published.t_ms.shape == published.potential.shape == published.tension.shape
