"""Compares the rates of published cell models at their start with Myokit's; prints a table in Markdown.

    pip install myokit==1.39.2
    python verification/cell-models/compare_rates.py target/release/myospring FOLDER...

Folders: clones of https://github.com/myokit/models and https://github.com/Chaste/cellml. Myokit evaluates a file's own
stimulus, which may be on at 0 ms; it is set to 0 here, as `myospring models FILE --rates` does.
"""

import json
import subprocess
import sys
import warnings
from pathlib import Path

import myokit
import myokit.formats

warnings.simplefilter("ignore")


def reference(path: Path, stimulus: str) -> tuple[list, list, list, float]:
    """Names, start values and rates (per ms) of the states."""
    model = myokit.load_model(path) if path.suffix == ".mmt" else myokit.formats.importer("cellml").model(str(path))
    if stimulus != "added" and not model.get(stimulus).is_state():
        model.get(stimulus).set_rhs(0)
    per_ms = 1e-3 if str(model.time().unit()) == "[s]" else 1.0
    rates = model.evaluate_derivatives(ignore_errors=True)
    return [own.qname() for own in model.states()], model.initial_values(True), [rate * per_ms for rate in rates], per_ms


def difference(program: str, path: Path) -> tuple[int, float]:
    """Number of states, and the largest difference relative to the larger of state and rate."""

    def output(option: str) -> dict:
        done = subprocess.run([program, "models", path, option], capture_output=True, text=True)
        if done.returncode:
            message = " ".join(done.stderr.replace("\u2502", " ").split())
            raise ValueError(message.split(path.name, 1)[-1].strip(" ,:"))
        return json.loads(done.stdout)

    stimulus = output("--json")["roles"][1]["variable"].split()[0]
    own = {state["name"]: state["rate"] for state in output("--rates")["states"]}
    largest = 0.0
    for name, start, rate, in zip(*reference(path, stimulus)[:3]):
        if rate == rate:  # Myokit has no number at a removable singularity.
            largest = max(largest, abs(own[name] - rate) / max(abs(rate), abs(start), 1e-300))
    return len(own), largest


def main() -> None:
    program, *folders = sys.argv[1:]
    paths = [path for folder in folders for ending in ("mmt", "cellml") for path in Path(folder).rglob(f"*.{ending}")]
    print("| model | states | largest difference of rates, or why it is refused |\n|---|---|---|")
    for path in sorted(paths, key=lambda path: (path.suffix, path.name.lower())):
        try:
            states, largest = difference(program, path)
            print(f"| {path.name} | {states} | {largest:.0e} |")
        except ValueError as refused:
            print(f"| {path.name} | | {refused} |")


if __name__ == "__main__":
    main()
