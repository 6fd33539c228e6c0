"""Repeats in Myokit (CVODE) the beats that `verification myokit FOLDER` wrote, and compares all states.

usage: myokit_check.py FOLDER [REFERENCE]

SUNDIALS_PREFIX names where SUNDIALS is, if not in a usual place. REFERENCE names a file to write CVODE's
states every 10 ms of one beat to; the Rust tests compare with verification/reference/myokit.csv, made so.

The equations are in minimal_model.mmt, written from the papers; parameters come from our listing.
CVODE runs at tolerance 1e-10. Steps of the right-hand side (Heaviside's H) are met by its error test,
which shortens the step at each; stimuli are events at which it starts anew: pulses by Myokit's
protocol, a jump of u by setting the state between two runs. The sliding mode at rest of coelho_2021 is
met by a ramp in place of the step at theta_w (see minimal_model.mmt). How exact this reference is
itself is measured: the same with tolerance 1e-8 and a ramp ten times wider.
"""

import json
import os
import pathlib
import shutil
import sys
import warnings

import numpy as np
import rows

STATES = ["u", "v", "w", "s", "Ta_i", "Ta"]
SLIDING = {"coelho_2021"}


def sundials():
    """Include and library folders of SUNDIALS, or None."""
    named = os.environ.get("SUNDIALS_PREFIX")
    for prefix in [named] if named else ["/usr", "/usr/local", "/opt/local", "/opt/homebrew"]:
        include = pathlib.Path(prefix, "include")
        if not (include / "cvodes" / "cvodes.h").exists():
            continue
        libraries = sorted(pathlib.Path(prefix).glob("lib*/libsundials_cvodes.*"))
        libraries += sorted(pathlib.Path(prefix).glob("lib*/*/libsundials_cvodes.*"))
        if libraries:
            return include, libraries[0].parent
    return None


def model_of(case, ramp):
    """The model of a case, its ramp at theta_w so wide in u."""
    import myokit

    parameters = "\n".join(f"{name} = {value!r}" for name, value in case["parameters"].items())
    step = "if(u < p.theta_w, 0, 1)"
    if ramp:
        step = f"if(u < p.theta_w - {ramp!r} / 2, 0, if(u > p.theta_w + {ramp!r} / 2, 1, (u - p.theta_w) / {ramp!r} + 0.5))"
    text = pathlib.Path(__file__).with_name("minimal_model.mmt").read_text()
    for key, value in {"parameters": parameters, "h_w": step, "ramp": repr(ramp)}.items():
        text = text.replace("{" + key + "}", value)
    model = myokit.parse(text)[0]
    model.validate()
    return model


def beats_of(case, simulation, tolerance):
    """States at the case's samples, one row per state."""
    starts = [case["start_ms"] + n * case["cycle_length_ms"] for n in range(case["beats"])]
    times = np.array(case["time_ms"])
    names = [f"cell.{name}" for name in STATES[:4]] + [f"tension.{name}" for name in STATES[4:]]
    simulation.reset()
    simulation.set_tolerance(tolerance, tolerance)
    # From event to event; a jump of u is made between two runs.
    stops = (starts if case["pulse_ms"] == 0 else []) + [times[-1] + 0.5]
    columns, now = [], 0.0
    for stop in stops:
        wanted = times[(times >= now) & (times < stop)]
        log = simulation.run(stop - now, log=names, log_times=wanted)
        columns.append(np.array([log[name] for name in names]))
        state = simulation.state()
        state[0] += case["amplitude"]
        simulation.set_state(state)
        now = stop
    found = np.concatenate(columns, axis=1)
    if found.shape[1] != len(times):
        raise RuntimeError(f"Myokit logged {found.shape[1]} samples of {len(times)}")
    return found


def reference(case):
    """CVODE's states, and how far they move with a coarser tolerance and ramp."""
    import myokit

    ramp = 1e-7 if case["model"] in SLIDING else 0.0
    protocol = None
    if case["pulse_ms"] > 0:
        protocol = myokit.Protocol()
        period = case["cycle_length_ms"] if case["beats"] > 1 else 0
        beats = case["beats"] if case["beats"] > 1 else 0
        protocol.schedule(case["amplitude"], case["start_ms"], case["pulse_ms"], period, beats)
    found = []
    for tolerance, width in [(1e-10, ramp), (1e-8, 10.0 * ramp)]:
        simulation = myokit.Simulation(model_of(case, width), protocol)
        found.append(beats_of(case, simulation, tolerance))
    return found


def worst(a, b, size):
    """The largest difference of any state over that state's size, and its name."""
    by_state = np.abs(np.array(a) - np.array(b)).max(axis=1) / size
    place = int(np.argmax(by_state))
    return float(by_state[place]), STATES[place]


def main(folder, reference_file=None):
    what = "six sets of the minimal model, all states, one beat and trains at 1 Hz"
    try:
        import myokit
    except ImportError as error:
        missing = f"Myokit does not load: {error}; `pip install -r verification/requirements.txt`"
        return [rows.skipped(what, "Myokit", missing)]
    found = sundials()
    if found is None:
        where = "in SUNDIALS_PREFIX" if "SUNDIALS_PREFIX" in os.environ else "in the usual places"
        missing = (
            f"no SUNDIALS {where} (include/cvodes/cvodes.h and libsundials_cvodes); Debian, Ubuntu: "
            "`apt-get install libsundials-dev`; macOS: `brew install sundials`; or set SUNDIALS_PREFIX"
        )
        return [rows.skipped(what, f"Myokit {myokit.__version__}", missing)]
    if not any(shutil.which(compiler) for compiler in ("cc", "gcc", "clang")):
        missing = "no C compiler, with which Myokit builds its simulations; Debian: `apt-get install gcc`"
        return [rows.skipped(what, f"Myokit {myokit.__version__}", missing)]
    myokit.SUNDIALS_INC, myokit.SUNDIALS_LIB = [str(found[0])], [str(found[1])]
    warnings.simplefilter("ignore")
    table = []
    lines = ["model,t_ms,u,v,w,s,Ta_i,Ta"]
    for case in json.loads(pathlib.Path(folder, "myokit-ours.json").read_text()):
        exact, coarse = reference(case)
        size = np.abs(exact).max(axis=1)
        if case["beats"] == 1:
            for place in range(0, len(case["time_ms"]), 10):
                values = ",".join(f"{value:.9g}" for value in exact[:, place])
                lines.append(f"{case['model']},{case['time_ms'][place]},{values}")
        own, _ = worst(coarse, exact, size)
        kind = "one beat" if case["beats"] == 1 else f"{case['beats']} beats at 1 Hz"
        for ours in case["solutions"]:
            largest, state = worst(ours["states"], exact, size)
            table.append(
                rows.difference(
                    f"{case['model']}, {kind}, {ours['name']}: worst sample of the worst of six states ({state})",
                    f"Myokit {myokit.__version__}, CVODE of SUNDIALS {myokit.Sundials.version()}, tolerance 1e-10",
                    largest,
                    ours["tolerance"],
                    "of the state's largest value",
                    f"{ours['reason']}; the reference itself moves by {own:.0e} with tolerance 1e-8 and a wider ramp",
                )
            )
    if reference_file:
        pathlib.Path(reference_file).write_text("\n".join(lines) + "\n")
    return table


if __name__ == "__main__":
    rows.write(sys.argv[1], "myokit", main(*sys.argv[1:3]))
