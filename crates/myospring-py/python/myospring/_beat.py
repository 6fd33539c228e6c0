"""A run and its results."""

from __future__ import annotations

import html
import os
import tempfile
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._cell import Cell, cell_of
from myospring._errors import warn
from myospring._progress import Progress, heard
from myospring._xarray import dataset

# First metrics of a table in a notebook.
_SHOWN = ("peak_shortening", "time_to_peak_from_stimulus", "peak_tension", "action_potential_duration_90")


def _fixed(array: NDArray[Any]) -> NDArray[Any]:
    """Returns the array as read-only, since it is passed on without a copy."""
    array.flags.writeable = False
    return array


class Beat:
    """A run of a cell: curves, shapes and metrics; the result of `simulate`.

    Arrays are created once, without copying, and are read-only. A beat can be pickled.

    Attributes
    ----------
    cell : Cell
        The simulated cell.
    """

    def __init__(self, cell: Cell, native: _native.Beat) -> None:
        self.cell = cell
        self._native = native

    def _column(self, name: str) -> NDArray[np.float64]:
        return _fixed(self._native.column(name))

    @cached_property
    def t_ms(self) -> NDArray[np.float64]:
        """Times of the samples, ms, of shape (samples,)."""
        return self._column("t_ms")

    @cached_property
    def u(self) -> NDArray[np.float64]:
        """The cell model's potential variable, of shape (samples,); NaN if it has none."""
        return self._column("u")

    @cached_property
    def vm_mv(self) -> NDArray[np.float64] | None:
        """Membrane potential, mV, of shape (samples,); None if the model does not define it."""
        return self._column("vm_mv") if "vm_mv" in self._native.columns else None

    @cached_property
    def ta_kpa(self) -> NDArray[np.float64]:
        """Active tension, kPa, of shape (samples,)."""
        return self._column("ta_kpa")

    @cached_property
    def length_um(self) -> NDArray[np.float64]:
        """Length along the long axis at rest, um, of shape (samples,)."""
        return self._column("length_um")

    @cached_property
    def width_um(self) -> NDArray[np.float64]:
        """Largest extent across the long axis, um, of shape (samples,)."""
        return self._column("width_um")

    @cached_property
    def area_um2(self) -> NDArray[np.float64]:
        """Projected area, um^2, of shape (samples,)."""
        return self._column("area_um2")

    @cached_property
    def shortening_pct(self) -> NDArray[np.float64]:
        """Shortening, per cent of the resting length, of shape (samples,)."""
        return self._column("shortening_pct")

    @cached_property
    def frame_t_ms(self) -> NDArray[np.float64]:
        """Times of the recorded shapes, ms, of shape (frames,)."""
        return _fixed(self._native.frame_t_ms)

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Positions of the masses in each recorded shape, um, of shape (frames, nodes, 2)."""
        return _fixed(self._native.positions)

    @cached_property
    def positions_in_space(self) -> NDArray[np.float64] | None:
        """Positions of the points of a thick cell, um, of shape (frames, points, 3). A flat cell has None."""
        positions = self._native.positions_in_space
        return None if positions is None else _fixed(positions)

    @cached_property
    def activation_ms(self) -> NDArray[np.float64] | None:
        """When each place of a tissue was activated, ms after the stimulus, of shape (nodes,); NaN where it was not.

        Of several beats it is the first that counts. A single cell has None.
        """
        activation = self._native.activation
        return None if activation is None else _fixed(activation[0])

    @cached_property
    def local_action_potential_duration_90_ms(self) -> NDArray[np.float64] | None:
        """Duration of the action potential of each place of a tissue, to 90 % repolarisation, ms, of shape (nodes,).

        NaN where it is not known. A single cell has None.
        """
        activation = self._native.activation
        return None if activation is None else _fixed(activation[1])

    @cached_property
    def wave_tips(self) -> NDArray[np.float64] | None:
        """Where waves in a tissue ended, such as the tip about which a spiral wave turns: time, ms, x and y, um, of shape (tips, 3).

        Waves that meet have tips for a moment. A single cell has None.
        """
        tips = self._native.wave_tips
        return None if tips is None else _fixed(tips)

    @cached_property
    def forces_on_gel(self) -> NDArray[np.float64] | None:
        """Force of each mass on the gel in each recorded shape, nN, of shape (frames, nodes, 2); None without a gel."""
        forces = self._native.forces_on_gel
        return None if forces is None else _fixed(forces)

    @cached_property
    def potentials(self) -> NDArray[np.float64] | None:
        """Membrane potential of a tissue at each node, mV, of shape (frames, nodes). A single cell has None."""
        potentials = self._native.potentials
        return None if potentials is None else _fixed(potentials)

    @cached_property
    def triangles(self) -> NDArray[np.uint32]:
        """Nodes of each triangle, of shape (triangles, 3)."""
        return _fixed(self._native.triangles)

    @cached_property
    def fibres(self) -> NDArray[np.float64]:
        """Fibre direction in each triangle, unit vectors, of shape (triangles, 2)."""
        return _fixed(self._native.fibres)

    @cached_property
    def metrics(self) -> dict[str, float]:
        """Metrics by name, for several beats their means; NaN if the curves do not show one.

        `units` has the units, and `missing` the reasons for NaN.
        """
        return {name: np.nan if value is None else value for name, value, _ in self._native.metrics}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each metric; empty for a pure number."""
        return {name: unit for name, _, unit in self._native.metrics}

    @cached_property
    def missing(self) -> dict[str, str]:
        """Reason for each metric that is NaN, by name; empty if all have a value."""
        return dict(self._native.missing)

    @cached_property
    def metrics_by_beat(self) -> list[dict[str, float]]:
        """Metrics of each beat of a run with several stimuli; all NaN if the stimulus was not captured."""
        return [
            {name: np.nan if value is None else value for name, value in beat}
            for beat in self._native.metrics_by_beat
        ]

    @property
    def rhythm(self) -> dict[str, Any]:
        """Response of the beats to the stimuli.

        ``stimuli``: their number, without an S2; ``not_captured``: the numbers, from 1, of those that raised no action
        potential; ``capture_ratio`` and ``alternans``: a sentence each, or None.
        """
        return dict(zip(("stimuli", "not_captured", "capture_ratio", "alternans"), self._native.rhythm))

    @property
    def stimulus_times_ms(self) -> list[float]:
        """Times of the stimuli, ms."""
        return self._native.stimulus_times_ms

    @property
    def warnings(self) -> list[str]:
        """Warnings for the user."""
        return self._native.warnings

    @property
    def about_model(self) -> str | None:
        """Known behaviour of the cell model that this beat shows, in a sentence; None if there is none."""
        return self._native.about_model

    @property
    def stopped(self) -> tuple[str, float | None] | None:
        """Why and when (ms) the run stopped before its end; None if it did not."""
        return self._native.stop

    @property
    def run_file(self) -> str:
        """The run file (TOML) that repeats this run with the program."""
        return self._native.run_file

    def to_dataframe(self) -> Any:
        """Returns the curves as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per sample; the columns have the names of the arrays.
        """
        import pandas

        return pandas.DataFrame({name: self._native.column(name) for name in self._native.columns})

    def to_xarray(self) -> Any:
        """Returns curves and shapes as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Curves over ``t_ms``; positions and forces on a gel over ``frame_t_ms``, ``node`` and ``axis``; units are attributes.
        """
        curves = {name: (("t_ms",), self._native.column(name)) for name in self._native.columns if name != "t_ms"}
        shapes = {
            "positions_um": (("frame_t_ms", "node", "axis"), self.positions),
            "triangles": (("triangle", "corner"), self.triangles),
            "fibres": (("triangle", "axis"), self.fibres),
        }
        if self.forces_on_gel is not None:
            shapes["forces_on_gel_nn"] = (("frame_t_ms", "node", "axis"), self.forces_on_gel)
        if self.potentials is not None:
            shapes["potential_mV"] = (("frame_t_ms", "node"), self.potentials)
        times = {"t_ms": (("t_ms",), self.t_ms), "frame_t_ms": (("frame_t_ms",), self.frame_t_ms)}
        return dataset({**curves, **shapes}, times, {"title": self.cell.name, "run_file": self.run_file})

    def plot(self, axes: Any = None) -> Any:
        """Draws potential, tension and shortening over time; needs matplotlib.

        Parameters
        ----------
        axes : sequence of three matplotlib axes, or None
            Axes to draw on; None creates a figure.

        Returns
        -------
        array of matplotlib.axes.Axes
            The three axes.
        """
        if axes is None:
            from matplotlib import pyplot

            _, axes = pyplot.subplots(3, 1, sharex=True, figsize=(5.5, 6.0), layout="constrained")
        potential = (self.u, "Potential u") if self.vm_mv is None else (self.vm_mv, "Potential (mV)")
        curves = (
            (*potential, "#4a4a4a"),
            (self.ta_kpa, "Tension (kPa)", "#b5532a"),
            (self.shortening_pct, "Shortening (%)", "#2a6099"),
        )
        for one, (values, label, colour) in zip(axes, curves):
            one.plot(self.t_ms, values, color=colour)
            one.set_ylabel(label)
            one.spines[["top", "right"]].set_visible(False)
        axes[-1].set_xlabel("Time (ms)")
        return axes

    def save(
        self,
        folder: str | PathLike[str],
        *,
        force: bool = False,
        outputs: Sequence[str] | str | None = None,
    ) -> Path:
        """Writes the files of ``myospring run``: curves, metrics, report, figures.

        Parameters
        ----------
        folder : path
            Created if it does not exist.
        force : bool
            Whether to replace results in the folder. Refused if the folder contains files that no command wrote, or
            files changed since; an input file of the beat is never replaced.
        outputs : sequence of str, str or None
            What to write besides curves and metrics, with the words of ``myospring run --outputs``; None: report and
            figures.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        UnknownNameError
            An unknown word.
        OSError
            The folder contains files, or cannot be written to.
        """
        words = outputs.split(",") if isinstance(outputs, str) else None if outputs is None else list(outputs)
        return Path(self._native.save(os.fspath(folder), force, words))

    @classmethod
    def load(cls, folder: str | PathLike[str]) -> Beat:
        """Reads a beat that ``myospring run`` or `save` has written.

        Parameters
        ----------
        folder : path
            The folder of results. The cell is meshed again from its ``run.toml``; positions are there where the run has
            kept its frames (``outputs="frames"``).

        Returns
        -------
        Beat
            The beat, with the digits of ``traces.csv``.

        Raises
        ------
        ValueError
            The folder holds no results, or they were changed since.
        OSError
            A file that the results name cannot be read.
        """
        cell, beat = _native.load(os.fspath(folder))
        return cls(Cell(cell), beat)

    def animate(self) -> Page:
        """Returns the beating cell with its curves as a self-contained page for notebooks.

        Returns
        -------
        Page
            The page, which notebooks show; ``str`` returns its HTML.
        """
        with tempfile.TemporaryDirectory() as folder:
            page = (self.save(Path(folder) / "beat", outputs=["report"]) / "report.html").read_text(encoding="utf-8")
        return Page(page, self.cell.name)

    def _facts(self) -> str:
        """Returns the cell model, its peak tension and the duration of the run."""
        model, duration = self._native.facts
        tension = self.metrics.get("peak_tension", np.nan)
        return f"{model}, up to {tension:.3g} kPa, {duration:g} ms"

    def __repr__(self) -> str:
        shortening = self.metrics.get("peak_shortening", np.nan)
        end = "" if self.stopped is None else f", stopped: {self.stopped[0]}"
        return (
            f"<myospring.Beat of {self.cell.name}: {self._facts()}, "
            f"shortens by {shortening:.2f} %{end}>"
        )

    def _repr_svg_(self) -> str:
        return self._native.overview_svg()

    def _repr_html_(self) -> str:
        title = f"{self.cell.name}, {self._facts()}"
        rows = "".join(
            f"<tr><td>{name.replace('_', ' ')}</td><td>{self.metrics[name]:.4g} {self.units[name]}</td></tr>"
            for name in _SHOWN
            if name in self.metrics
        )
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        if self.about_model is not None:
            warnings += f"<p>{html.escape(self.about_model)}</p>"
        return f"<div><b>{html.escape(title)}</b>{self._repr_svg_()}<table>{rows}</table>{warnings}</div>"

    def __reduce__(self) -> tuple[Any, tuple[Cell, bytes]]:
        return _restored, (self.cell, self._native.state())


