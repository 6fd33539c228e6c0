"""What Myokit (CVODE) makes of an extra stimulus after a train, for the tests: S1-S2 of all models with a potential.

usage: s1_s2_reference.py MYOKIT_OURS_JSON FOLDER_OF_CELLML FILE

The first is what `verification myokit FOLDER` writes, for the parameters and stimuli of the minimal model's sets
(equations: minimal_model.mmt); the CellML files are those of tor_ord_reference.py. FILE gets, for each S2 interval,
the diastolic interval, the duration of S2's action potential and its height over that of the last S1.

The train is ten S1 at 600 ms. Rest is the potential just before the last S1. The diastolic interval runs from 90 %
repolarisation of that S1 to S2; durations run from S2 to 90 % of the way from the peak of S2 back to that rest.
"""

import json
import pathlib
import sys
import warnings

import myokit
import myokit.formats
import numpy as np
from myokit_check import SLIDING, model_of
from tor_ord_reference import FORMS

BEATS, CYCLE_MS, AFTER_MS, EACH_MS = 10, 600.0, 600.0, 0.05
# From before the end of S1 to longer than the train's own interval.
INTERVALS_MS = {
    # Its ramp at rest makes CVODE slow.
    "coelho_2021": [340.0],
    "bueno_orovio_2008_m": [330.0, 400.0, 430.0, 460.0, 500.0, 800.0],
    "bueno_orovio_2008_pb": [330.0, 400.0, 430.0, 460.0, 500.0, 800.0],
    "tor_ord_endo": [255.0, 310.0, 450.0],
    "tor_ord_dyn_cl_endo": [255.0, 310.0, 450.0],
    "": [200.0, 255.0, 310.0, 330.0, 360.0, 450.0, 800.0],
}


def course(simulation, names, starts, amplitude, pulse_ms, end_ms):
    """Potential over time; at a stimulus CVODE starts anew, and a jump moves the state between two runs."""
    simulation.reset()
    if pulse_ms > 0:
        protocol = myokit.Protocol()
        for start in starts:
            protocol.schedule(amplitude, start, pulse_ms)
        simulation.set_protocol(protocol)
    times, values, now = [], [], 0.0
    for stop in [*(starts if pulse_ms == 0 else []), end_ms]:
        if stop > now:
            log = simulation.run(stop - now, log=names, log_interval=EACH_MS)
            times.append(np.array(log[names[0]]))
            values.append(np.array(log[names[1]]))
        if stop < end_ms:
            state = simulation.state()
            state[0] += amplitude
            simulation.set_state(state)
        now = stop
    return np.concatenate(times), np.concatenate(values)


def falls(time, values, level):
    """When values fall through a level after their highest; NaN where they do not."""
    top = int(np.argmax(values))
    below = np.nonzero(values[top:] <= level)[0]
    if len(below) == 0:
        return float("nan")
    last = top + below[0] - 1
    part = (values[last] - level) / (values[last] - values[last + 1])
    return time[last] + part * (time[last + 1] - time[last])


def row(time, values, s1, s2):
    """Diastolic interval, duration of S2, its height over that of S1."""
    rest = values[time < s1 - 1e-6][-1]
    first = (time >= s1) & (time < s2 - 1e-6)
    second = time >= s2
    height = values[first].max() - rest
    diastolic = s2 - falls(time[first], values[first], rest + 0.1 * height)
    peak = values[second].max() - rest
    duration = falls(time[second], values[second], rest + 0.1 * peak) - s2
    return [diastolic, duration, peak / height]


def cases(ours, cellml):
    """Name, model, name of the potential, size and duration of the stimulus."""
    listed = {case["model"]: case for case in json.loads(pathlib.Path(ours).read_text())}
    for name in sorted(listed, key=lambda name: name in SLIDING):
        case = listed[name]
        model = model_of(case, 1e-5 if name in SLIDING else 0.0)
        yield name, model, "cell.u", case["amplitude"], case["pulse_ms"]
    for form, file in FORMS.items():
        model = myokit.formats.importer("cellml").model(str(pathlib.Path(cellml, f"{file}.cellml")))
        stimulus = model.get("membrane.Istim")
        stimulus.set_rhs(0)
        stimulus.set_binding("pace")
        yield f"tor_ord_{form}endo", model, "membrane.v", -53.0, 1.0


def main(ours, cellml, target):
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    lines = ["model,s2_interval_ms,diastolic_interval_ms,apd90_ms,height_over_s1"]
    for name, model, potential, amplitude, pulse_ms in cases(ours, cellml):
        names = [model.timex().qname(), potential]
        simulation = myokit.Simulation(model)
        tolerance = 1e-7 if name in SLIDING else 1e-9
        simulation.set_tolerance(tolerance, tolerance)
        for interval in INTERVALS_MS.get(name, INTERVALS_MS[""]):
            # A stimulus at 0 ms would begin before the first sample.
            starts = [10.0 + beat * CYCLE_MS for beat in range(BEATS)]
            starts.append(starts[-1] + interval)
            found = course(simulation, names, starts, amplitude, pulse_ms, starts[-1] + AFTER_MS)
            numbers = row(*found, *starts[-2:])
            lines.append(f"{name},{interval:g}," + ",".join(f"{number:.6g}" for number in numbers))
            print(lines[-1], flush=True)
    pathlib.Path(target).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:4])
