"""The functions that take settings, which `generate.py` writes into them."""

from __future__ import annotations

from os import PathLike
from typing import Any, Literal, Mapping, TypedDict

from myospring._action_potential import ActionPotential, followed
from myospring._beat import Beat, run
from myospring._cell import Cell
from myospring._given import changed
from myospring._progress import Progress


class BeatSettings(TypedDict, total=False):
    """The settings of `simulate`, by name."""

    # <typed of beat>
    model: str | PathLike[str]
    peak_tension_kpa: float
    parameters: Mapping[str, float | str] | None
    title: str
    variables: str | None
    myofilaments: Literal["land_2017", "none"] | None
    calcium: str | PathLike[str] | None
    cell_calcium_dissociation_micromolar: float | None
    cell_ratio_min: float | None
    cell_ratio_max: float | None
    tension: str | PathLike[str] | None
    tension_clock: Literal["stimulus", "run"] | None
    cell_stretch_felt: Literal["cell", "triangle"]
    authors_step: bool
    cell_integrator: Literal["runge-kutta-4", "forward-euler", "staggered-euler", "rush-larsen", "adaptive", "stiff"] | None
    cell_step_ms: float | None
    cell_tolerance: float | None
    stimulus_kind: Literal["jump", "pulse"] | None
    stimulus_amplitude: float | str | None
    stimulus_duration_ms: float | None
    stimulus_start_ms: float | None
    beats: int
    cycle_length_ms: float
    s2_interval_ms: float | None
    steady_state: float | None
    steady_state_cache: str
    wave_speed_um_per_ms: float | None
    conduction_velocity_um_per_ms: float | None
    diffusion_um2_per_ms: float | None
    velocity_ratio: float | None
    conductivity: str | PathLike[str] | None
    stimulated: Literal["everywhere", "end", "centre", "half"] | None
    s2_stimulated: Literal["everywhere", "end", "centre", "half"] | None
    stretch_conductance_ms_per_uf: float | None
    stretch_reversal_mv: float | None
    young_modulus_kpa: float | None
    spring_stiffness_nn_per_um: float | None
    thickness_um: float
    area_law: Literal["gradient", "barycentric", "printed"]
    area_modulus_kpa: float | None
    poisson_ratio: float | None
    fibre_modulus_kpa: float
    damping_ratio: float
    slowest_period_ms: float | None
    drag_ratio: float
    retardation_time_ms: float
    active: Literal["fibre", "ends"]
    fibre: str
    stain: Literal["z-disc", "filament"] | None
    fibre_smoothing_um: float | None
    myofibril_content: str | PathLike[str]
    sarcomere_length: str | PathLike[str]
    sarcomere_reference_um: float | None
    helix_angle_deg: float | None
    support: Literal["mass-centre", "clamped-end", "clamped-ends", "afterloaded-ends", "spring-held-ends", "posts", "gel", "elastic-bed"]
    end_stretch: float
    afterload_nn: float | None
    end_stiffness_nn_per_um: float | None
    post_length_um: float | None
    post_load_height_um: float | None
    post_width_um: float | None
    post_thickness_um: float | None
    post_modulus_kpa: float | None
    bed_stiffness_kpa_per_um: float | None
    gel_modulus_kpa: float | None
    gel_poisson: float | None
    gel_thickness_um: float | None
    adhesion: str | PathLike[str] | None
    adhesion_stiffness_kpa_per_um: float | None
    integrator: Literal["verlet", "stoermer-verlet", "velocity-verlet", "quasi-static"] | None
    engine: Literal["auto", "plain", "fused"]
    time_step_ms: float | None
    exchange_interval_ms: float | None
    output_interval_ms: float | None
    frame_interval_ms: float
    duration_ms: float | None
    # </typed>


