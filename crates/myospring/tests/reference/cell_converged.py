"""Converged beats of the six parameter sets, for crates/myospring/tests/model/cell_adaptive.rs.

Independent of Myospring: SciPy's DOP853 (relative tolerance 1e-11, absolute 1e-13) between the switches
of the equations, which SciPy's event location finds; where du/dt points at theta_w or theta_o from
both sides, u is held there and the other rates are Filippov's mixture.

    pip install numpy scipy
    python cell_converged.py > cell_converged.csv
"""
import math
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

NAMES = """u_o u_u theta_v theta_w theta_v_minus theta_o tau_v1_minus tau_v2_minus tau_v_plus
tau_w1_minus tau_w2_minus k_w_minus u_w_minus tau_w_plus tau_fi tau_o1 tau_o2 tau_so1 tau_so2 k_so u_so
tau_s1 tau_s2 k_s u_s tau_si tau_winf w_inf_star u_peak""".split()
VALUES = {
    "coelho_2021": [0.529297, 1.74316, 0.0673828, 0.00195313, 0.0976563, 0.932618, 57.7148, 1101.56,
        1.96973, 62.9688, 13.9648, 58.0469, 0.59668, 273.633, 0.644532, 477.344, 14.1992, 25.4492,
        0.253711, 2.49609, 0.657227, 2.36621, 11.4453, 2.25586, 0.903321, 1.76816, 0.785157, 0.500977,
        1.13407],
    "bueno_orovio_2008_epi": [0, 1.55, .3, .13, .006, .006, 60, 1150, 1.4506, 60, 15, 65, .03, 200, .11,
        400, 6, 30.0181, .9957, 2.0458, .65, 2.7342, 16, 2.0994, .9087, 1.8875, .07, .94, 1.464],
    "bueno_orovio_2008_endo": [0, 1.56, .3, .13, .2, .006, 75, 10, 1.4506, 6, 140, 200, .016, 280, .1,
        470, 6, 40, 1.2, 2, .65, 2.7342, 2, 2.0994, .9087, 2.9013, .0273, .78, 1.506],
    "bueno_orovio_2008_m": [0, 1.61, .3, .13, .1, .005, 80, 1.4506, 1.4506, 70, 8, 200, .016, 280, .078,
        410, 7, 91, .8, 2.1, .6, 2.7342, 4, 2.0994, .9087, 3.3849, .01, .5, 1.552],
    "bueno_orovio_2008_pb": [0, 1.45, .35, .13, .175, .006, 10, 1150, 1.4506, 140, 6.25, 65, .015, 326,
        .105, 400, 6, 30.0181, .9957, 2.0458, .65, 2.7342, 16, 2.0994, .9087, 1.8875, .175, .9, 1.370],
    "bueno_orovio_2008_tnnp": [0, 1.58, .3, .015, .015, .006, 60, 1150, 1.4506, 70, 20, 65, .03, 280, .11,
        6, 6, 43, .2, 2, .65, 2.7342, 3, 2.0994, .9087, 2.8723, .07, .94, 1.487],
}
C_0, X_1, X_2, X_3, SIGMA = 0.0166016, 0.0001, 0.78, 0.2925, 0.046875
THRESHOLDS = ["theta_v", "theta_w", "theta_v_minus", "theta_o", "theta_x"]


def rates(y, p, above, late, stimulus):
    """d(state)/dt with every Heaviside step given: `above` by threshold, `late` for Ta_i > x_3."""
    u, v, w, s, ta_i, ta = y
    v_inf, tau_v = (0.0, p["tau_v2_minus"]) if above["theta_v_minus"] else (1.0, p["tau_v1_minus"])
    fast = 0.0
    v_rate = (v_inf - v) / tau_v
    if above["theta_v"]:
        fast = -v * (u - p["theta_v"]) * (p["u_u"] - u) / p["tau_fi"]
        v_rate = -v / p["tau_v_plus"]
    if above["theta_w"]:
        mix = (1 + math.tanh(p["k_so"] * (u - p["u_so"]))) / 2
        outward = 1 / (p["tau_so1"] + (p["tau_so2"] - p["tau_so1"]) * mix)
        slow = -w * s / p["tau_si"]
        w_rate, tau_s = -w / p["tau_w_plus"], p["tau_s2"]
    else:
        mix = (1 + math.tanh(p["k_w_minus"] * (u - p["u_w_minus"]))) / 2
        tau_w = p["tau_w1_minus"] + (p["tau_w2_minus"] - p["tau_w1_minus"]) * mix
        outward = (u - p["u_o"]) / (p["tau_o2"] if above["theta_o"] else p["tau_o1"])
        slow = 0.0
        w_inf = p["w_inf_star"] if above["theta_o"] else 1 - u / p["tau_winf"]
        w_rate, tau_s = (w_inf - w) / tau_w, p["tau_s1"]
    s_rate = ((1 + math.tanh(p["k_s"] * (u - p["u_s"]))) / 2 - s) / tau_s
    z = (u / p["u_peak"] - 1) / SIGMA
    bell = math.exp(-z * z / 2) / (SIGMA * math.sqrt(2 * math.pi))
    epsilon = X_1 if above["theta_x"] and not late else C_0
    return [stimulus - fast - outward - slow, v_rate, w_rate, s_rate, C_0 * (bell - ta_i),
            epsilon * (ta_i - ta)]


