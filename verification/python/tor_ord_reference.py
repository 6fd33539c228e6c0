"""What Myokit makes of the CellML files of ToR-ORd, for the tests: rates of all states, and beats.

usage: tor_ord_reference.py FOLDER_OF_CELLML RATES BEATS

The files ToRORd_fkatp_endo.cellml and ToRORd_dynCl_endo.cellml are those of https://github.com/jtmff/torord
(GPL-3; only numbers come from them). RATES gets states along one beat with their rates, without stimulus; epi and
mid by the file's own switch `celltype`. BEATS gets the action potential and calcium of the 100th beat at 1 Hz, CVODE
at tolerance 1e-8, the file's stimulus (-53 A/F for 1 ms) as events at which it starts anew.
"""

import pathlib
import sys
import warnings

import myokit
import myokit.formats
import numpy as np

FORMS = {"": "ToRORd_fkatp_endo", "dyn_cl_": "ToRORd_dynCl_endo"}
CELLS = ["endo", "epi", "mid"]
# Ours, in our order, and theirs.
NAMES = """v membrane.v
Na_i intracellular_ions.nai
Na_ss intracellular_ions.nass
K_i intracellular_ions.ki
K_ss intracellular_ions.kss
Ca_cyt intracellular_ions.cai
Ca_ss intracellular_ions.cass
Ca_nsr intracellular_ions.cansr
Ca_jsr intracellular_ions.cajsr
CaMK_t CaMK.CaMKt
J_rel_np ryr.Jrel_np
J_rel_p ryr.Jrel_p
n_ss ICaL.nca_ss
n_i ICaL.nca_i
C0 IKr.C3
C1 IKr.C2
C2 IKr.C1
O IKr.O
I IKr.I
m INa.m
h INa.h
j INa.j
h_p INa.hp
j_p INa.jp
m_L INaL.mL
h_L INaL.hL
h_L_p INaL.hLp
a Ito.a
i_F Ito.iF
i_S Ito.iS
a_p Ito.ap
i_F_p Ito.iFp
i_S_p Ito.iSp
d ICaL.d
f_f ICaL.ff
f_s ICaL.fs
f_Ca_f ICaL.fcaf
f_Ca_s ICaL.fcas
j_Ca ICaL.jca
f_f_p ICaL.ffp
f_Ca_f_p ICaL.fcafp
x_s1 IKs.xs1
x_s2 IKs.xs2
Cl_i intracellular_ions.cli
Cl_ss intracellular_ions.clss"""
NAMES = [line.split() for line in NAMES.splitlines()]
SAMPLES_MS = [0.0, 0.7, 2.0, 9.0, 70.0, 230.0, 320.0]
BEATS = 100


def main(folder, rates_file, beats_file):
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    rates = ["model,sample_ms,state,value,rate"]
    beats = ["model,apd90_ms,peak_mV,rest_mV,calcium_least_nM,calcium_most_nM,calcium_peak_ms"]
    for form, file in FORMS.items():
        model = myokit.formats.importer("cellml").model(str(pathlib.Path(folder, f"{file}.cellml")))
        states = [state.qname() for state in model.states()]
        stimulus = model.get("membrane.Istim")
        stimulus.set_rhs(0)
        stimulus.set_binding("pace")
        protocol = myokit.Protocol()
        protocol.schedule(-53, 0, 1, 1000, 0)
        simulation = myokit.Simulation(model, protocol)
        simulation.set_tolerance(1e-8, 1e-8)
        for number, cell in enumerate(CELLS):
            name = f"tor_ord_{form}{cell}"
            simulation.reset()
            simulation.set_constant("environment.celltype", number)
            model.get("environment.celltype").set_rhs(number)
            log = simulation.run(700, log=states, log_times=SAMPLES_MS)
            for place, time in enumerate(SAMPLES_MS):
                state = [log[qname][place] for qname in states]
                found = model.evaluate_derivatives(state, inputs={"time": 500.0, "pace": 0.0}, ignore_errors=True)
                for ours, theirs in NAMES:
                    if theirs in states:
                        at = states.index(theirs)
                        rates.append(f"{name},{time},{ours},{state[at]!r},{found[at]:.13g}")
            if cell != "endo":
                continue  # the files start as endo does
            simulation.reset()
            simulation.run(1000 * (BEATS - 1), log=myokit.LOG_NONE)
            keys = ["environment.time", "membrane.v", "intracellular_ions.cai"]
            log = simulation.run(1000, log=keys, log_interval=0.02)
            time, v, calcium = (np.array(log[key]) for key in keys)
            time = time - 1000 * (BEATS - 1)
            beats.append(f"{name},{beat(time, v, calcium)}")
            print(beats[-1], flush=True)
    pathlib.Path(rates_file).write_text("\n".join(rates) + "\n")
    pathlib.Path(beats_file).write_text("\n".join(beats) + "\n")


def beat(time, v, calcium):
    """Duration from the stimulus to 90 % of repolarisation, and what else the table has."""
    rest, peak = v[0], v.max()
    level = peak - 0.9 * (peak - rest)
    last = np.nonzero(v > level)[0][-1]
    part = (v[last] - level) / (v[last] - v[last + 1])
    end = time[last] + part * (time[last + 1] - time[last])
    top = np.argmax(calcium)
    numbers = [end, peak, rest, 1e6 * calcium.min(), 1e6 * calcium.max(), time[top]]
    return ",".join(f"{number:.6g}" for number in numbers)


if __name__ == "__main__":
    main(*sys.argv[1:4])