BEAT_KEYS: Mapping[str, tuple[str, Any]] = {
    # <keys of beat>
    "model": ("cell.model", "coelho_2021"),
    "peak_tension_kpa": ("cell.peak_tension", 50.0),
    "parameters": ("cell.parameters", None),
    "title": ("title", ""),
    "variables": ("cell.variables", None),
    "myofilaments": ("cell.myofilaments", None),
    "calcium": ("cell.calcium", None),
    "cell_calcium_dissociation_micromolar": ("cell.calcium_dissociation", None),
    "cell_ratio_min": ("cell.ratio_min", None),
    "cell_ratio_max": ("cell.ratio_max", None),
    "tension": ("cell.tension", None),
    "tension_clock": ("cell.tension_clock", None),
    "cell_stretch_felt": ("cell.stretch_felt", "cell"),
    "authors_step": ("cell.authors_step", False),
    "cell_integrator": ("cell.integrator", None),
    "cell_step_ms": ("cell.step", None),
    "cell_tolerance": ("cell.tolerance", None),
    "stimulus_kind": ("stimulus.kind", None),
    "stimulus_amplitude": ("stimulus.amplitude", None),
    "stimulus_duration_ms": ("stimulus.duration", None),
    "stimulus_start_ms": ("stimulus.start", None),
    "beats": ("stimulus.beats", 1),
    "cycle_length_ms": ("stimulus.cycle_length", 1000.0),
    "s2_interval_ms": ("stimulus.s2_interval", None),
    "steady_state": ("stimulus.steady_state", None),
    "steady_state_cache": ("stimulus.steady_state_cache", ""),
    "wave_speed_um_per_ms": ("stimulus.wave_speed", None),
    "conduction_velocity_um_per_ms": ("tissue.conduction_velocity", None),
    "diffusion_um2_per_ms": ("tissue.diffusion", None),
    "velocity_ratio": ("tissue.velocity_ratio", None),
    "conductivity": ("tissue.conductivity", None),
    "stimulated": ("tissue.stimulated", None),
    "s2_stimulated": ("tissue.s2_stimulated", None),
    "stretch_conductance_ms_per_uf": ("tissue.stretch_conductance", None),
    "stretch_reversal_mv": ("tissue.stretch_reversal", None),
    "young_modulus_kpa": ("material.young_modulus", None),
    "spring_stiffness_nn_per_um": ("material.spring_stiffness", None),
    "thickness_um": ("material.thickness", 10.0),
    "area_law": ("material.area_law", "gradient"),
    "area_modulus_kpa": ("material.area_modulus", None),
    "poisson_ratio": ("material.poisson_ratio", None),
    "fibre_modulus_kpa": ("material.fibre_modulus", 0.0),
    "damping_ratio": ("material.damping_ratio", 0.05),
    "slowest_period_ms": ("material.slowest_period", None),
    "drag_ratio": ("material.drag_ratio", 0.3),
    "retardation_time_ms": ("material.retardation_time", 0.0),
    "active": ("mechanics.active", "fibre"),
    "fibre": ("mechanics.fibre", "auto"),
    "stain": ("mechanics.stain", None),
    "fibre_smoothing_um": ("mechanics.fibre_smoothing", None),
    "myofibril_content": ("mechanics.myofibril_content", "uniform"),
    "sarcomere_length": ("mechanics.sarcomere_length", "uniform"),
    "sarcomere_reference_um": ("mechanics.sarcomere_reference", None),
    "helix_angle_deg": ("mechanics.helix_angle", None),
    "support": ("mechanics.support", "mass-centre"),
    "end_stretch": ("mechanics.end_stretch", 1.0),
    "afterload_nn": ("mechanics.afterload", None),
    "end_stiffness_nn_per_um": ("mechanics.end_stiffness", None),
    "post_length_um": ("mechanics.post_length", None),
    "post_load_height_um": ("mechanics.post_load_height", None),
    "post_width_um": ("mechanics.post_width", None),
    "post_thickness_um": ("mechanics.post_thickness", None),
    "post_modulus_kpa": ("mechanics.post_modulus", None),
    "bed_stiffness_kpa_per_um": ("mechanics.bed_stiffness", None),
    "gel_modulus_kpa": ("mechanics.gel_modulus", None),
    "gel_poisson": ("mechanics.gel_poisson", None),
    "gel_thickness_um": ("mechanics.gel_thickness", None),
    "adhesion": ("mechanics.adhesion", None),
    "adhesion_stiffness_kpa_per_um": ("mechanics.adhesion_stiffness", None),
    "integrator": ("numerics.integrator", None),
    "engine": ("numerics.engine", "auto"),
    "time_step_ms": ("numerics.time_step", None),
    "exchange_interval_ms": ("numerics.exchange_interval", None),
    "output_interval_ms": ("numerics.output_interval", None),
    "frame_interval_ms": ("numerics.frame_interval", 5.0),
    "duration_ms": ("run.duration", None),
    # </keys>
}
"""Key and default of each of them."""