def mixture(y, p, above, late, stimulus, held):
    low = rates(y, p, {**above, held: False}, late, stimulus)
    high = rates(y, p, {**above, held: True}, late, stimulus)
    part = low[0] / (low[0] - high[0])
    return [0.0] + [a + part * (b - a) for a, b in zip(low[1:], high[1:])], low[0], high[0]


def stretch(y, t, end, p, stimulus, curves):
    """From t to end, at constant stimulus; the solution's pieces are added to `curves`."""
    above = {name: y[0] > p[name] for name in THRESHOLDS}
    late, held = y[4] > X_3, None
    on = [name for name in THRESHOLDS if y[0] == p[name]]
    while True:
        for name in on:  # u stands on this threshold: which way?
            low = rates(y, p, {**above, name: False}, late, stimulus)[0]
            high = rates(y, p, {**above, name: True}, late, stimulus)[0]
            held = name if low > 0 > high else None
            above[name] = high > 0
        if held:
            f = lambda t, y: mixture(y, p, above, late, stimulus, held)[0]
            events = [lambda t, y: mixture(y, p, above, late, stimulus, held)[1],
                      lambda t, y: mixture(y, p, above, late, stimulus, held)[2]]
            targets = ["below", "above"]
        else:
            f = lambda t, y: rates(y, p, above, late, stimulus)
            events, targets = [], []
            for name in THRESHOLDS:
                event = lambda t, y, name=name: y[0] - p[name]
                event.direction = -1 if above[name] else 1
                events.append(event)
                targets.append(name)
        event = lambda t, y: y[4] - X_3
        event.direction = -1 if late else 1
        events.append(event)
        targets.append("onset")
        for event in events:
            event.terminal = True
        r = solve_ivp(f, (t, end), y, "DOP853", events=events, rtol=1e-11, atol=1e-13, dense_output=True,
                      max_step=5.0)
        curves.append((t, r.t[-1], r.sol))
        t, y = r.t[-1], list(r.y[:, -1])
        if r.status == 0:
            return y
        hit = next(name for name, times in zip(targets, r.t_events) if len(times))
        on = []
        if hit == "onset":
            y[4], late = X_3, not late
        elif held:
            above[held], held = hit == "above", None
        else:
            y[0], on = p[hit], [hit]


def peak(curves, k):
    """Highest value of a variable, and when: golden section around the best of a fine grid."""
    best = (-1.0, 0.0)
    for a, b, sol in curves:
        n = max(4, int((b - a) / 0.05))
        grid = [a + (b - a) * i / n for i in range(n + 1)]
        i = max(range(n + 1), key=lambda i: sol(grid[i])[k])
        low, high = grid[max(i - 1, 0)], grid[min(i + 1, n)]
        for _ in range(60):
            c, d = high - (high - low) * 0.6180339887498949, low + (high - low) * 0.6180339887498949
            if sol(c)[k] < sol(d)[k]:
                low = c
            else:
                high = d
        best = max(best, *[(sol(x)[k], x) for x in (low, high, a, b)])
    return best


def train(name, cycle, beats=5, start=50.0):
    p = dict(zip(NAMES, VALUES[name]))
    p["theta_x"] = X_2 * p["u_peak"]
    y = stretch([0.0, 1.0, 1.0, 0.0, 0.0, 0.0], 0.0, start, p, 0.0, [])
    for beat in range(beats):
        t, end = start + beat * cycle, start + (beat + 1) * cycle
        rest, curves = y[0], []
        if name == "coelho_2021":
            y[0] += 0.325
        else:
            y = stretch(y, t, t + 1.0, p, 0.5, curves)
            t += 1.0
        y = stretch(y, t, end, p, 0.0, curves)
        u_top, u_time = peak(curves, 0)
        ta_top, ta_time = peak(curves, 5)
        level = rest + 0.1 * (u_top - rest)
        apd = float("nan")
        for a, b, sol in curves:
            if b > u_time and sol(a)[0] > level >= sol(b)[0]:
                apd = brentq(lambda x: sol(x)[0] - level, max(a, u_time), b, xtol=1e-12) - (start + beat * cycle)
                break
        print(f"{name},{cycle:g},{beat},{u_top:.9f},{ta_top:.9g},{ta_time:.6f},{apd:.6f}", flush=True)


if __name__ == "__main__":
    print(f"# SciPy {scipy.__version__}; made by cell_converged.py")
    print("model,cycle_length_ms,beat,peak_u,peak_ta,peak_ta_ms,apd90_ms")
    for model in VALUES:
        for cycle_length in (500.0, 1000.0, 2000.0):
            train(model, cycle_length)
