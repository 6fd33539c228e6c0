"""The program ``myospring``, as it is without Python."""

from __future__ import annotations

import signal
import sys

from myospring import _native


def main() -> int:
    """Runs the program with the arguments of the command line.

    Returns
    -------
    int
        The code to exit with: 0 is success.
    """
    # Signals are the program's own business, not the interpreter's, which would hear of them only afterwards.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["myospring", *sys.argv[1:]])