class Page:
    """A self-contained HTML page; notebooks show it.

    Attributes
    ----------
    text : str
        HTML of the page.
    """

    def __init__(self, text: str, title: str) -> None:
        self.text = text
        self._title = title

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        # The height fits the content at this width, so that nothing is cut.
        fit = (
            "const f=this;let w=0;new ResizeObserver(()=>{if(f.clientWidth!==w){w=f.clientWidth;f.style.height='900px';"
            "f.style.height=f.contentDocument.body.scrollHeight+'px'}}).observe(f)"
        )
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" onload="{html.escape(fit)}" '
            f'style="border:0;width:100%;height:900px" title="{html.escape(self._title)}"></iframe>'
        )


def _restored(cell: Cell, state: bytes) -> Beat:
    return Beat(cell, _native.Beat.of_state(cell._native, state))


class SimulationError(RuntimeError):
    """A run that stopped before its end.

    Attributes
    ----------
    time_ms : float or None
        Time of the stop on the run's clock; None if a cell model failed without stating a time.
    beat : Beat
        Results up to the stop.
    """

    def __init__(self, message: str, time_ms: float | None, beat: Beat) -> None:
        super().__init__(message, time_ms, beat)
        self.time_ms = time_ms
        self.beat = beat

    def __str__(self) -> str:
        return str(self.args[0])


def run(cell: Cell | None, given: dict[str, Any], threads: int | None, progress: Progress) -> Beat:
    """Returns the beat of a cell, or raises the error that stopped it."""
    cell = cell_of(cell)
    return ended(Beat(cell, _native.simulate(cell._native, given, threads, heard(progress))))


def ended(beat: Beat) -> Beat:
    """Returns a finished beat after issuing its warnings, or raises the error that stopped it."""
    # The warnings of the cell were issued when it was created.
    warn(text for text in beat.warnings if text not in beat.cell.warnings)
    if beat.stopped is not None:
        message, time_ms = beat.stopped
        raise SimulationError(message, time_ms, beat)
    return beat
