"""Runs the program ``myospring``, which does not need Python."""

from __future__ import annotations

import signal
import sys

from myospring import _native


def main() -> int:
    """Runs the program with the arguments of the command line.

    Returns
    -------
    int
        Exit code: 0 is success.
    """
    # The program handles signals itself; the interpreter would notice them only after its end.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["myospring", *sys.argv[1:]])
