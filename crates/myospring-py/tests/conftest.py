"""What the tests share."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import myospring


@pytest.fixture(autouse=True, scope="session")
def heeds_ctrl_c():
    """Python hears of Ctrl-C, and so do programs that it starts, also where whoever runs the tests ignores it (nohup)."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    # None is a handler that Python did not set.
    signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)


@pytest.fixture(scope="session")
def cell() -> myospring.Cell:
    """The built-in cell on a coarse lattice, to be quick."""
    return myospring.Cell.builtin(spacing_um=4)


@pytest.fixture(scope="session")
def beat(cell: myospring.Cell) -> myospring.Beat:
    return myospring.simulate(cell, integrator="quasi-static")


@pytest.fixture(scope="session")
def program() -> str:
    """The program that the same wheel has brought."""
    found = shutil.which("myospring", path=Path(sys.executable).parent)
    assert found is not None
    return found


@pytest.fixture
def run(program: str):
    def run(*arguments: str, **options) -> subprocess.CompletedProcess[str]:
        return subprocess.run([program, *arguments], check=True, capture_output=True, text=True, **options)

    return run
