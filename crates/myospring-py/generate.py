"""Writes the signatures and the documentation of all settings into the package, from the library's table of them.

What stands between `# <signature of beat>` and `# </signature>` is made here, and so is, in the documentation of a
function, the run of parameters that such a signature has; all else is written by hand. `python generate.py` writes,
`python generate.py --check` only compares; it needs the package itself.
"""

from __future__ import annotations

import re
import sys
import textwrap
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from typing import Any, Iterable

HERE = Path(__file__).parent
TARGETS = HERE / "python" / "myospring"


def table() -> list[dict[str, Any]]:
    """The settings. The package around the part in Rust is not needed, for it may not be made yet."""
    package = find_spec("myospring")
    spec = PathFinder.find_spec("myospring._native", package.submodule_search_locations)
    native = module_from_spec(spec)
    spec.loader.exec_module(native)
    return native.settings()


ROWS = table()

# Settings of the tables that say what the cell is, and those that make it what a constructor of `Cell` says it is.
OF_CELL = ("shape", "segmentation")
IMAGE = {"label", "rotate_deg", "built_in", "picture", "stack", "z_step_um", "first_slice", "stack_stain"}
# How thick it is, too, which a flat cell needs for its beat alone.
THICK = ("profile", "thickness_um")
OUTLINE = ("pixel_size_um", "cell", "label", "rotate_deg", "spacing_um", "any_size", *THICK)
OF_STACK = (
    "pixel_size_um", "z_step_um", "first_slice", "stack_stain", "spacing_um", "any_size", "modality", "channel", "frame",
    "threshold", "smooth_um", "seed", "cell", "label", "min_area_um2", "max_area_um2", "allow_cut",
)
OF_SLICES = ("z_step_um", "first_slice", "stack_stain")
# Without a mesh nothing else has a place.
OF_POTENTIAL = (
    "model", "parameters", "variables", "myofilaments", "cell_integrator", "cell_step_ms", "cell_tolerance",
    "authors_step", "stimulus_kind", "stimulus_amplitude", "stimulus_duration_ms", "stimulus_start_ms", "beats",
    "cycle_length_ms", "s2_interval_ms", "duration_ms", "output_interval_ms",
)
# What a caller looks for first.
FIRST = ("model", "peak_tension_kpa", "parameters")


def chosen(names: Iterable[str]) -> list[dict[str, Any]]:
    """The rows of these names, of the cell's own tables where there are two."""
    return [next(row for row in ROWS if row["name"] == name and row["key"] != "shape.outline") for name in names]


def of_beat() -> list[dict[str, Any]]:
    rows = [row for row in ROWS if row["table"] not in OF_CELL]
    return sorted(rows, key=lambda row: FIRST.index(row["name"]) if row["name"] in FIRST else len(FIRST))


def of_image() -> list[dict[str, Any]]:
    rows = [row for row in ROWS if row["table"] in OF_CELL and row["name"] not in IMAGE]
    return [row for row in rows if row["key"] != "shape.outline"] + chosen(("thickness_um",))


def of_mask() -> list[dict[str, Any]]:
    names = ("pixel_size_um", "label", "cell", "seed", "channel", "frame", "z", "min_area_um2", "max_area_um2",
             "allow_cut", "spacing_um", "any_size", *THICK)
    return chosen(names)


def literal(row: dict[str, Any]) -> str:
    default = row["default"]
    return f'"{default}"' if isinstance(default, str) else repr(default)


def annotation(row: dict[str, Any]) -> str:
    path = "str | PathLike[str]"
    kinds = {"text": "str", "name-or-file": path, "file": path, "words": "str", "flag": "bool", "whole": "int",
             "quantity": "float", "named": "Mapping[str, float | str]"}
    written = {"segmentation.seed": "tuple[float, float]", "segmentation.cell": "int | str",
               "segmentation.z": "int | str", "stimulus.amplitude": "float | str"}
    kind = kinds.get(row["kind"]) or written.get(row["key"], "str")
    if row["kind"] == "words":
        kind = "Literal[" + ", ".join(f'"{word}"' for word in row["words"]) + "]"
    return kind if row["default"] is not None else f"{kind} | None"


def signature(rows: list[dict[str, Any]], indent: str) -> str:
    return "".join(f"{indent}{row['name']}: {annotation(row)} = {literal(row)},\n" for row in rows)


def sentence(text: str) -> str:
    """Words of run files and of the command line as Python has them."""
    for row in ROWS:
        text = text.replace(f"`{row['key'].split('.')[-1]}`", f"`{row['name']}`")
    text = text.replace("`myospring models` lists them", "`myospring.models()` lists them")
    text = text.replace("`myospring models NAME` lists them", "`myospring.parameters(model)` lists them")
    return text.replace("; relative to this file", "").replace(", relative to this file", "").replace("batch leaves out", "studies leave out")