def simulate(
    cell: Cell | None = None,
    *,
    # <signature of beat>
    model: str | PathLike[str] = "coelho_2021",
    peak_tension_kpa: float = 50.0,
    parameters: Mapping[str, float | str] | None = None,
    title: str = "",
    variables: str | None = None,
    myofilaments: Literal["land_2017", "none"] | None = None,
    calcium: str | PathLike[str] | None = None,
    cell_calcium_dissociation_micromolar: float | None = None,
    cell_ratio_min: float | None = None,
    cell_ratio_max: float | None = None,
    tension: str | PathLike[str] | None = None,
    tension_clock: Literal["stimulus", "run"] | None = None,
    cell_stretch_felt: Literal["cell", "triangle"] = "cell",
    authors_step: bool = False,
    cell_integrator: Literal["runge-kutta-4", "forward-euler", "staggered-euler", "rush-larsen", "adaptive", "stiff"] | None = None,
    cell_step_ms: float | None = None,
    cell_tolerance: float | None = None,
    stimulus_kind: Literal["jump", "pulse"] | None = None,
    stimulus_amplitude: float | str | None = None,
    stimulus_duration_ms: float | None = None,
    stimulus_start_ms: float | None = None,
    beats: int = 1,
    cycle_length_ms: float = 1000.0,
    s2_interval_ms: float | None = None,
    steady_state: float | None = None,
    steady_state_cache: str = "",
    wave_speed_um_per_ms: float | None = None,
    conduction_velocity_um_per_ms: float | None = None,
    diffusion_um2_per_ms: float | None = None,
    velocity_ratio: float | None = None,
    conductivity: str | PathLike[str] | None = None,
    stimulated: Literal["everywhere", "end", "centre", "half"] | None = None,
    s2_stimulated: Literal["everywhere", "end", "centre", "half"] | None = None,
    stretch_conductance_ms_per_uf: float | None = None,
    stretch_reversal_mv: float | None = None,
    young_modulus_kpa: float | None = None,
    spring_stiffness_nn_per_um: float | None = None,
    thickness_um: float = 10.0,
    area_law: Literal["gradient", "barycentric", "printed"] = "gradient",
    area_modulus_kpa: float | None = None,
    poisson_ratio: float | None = None,
    fibre_modulus_kpa: float = 0.0,
    damping_ratio: float = 0.05,
    slowest_period_ms: float | None = None,
    drag_ratio: float = 0.3,
    retardation_time_ms: float = 0.0,
    active: Literal["fibre", "ends"] = "fibre",
    fibre: str = "auto",
    stain: Literal["z-disc", "filament"] | None = None,
    fibre_smoothing_um: float | None = None,
    myofibril_content: str | PathLike[str] = "uniform",
    sarcomere_length: str | PathLike[str] = "uniform",
    sarcomere_reference_um: float | None = None,
    helix_angle_deg: float | None = None,
    support: Literal["mass-centre", "clamped-end", "clamped-ends", "afterloaded-ends", "spring-held-ends", "posts", "gel", "elastic-bed"] = "mass-centre",
    end_stretch: float = 1.0,
    afterload_nn: float | None = None,
    end_stiffness_nn_per_um: float | None = None,
    post_length_um: float | None = None,
    post_load_height_um: float | None = None,
    post_width_um: float | None = None,
    post_thickness_um: float | None = None,
    post_modulus_kpa: float | None = None,
    bed_stiffness_kpa_per_um: float | None = None,
    gel_modulus_kpa: float | None = None,
    gel_poisson: float | None = None,
    gel_thickness_um: float | None = None,
    adhesion: str | PathLike[str] | None = None,
    adhesion_stiffness_kpa_per_um: float | None = None,
    integrator: Literal["verlet", "stoermer-verlet", "velocity-verlet", "quasi-static"] | None = None,
    engine: Literal["auto", "plain", "fused"] = "auto",
    time_step_ms: float | None = None,
    exchange_interval_ms: float | None = None,
    output_interval_ms: float | None = None,
    frame_interval_ms: float = 5.0,
    duration_ms: float | None = None,
    # </signature>
    threads: int | None = None,
    progress: Progress = None,
) -> Beat:
    """Beats a cell: stimulus, action potential, tension, and the shape that follows it.

    Parameters
    ----------
    cell : Cell or None
        The cell; None takes the built-in one.
    model : str or PathLike[str], default "coelho_2021"
        Cell model; `myospring.models()` lists them. Or the file of a published model: CellML
        (.cellml) or Myokit's (.mmt).
    peak_tension_kpa : float, default 50.0
        Peak of the active tension of one default beat with the model's published parameters;
        changed parameters make the cell stronger or weaker than that. Not for a model whose tension
        is already in kPa, such as land_2017: scale its T_ref. In kPa, 0 kPa to 500 kPa.
    parameters : Mapping[str, float or str] or None
        Parameters of the cell model that differ from the published ones, by name: "1.9 ms", or a
        plain number in the parameter's own unit; `myospring.parameters(model)` lists them.
    title : str, default ""
        Title of the run, for people.
    variables : str or None
        Variables of a model from a file that the file does not tell: ROLE=VARIABLE, separated by
        commas, with the roles potential, stimulus, calcium and tension and variables like
        component.variable; `myospring models FILE` lists them. None: found by annotation, name and
        unit.
    myofilaments : {"land_2017", "none"} or None
        What makes the tension of a model from a file: land_2017, driven by the model's calcium, or
        none, for the membrane alone with the tension that the file may have. None: the file's own
        tension; land_2017 for a file without one that has calcium.
    calcium : str or PathLike[str] or None
        Calcium from a table (.csv), for a model with prescribed calcium: a column of times from the
        stimulus and one of calcium, with their units in the header like time (ms),calcium (uM), or
        a ratio with its calibration. The course restarts at each stimulus. None: the cell model's
        own; for land_2017, two exponentials.
    cell_calcium_dissociation_micromolar : float or None
        For a ratio in that table: dissociation constant of the dye times the ratio of its
        fluorescence without to that with calcium at the second wavelength, K in Ca = K (R - R_min)
        / (R_max - R). In uM, above 0 uM, at most 1000 uM.
    cell_ratio_min : float or None
        The ratio without calcium, R_min. 0 to 1000000.
    cell_ratio_max : float or None
        The ratio with the dye saturated with calcium, R_max. Above 0, at most 1000000.
    tension : str or PathLike[str] or None
        Active tension from a table (.csv), for model = "given_tension": a column of times and one
        of tension, with their units in the header like time (ms),tension (kPa), or tension over
        Young's modulus, tension_over_stiffness. Between rows it is interpolated without overshoot.
    tension_clock : {"stimulus", "run"} or None
        From when the times of that table count.
    cell_stretch_felt : {"cell", "triangle"}, default "cell"
        Which stretch acts on a model that depends on stretch, such as land_2017.
    authors_step : bool, default False
        Integrate the cell model as the authors of `coelho_2021` did (staggered Euler, 0.05 ms); its
        peak tension is 4 % low, its onset 20 ms late. Not together with method or step.
    cell_integrator : {"runge-kutta-4", "forward-euler", "staggered-euler", "rush-larsen", "adaptive", "stiff"} or None
        Integration method of the cell model, with fixed or adaptive steps. None: that of the cell
        model: adaptive for the minimal models, stiff for ToR-ORd, else mostly runge-kutta-4.
    cell_step_ms : float or None
        Largest time step of the cell model, for a method with fixed steps. If only the step is
        given, minimal models take runge-kutta-4. In ms, 1e-5 ms to 1 ms. None: that of the method
        and the cell model: adaptive steps have none; 0.005 ms, for land_2017 0.05 ms, in a tissue
        0.02 ms.
    cell_tolerance : float or None
        Largest error of a step relative to the size of each variable, for a method with adaptive
        steps. 1e-10 to 0.01. None: 0.00001.
    stimulus_kind : {"jump", "pulse"} or None
        A jump of the potential variable, or a pulse of current. None: the cell model's own.
    stimulus_amplitude : float or str or None
        Size: a dimensionless number for a jump of u; for a pulse a rate ("0.5 1/ms"), or the
        current of a model that has one, in its unit ("53 A/F"). Positive values depolarise. None:
        the cell model's own.
    stimulus_duration_ms : float or None
        Duration of a pulse; not for a jump. In ms, above 0 ms, at most 1000 ms.
    stimulus_start_ms : float or None
        Time of the first stimulus. In ms, 0 ms to 100000 ms.
    beats : int, default 1
        Number of stimuli; 0 leaves the cell at rest. 0 to 10000.
    cycle_length_ms : float, default 1000.0
        Time from one stimulus to the next. In ms, above 0 ms, at most 100000 ms.
    s2_interval_ms : float or None
        Coupling interval of one extra stimulus, S2: its time after the last of the train, S1. Its
        beat is measured from the rest before that S1; it has no metrics if it raises no action
        potential, and does not count in means over beats. In ms, above 0 ms, at most 100000 ms.
        None: no extra stimulus.
    steady_state : float or None
        Pace the cell model alone at this cycle length before the run, until no state changes by
        more than this over ten beats, relative to its size within a beat; the run's first beat is
        then the next one of that train. 1e-6 to 0.1. None: the run starts from the model's initial
        state.
    steady_state_cache : str, default ""
        Folder in which steady states are stored for other runs with the same model, parameters and
        pacing; empty for none.
    wave_speed_um_per_ms : float or None
        Speed at which each stimulus, and its calcium release, travels along the cell from the end
        where the long axis starts: a cell model for each triangle, much slower. Beats are measured
        from the start of the wave. In um/ms, 0.001 um/ms to 1000000 um/ms. None: everywhere at
        once.
    conduction_velocity_um_per_ms : float or None
        Velocity along the fibres of a wave that goes from cell to cell: with it the shape is a
        tissue of coupled cells, one at each point of the mesh, instead of one cell. The diffusion
        of the potential is that which gives this velocity on this mesh with the published
        parameters of the cell model. Human ventricles have 60 to 70 cm/s, cultures of stem-cell-
        derived myocytes 5 to 20 cm/s; 10 um/ms are 1 cm/s. In um/ms, 1 um/ms to 5000 um/ms. None:
        one cell.
    diffusion_um2_per_ms : float or None
        The same, by the diffusion coefficient of the potential along the fibres; the velocity
        follows from it, and is smaller on a coarse mesh. In um^2/ms, 0 um^2/ms to 100000000
        um^2/ms.
    velocity_ratio : float or None
        Conduction velocity along the fibres over that across them. 0.1 to 10. None: 1.
    conductivity : str or PathLike[str] or None
        Where a tissue conducts: "uniform", or a file, relative to this one: a table (.csv) with the
        header conductivity, a row for each triangle, or x_um,y_um,conductivity, where 0 is a scar
        and 1 conducts as the tissue does, or a picture of the same frame as the tissue's, whose
        grey values are used relative to the largest. A factor on the diffusion coefficient. None:
        uniform.
    stimulated : {"everywhere", "end", "centre", "half"} or None
        What part of a tissue the stimuli reach. None: end.
    s2_stimulated : {"everywhere", "end", "centre", "half"} or None
        What part of a tissue an extra stimulus S2 reaches. None: as `stimulated`.
    stretch_conductance_ms_per_uf : float or None
        Mechano-electric feedback: conductance of channels that stretch opens, over the membrane's
        capacitance. Their current is conductance max(0, stretch - 1) (potential - reversal
        potential), with the stretch of the fibres relative to rest (Panfilov et al. 2007 take the
        root of the area's). Around 0.05 mS/uF a wave goes on as before, and a stretched place at
        rest is nearer to its threshold; 0 is no feedback. In mS/uF, 0 mS/uF to 10 mS/uF. None: 0:
        no feedback.
    stretch_reversal_mv : float or None
        Reversal potential of those channels; measured were 0 to -20 mV (Kohl et al. 1999). A model
        without millivolts has 1 in the unit of its potential. In mV, -100 mV to 100 mV.
    young_modulus_kpa : float or None
        Young's modulus of the sheet formed by the springs, or of the solid of a thick cell. In kPa,
        0.1 kPa to 1000000 kPa.
    spring_stiffness_nn_per_um : float or None
        Stiffness of a horizontal or vertical spring, instead of `young_modulus_kpa`; a diagonal one
        has half of it. In nN/um, 0.1 nN/um to 100000000 nN/um.
    thickness_um : float, default 10.0
        Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000 um.
    area_law : {"gradient", "barycentric", "printed"}, default "gradient"
        Law of area preservation.
    area_modulus_kpa : float or None
        Stiffness of the area law per thickness. In kPa, 0 kPa to 1000000 kPa.
    poisson_ratio : float or None
        Poisson's ratio of a thick cell. Near 0.5 it keeps its volume; 0.25 is that of springs
        alone. A flat cell has `area_modulus_kpa` instead. 0.25 to 0.499. None: 0.49.
    fibre_modulus_kpa : float, default 0.0
        What the fibres add to Young's modulus along themselves. In kPa, 0 kPa to 1000000 kPa.
    damping_ratio : float, default 0.05
        Dashpots along the springs, as a part of critical damping. 0 to 10.
    slowest_period_ms : float or None
        Period of the slowest vibration along the cell; sets the numerical density. Unless it is
        set, a run in time takes the longest from 2 to 8 ms with which its shortening lags by at
        most 1 % of its peak. In ms, 0.01 ms to 100 ms.
    drag_ratio : float, default 0.3
        Damping of that vibration by drag, as a part of critical damping. 0 to 100.
    retardation_time_ms : float, default 0.0
        Viscosity of the cell divided by its Young's modulus (Kelvin-Voigt): the time by which its
        shape lags behind its tension. Quasi-static runs only. In ms, 0 ms to 1000 ms.
    active : {"fibre", "ends"}, default "fibre"
        How the tension acts.
    fibre : str, default "auto"
        Direction of the fibres: "picture" (read from the stripes or filaments of the picture), the
        "long axis" of the cell, an angle counter-clockwise from x, or "auto": from a picture that
        shows sarcomeres or the stated stain, and along the long axis elsewhere.
    stain : {"z-disc", "filament"} or None
        What the picture shows: stripes across the fibre, or filaments along it. None: z-disc; auto
        uses it only if it finds sarcomeres.
    fibre_smoothing_um : float or None
        Scale over which directions from the picture are averaged. In um, 0.1 um to 20 um. None: "3
        um".
    myofibril_content : str or PathLike[str], default "uniform"
        Content of myofibrils in each place, to which tension is proportional: "uniform"; "picture",
        which uses order times coverage of the fibres in the picture, relative to its mean, and 0
        where it shows none; or a file, relative to this one: a table (.csv) with the header
        content, a row for each triangle, or x_um,y_um,content, used unchanged, or a picture of the
        same frame as the cell's, whose grey values are used relative to their mean.
    sarcomere_length : str or PathLike[str], default "uniform"
        Length of the sarcomeres at rest in each place, for a model that depends on stretch: its
        stretch there is this length divided by `sarcomere_reference_um`. "uniform": that length
        everywhere; "picture": as in the picture, or as at the nearest place where it shows none; or
        a table (.csv), with the header sarcomere_um, a row for each triangle, or
        x_um,y_um,sarcomere_um, such as fibres.csv. With a model for each triangle (stretch_felt =
        "triangle"), each has its own; a single model has their mean.
    sarcomere_reference_um : float or None
        Length of the sarcomere at which the cell model's stretch is 1. It has not been measured for
        any model: isolated rat cells rest at 1.71 um, the same cells within the heart at 1.95 um
        (Bub 2010). In um, 1 um to 3 um.
    helix_angle_deg : float or None
        Angle by which the fibres of a thick cell turn from its lowest to its highest point,
        counter-clockwise as seen from above. In deg, -180 deg to 180 deg. None: 0 deg.
    support : {"mass-centre", "clamped-end", "clamped-ends", "afterloaded-ends", "spring-held-ends", "posts", "gel", "elastic-bed"}, default "mass-centre"
        The support of the cell.
    end_stretch : float, default 1.0
        Distance between clamped or afterloaded ends before the beat, relative to the cell at rest.
        0.5 to 1.5.
    afterload_nn : float or None
        Force against which the cell of "afterloaded-ends" shortens: 1 kPa on a section of 200 um^2
        is 200 nN. In nN, above 0 nN, at most 1000000000 nN.
    end_stiffness_nn_per_um : float or None
        Stiffness of each of the two springs of "spring-held-ends", such as carbon fibres. In nN/um,
        above 0 nN/um, at most 100000000 nN/um.
    post_length_um : float or None
        Length of each of the posts of "posts", from foot to tip. In um, 1 um to 100000 um.
    post_load_height_um : float or None
        Height of the tissue above the foot of the posts, at most their length. In um, 1 um to
        100000 um. None: at the tip.
    post_width_um : float or None
        Width of the posts across the tissue; of round posts their diameter. In um, 0.1 um to 100000
        um.
    post_thickness_um : float or None
        Thickness of rectangular posts along the tissue, which bends them in it. In um, 0.1 um to
        100000 um. None: round posts.
    post_modulus_kpa : float or None
        Young's modulus of the posts; that of silicone (PDMS) is 1 to 3 MPa. In kPa, 0.001 kPa to
        1000000000 kPa.
    bed_stiffness_kpa_per_um : float or None
        Stiffness of an "elastic-bed", traction per displacement: for a thin layer its shear modulus
        divided by its thickness. In kPa/um, above 0 kPa/um, at most 1000000 kPa/um. None: "0.5
        kPa/um" for an elastic bed, with a warning.
    gel_modulus_kpa : float or None
        Young's modulus of the gel under the cell of "gel". In kPa, 0.001 kPa to 1000000 kPa.
    gel_poisson : float or None
        Poisson's ratio of the gel: 0.49 of one that keeps its volume, 0.4 to 0.5 of polyacrylamide.
        0 to 0.499. None: 0.49.
    gel_thickness_um : float or None
        Thickness of the gel, which is bonded to glass; unless stated it is so thick that the glass
        is not felt. In um, 0.1 um to 100000 um.
    adhesion : str or PathLike[str] or None
        Where the cell adheres to the gel: "everywhere"; "ends", a fifth of its length at either
        end; "rim", what lies within 3 um of its outline; or a file, relative to this one: a picture
        of the same frame as the cell's, such as one of stained focal adhesions, which adheres where
        it is not black, or a table (.csv) with the header adhesion, a row for each node, or
        x_um,y_um,adhesion, which adheres where that is above 0. Grey values relative to the largest
        in the cell, or the values of the table, are factors on `adhesion_stiffness_kpa_per_um`.
        None: everywhere.
    adhesion_stiffness_kpa_per_um : float or None
        Stiffness of what ties the cell to the gel, traction per distance; unless stated it does not
        give way. In kPa/um, 0.001 kPa/um to 1000000 kPa/um.
    integrator : {"verlet", "stoermer-verlet", "velocity-verlet", "quasi-static"} or None
        How the shape follows the tension: in time by Verlet's method ("verlet" is the paper's
        form), or along its equilibria. None: verlet, or quasi-static on a gel.
    engine : {"auto", "plain", "fused"}, default "auto"
        Implementation of the integrator in time; an unsupported one is an error, and run.json
        states the one used.
    time_step_ms : float or None
        Mechanical time step; a step above the stability limit is an error. Not for "quasi-static".
        In ms, 1e-7 ms to 10 ms. None: 0.95 of the stability limit.
    exchange_interval_ms : float or None
        Interval at which cell model and mesh exchange tension and stretch. In ms, 0.001 ms to 10
        ms.
    output_interval_ms : float or None
        Interval of the rows in traces.csv, a multiple of the exchange interval. In ms, 0.001 ms to
        10000 ms.
    frame_interval_ms : float, default 5.0
        Interval of the recorded shapes, from which films, ParaView's files and frames.npz are made;
        a multiple of the output interval. In ms, 0.001 ms to 100000 ms.
    duration_ms : float or None
        Time simulated, a multiple of the exchange interval. In ms, above 0 ms, at most 1000000 ms.
        None: 550 ms after the last stimulus.
    threads : int or None
        Most threads that move the masses; None takes as many as pay. The numbers are the same to the last bit.
    progress : callable, bool or None
        Called with ``("ms", done, all)`` while the cell beats; what it raises ends the run. True draws a bar.

    Returns
    -------
    Beat
        Curves, shapes and numbers.

    Raises
    ------
    UnknownNameError
        A cell model or a parameter that does not exist.
    ValueError
        A value outside its bounds, or settings that exclude each other.
    FileNotFoundError
        A file that is not there.
    SimulationError
        The run stopped before its end; it has the time, and what was computed.
    KeyboardInterrupt
        Ctrl-C, within a second.

    Examples
    --------
    >>> import myospring
    >>> beat = myospring.simulate(peak_tension_kpa=30, integrator="quasi-static")
    >>> beat.shortening_pct.shape == beat.t_ms.shape
    True
    """
    # <given of beat>
    given = changed(
        ("cell.model", model, "coelho_2021"),
        ("cell.peak_tension", peak_tension_kpa, 50.0),
        ("cell.parameters", parameters, None),
        ("title", title, ""),
        ("cell.variables", variables, None),
        ("cell.myofilaments", myofilaments, None),
        ("cell.calcium", calcium, None),
        ("cell.calcium_dissociation", cell_calcium_dissociation_micromolar, None),
        ("cell.ratio_min", cell_ratio_min, None),
        ("cell.ratio_max", cell_ratio_max, None),
        ("cell.tension", tension, None),
        ("cell.tension_clock", tension_clock, None),
        ("cell.stretch_felt", cell_stretch_felt, "cell"),
        ("cell.authors_step", authors_step, False),
        ("cell.integrator", cell_integrator, None),
        ("cell.step", cell_step_ms, None),
        ("cell.tolerance", cell_tolerance, None),
        ("stimulus.kind", stimulus_kind, None),
        ("stimulus.amplitude", stimulus_amplitude, None),
        ("stimulus.duration", stimulus_duration_ms, None),
        ("stimulus.start", stimulus_start_ms, None),
        ("stimulus.beats", beats, 1),
        ("stimulus.cycle_length", cycle_length_ms, 1000.0),
        ("stimulus.s2_interval", s2_interval_ms, None),
        ("stimulus.steady_state", steady_state, None),
        ("stimulus.steady_state_cache", steady_state_cache, ""),
        ("stimulus.wave_speed", wave_speed_um_per_ms, None),
        ("tissue.conduction_velocity", conduction_velocity_um_per_ms, None),
        ("tissue.diffusion", diffusion_um2_per_ms, None),
        ("tissue.velocity_ratio", velocity_ratio, None),
        ("tissue.conductivity", conductivity, None),
        ("tissue.stimulated", stimulated, None),
        ("tissue.s2_stimulated", s2_stimulated, None),
        ("tissue.stretch_conductance", stretch_conductance_ms_per_uf, None),
        ("tissue.stretch_reversal", stretch_reversal_mv, None),
        ("material.young_modulus", young_modulus_kpa, None),
        ("material.spring_stiffness", spring_stiffness_nn_per_um, None),
        ("material.thickness", thickness_um, 10.0),
        ("material.area_law", area_law, "gradient"),
        ("material.area_modulus", area_modulus_kpa, None),
        ("material.poisson_ratio", poisson_ratio, None),
        ("material.fibre_modulus", fibre_modulus_kpa, 0.0),
        ("material.damping_ratio", damping_ratio, 0.05),
        ("material.slowest_period", slowest_period_ms, None),
        ("material.drag_ratio", drag_ratio, 0.3),
        ("material.retardation_time", retardation_time_ms, 0.0),
        ("mechanics.active", active, "fibre"),
        ("mechanics.fibre", fibre, "auto"),
        ("mechanics.stain", stain, None),
        ("mechanics.fibre_smoothing", fibre_smoothing_um, None),
        ("mechanics.myofibril_content", myofibril_content, "uniform"),
        ("mechanics.sarcomere_length", sarcomere_length, "uniform"),
        ("mechanics.sarcomere_reference", sarcomere_reference_um, None),
        ("mechanics.helix_angle", helix_angle_deg, None),
        ("mechanics.support", support, "mass-centre"),
        ("mechanics.end_stretch", end_stretch, 1.0),
        ("mechanics.afterload", afterload_nn, None),
        ("mechanics.end_stiffness", end_stiffness_nn_per_um, None),
        ("mechanics.post_length", post_length_um, None),
        ("mechanics.post_load_height", post_load_height_um, None),
        ("mechanics.post_width", post_width_um, None),
        ("mechanics.post_thickness", post_thickness_um, None),
        ("mechanics.post_modulus", post_modulus_kpa, None),
        ("mechanics.bed_stiffness", bed_stiffness_kpa_per_um, None),
        ("mechanics.gel_modulus", gel_modulus_kpa, None),
        ("mechanics.gel_poisson", gel_poisson, None),
        ("mechanics.gel_thickness", gel_thickness_um, None),
        ("mechanics.adhesion", adhesion, None),
        ("mechanics.adhesion_stiffness", adhesion_stiffness_kpa_per_um, None),
        ("numerics.integrator", integrator, None),
        ("numerics.engine", engine, "auto"),
        ("numerics.time_step", time_step_ms, None),
        ("numerics.exchange_interval", exchange_interval_ms, None),
        ("numerics.output_interval", output_interval_ms, None),
        ("numerics.frame_interval", frame_interval_ms, 5.0),
        ("run.duration", duration_ms, None),
    )
    # </given>
    return run(cell, given, threads, progress)


