"""Rows of the table, as the Rust side writes them (verification/src/row.rs)."""

import json
import pathlib


def difference(what, against, measured, tolerance, unit, reason, expected=0.0):
    """A number that should be `expected` within `tolerance`."""
    within = abs(measured - expected) <= tolerance  # false for what is not a number
    return {
        "what": what,
        "against": against,
        "measured": float(measured) if measured == measured else None,
        "expected": float(expected),
        "tolerance": float(tolerance),
        "unit": unit,
        "reason": reason,
        "verdict": "pass" if within else "fail",
    }


def skipped(what, against, missing):
    """A comparison that could not be made, and what is missing."""
    return {
        "what": what,
        "against": against,
        "measured": None,
        "expected": None,
        "tolerance": None,
        "unit": "",
        "reason": missing,
        "verdict": "skipped",
    }


def write(folder, check, rows):
    """Writes the rows of a check where `cargo xtask verify` finds them."""
    pathlib.Path(folder, f"{check}.json").write_text(json.dumps(rows, indent=1))