def documentation(rows: list[dict[str, Any]], indent: str) -> str:
    text = ""
    for row in rows:
        kind = re.sub(r"Literal\[(.*)\]", r"{\1}", annotation(row))
        kind = kind.replace(" | None", " or None").replace(" | ", " or ")
        if row["default"] is not None:
            kind += f", default {literal(row)}"
        about = sentence(row["doc"])
        unit = row["unit"] if row["kind"] == "quantity" else None
        if unit and row["bounds"]:
            about += f" In {unit}, {row['bounds']}."
        elif unit:
            about += f" In {unit}."
        elif row["kind"] in ("quantity", "whole") and row["bounds"]:
            about += f" {row['bounds'][0].upper()}{row['bounds'][1:]}."
        if row["default"] is None and row["otherwise"]:
            about += f" None: {sentence(row['otherwise'])}."
        text += f"{indent}{row['name']} : {kind}\n"
        text += textwrap.fill(about, 100, initial_indent=indent + "    ", subsequent_indent=indent + "    ") + "\n"
    return text


def given(rows: list[dict[str, Any]], indent: str) -> str:
    """What leaves out every value that is the default, as a run file would."""
    text = "".join(f'{indent}    ("{row["key"]}", {row["name"]}, {literal(row)}),\n' for row in rows)
    return f"{indent}given = changed(\n{text}{indent})\n"


def typed(rows: list[dict[str, Any]], indent: str) -> str:
    return "".join(f"{indent}{row['name']}: {annotation(row)}\n" for row in rows)


def keys(rows: list[dict[str, Any]], indent: str) -> str:
    return "".join(f'{indent}"{row["name"]}": ("{row["key"]}", {literal(row)}),\n' for row in rows)


SETS = {
    "beat": of_beat(),
    "image": of_image(),
    # Without `thickness_um`, which is among the settings of a beat.
    "image_and_beat": [row for row in of_image() if row["name"] != "thickness_um"] + chosen(OF_SLICES),
    # Of a film the size of a pixel is an argument of its own, and `fit` has another cell and another seed.
    "film": [row for row in of_image() if row["name"] not in ("pixel_size_um", "cell", "seed")],
    "stack": chosen(OF_STACK),
    "mask": of_mask(),
    "outline": chosen(OUTLINE),
    "built_in": chosen(("rotate_deg", "spacing_um", *THICK)),
    "model": chosen(OF_POTENTIAL[:2]),
    "potential": chosen(OF_POTENTIAL[2:]),
    "model_and_potential": chosen(OF_POTENTIAL),
}
MAKERS = {"signature": signature, "given": given, "typed": typed, "keys": keys}
PART = re.compile(r"^( *)# <(\w+) of (\w+)>\n(.*?)^ *# </\2>\n", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"^ *(\w+): ", re.MULTILINE)


def made(text: str) -> str:
    """A file with every part that is made here made anew."""
    functions = re.split(r"^(?= *def )", text, flags=re.MULTILINE)
    return "".join(PART.sub(part, documented(function)) for function in functions)


def part(match: re.Match[str]) -> str:
    indent, what, of, _ = match.groups()
    return f"{indent}# <{what} of {of}>\n{MAKERS[what](SETS[of], indent)}{indent}# </{what}>\n"


def documented(function: str) -> str:
    """A function with its parameters documented as the table says, where those of its present signature are."""
    signatures = [match for match in PART.finditer(function) if match[2] == "signature"]
    names = "|".join(name for match in signatures for name in NAME.findall(match[4]))
    rows = [row for match in signatures for row in SETS[match[3]]]
    if not rows:
        return function
    entry = re.compile(rf"^( *)(?:{names}) : .*\n(?:\1 +.*\n)+", re.MULTILINE)
    present = list(entry.finditer(function))
    assert present, f"no parameter of {function.splitlines()[0].strip()} is documented"
    first, last = present[0], present[-1]
    return function[: first.start()] + documentation(rows, first[1]) + function[last.end() :]


def main() -> int:
    stale = 0
    for target in sorted(TARGETS.glob("*.py")):
        text = target.read_text()
        if made(text) == text:
            continue
        if "--check" in sys.argv:
            print(f"{target.name} differs from the table of settings: run python {Path(__file__).name}")
            stale = 1
        else:
            target.write_text(made(text))
            print(f"{target.name} written")
    return stale


if __name__ == "__main__":
    sys.exit(main())