def action_potential(
    # <signature of model>
    model: str | PathLike[str] = "coelho_2021",
    parameters: Mapping[str, float | str] | None = None,
    # </signature>
    *,
    # <signature of potential>
    variables: str | None = None,
    myofilaments: Literal["land_2017", "none"] | None = None,
    cell_integrator: Literal["runge-kutta-4", "forward-euler", "staggered-euler", "rush-larsen", "adaptive", "stiff"] | None = None,
    cell_step_ms: float | None = None,
    cell_tolerance: float | None = None,
    authors_step: bool = False,
    stimulus_kind: Literal["jump", "pulse"] | None = None,
    stimulus_amplitude: float | str | None = None,
    stimulus_duration_ms: float | None = None,
    stimulus_start_ms: float | None = None,
    beats: int = 1,
    cycle_length_ms: float = 1000.0,
    s2_interval_ms: float | None = None,
    duration_ms: float | None = None,
    output_interval_ms: float | None = None,
    # </signature>
    progress: Progress = None,
) -> ActionPotential:
    """Follows a cell model alone, at its resting length: potential and tension without a mesh.

    Parameters
    ----------
    model : str or PathLike[str], default "coelho_2021"
        Cell model; `myospring.models()` lists them. Or the file of a published model: CellML
        (.cellml) or Myokit's (.mmt).
    parameters : Mapping[str, float or str] or None
        Parameters of the cell model that differ from the published ones, by name: "1.9 ms", or a
        plain number in the parameter's own unit; `myospring.parameters(model)` lists them.
    variables : str or None
        Variables of a model from a file that the file does not tell: ROLE=VARIABLE, separated by
        commas, with the roles potential, stimulus, calcium and tension and variables like
        component.variable; `myospring models FILE` lists them. None: found by annotation, name and
        unit.
    myofilaments : {"land_2017", "none"} or None
        What makes the tension of a model from a file: land_2017, driven by the model's calcium, or
        none, for the membrane alone with the tension that the file may have. None: the file's own
        tension; land_2017 for a file without one that has calcium.
    cell_integrator : {"runge-kutta-4", "forward-euler", "staggered-euler", "rush-larsen", "adaptive", "stiff"} or None
        Integration method of the cell model, with fixed or adaptive steps. None: that of the cell
        model: adaptive for the minimal models, stiff for ToR-ORd, else mostly runge-kutta-4.
    cell_step_ms : float or None
        Largest time step of the cell model, for a method with fixed steps. If only the step is
        given, minimal models take runge-kutta-4. In ms, 1e-5 ms to 1 ms. None: that of the method
        and the cell model: adaptive steps have none; 0.005 ms, for land_2017 0.05 ms, in a tissue
        0.02 ms.
    cell_tolerance : float or None
        Largest error of a step relative to the size of each variable, for a method with adaptive
        steps. 1e-10 to 0.01. None: 0.00001.
    authors_step : bool, default False
        Integrate the cell model as the authors of `coelho_2021` did (staggered Euler, 0.05 ms); its
        peak tension is 4 % low, its onset 20 ms late. Not together with method or step.
    stimulus_kind : {"jump", "pulse"} or None
        A jump of the potential variable, or a pulse of current. None: the cell model's own.
    stimulus_amplitude : float or str or None
        Size: a dimensionless number for a jump of u; for a pulse a rate ("0.5 1/ms"), or the
        current of a model that has one, in its unit ("53 A/F"). Positive values depolarise. None:
        the cell model's own.
    stimulus_duration_ms : float or None
        Duration of a pulse; not for a jump. In ms, above 0 ms, at most 1000 ms.
    stimulus_start_ms : float or None
        Time of the first stimulus. In ms, 0 ms to 100000 ms.
    beats : int, default 1
        Number of stimuli; 0 leaves the cell at rest. 0 to 10000.
    cycle_length_ms : float, default 1000.0
        Time from one stimulus to the next. In ms, above 0 ms, at most 100000 ms.
    s2_interval_ms : float or None
        Coupling interval of one extra stimulus, S2: its time after the last of the train, S1. Its
        beat is measured from the rest before that S1; it has no metrics if it raises no action
        potential, and does not count in means over beats. In ms, above 0 ms, at most 100000 ms.
        None: no extra stimulus.
    duration_ms : float or None
        Time simulated, a multiple of the exchange interval. In ms, above 0 ms, at most 1000000 ms.
        None: 550 ms after the last stimulus.
    output_interval_ms : float or None
        Interval of the rows in traces.csv, a multiple of the exchange interval. In ms, 0.001 ms to
        10000 ms.
    progress : callable, bool or None
        As in `simulate`.

    Returns
    -------
    ActionPotential
        The course of every variable, and its numbers.

    Raises
    ------
    UnknownNameError
        A cell model or a parameter that does not exist.
    ValueError
        A value outside its bounds.

    Examples
    --------
    >>> import myospring
    >>> course = myospring.action_potential("bueno_orovio_2008_epi")
    >>> bool(260 < course.metrics["action_potential_duration_90"] < 280)
    True
    """
    # <given of model_and_potential>
    given = changed(
        ("cell.model", model, "coelho_2021"),
        ("cell.parameters", parameters, None),
        ("cell.variables", variables, None),
        ("cell.myofilaments", myofilaments, None),
        ("cell.integrator", cell_integrator, None),
        ("cell.step", cell_step_ms, None),
        ("cell.tolerance", cell_tolerance, None),
        ("cell.authors_step", authors_step, False),
        ("stimulus.kind", stimulus_kind, None),
        ("stimulus.amplitude", stimulus_amplitude, None),
        ("stimulus.duration", stimulus_duration_ms, None),
        ("stimulus.start", stimulus_start_ms, None),
        ("stimulus.beats", beats, 1),
        ("stimulus.cycle_length", cycle_length_ms, 1000.0),
        ("stimulus.s2_interval", s2_interval_ms, None),
        ("run.duration", duration_ms, None),
        ("numerics.output_interval", output_interval_ms, None),
    )
    # </given>
    return followed(given, progress)
