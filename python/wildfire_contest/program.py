"""The program `wildfire` from Python."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    It runs in a separate process that shares the terminal: its output goes to the same place as that of this process, and
        Ctrl-C ends it.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments after the program's name; default: those of this process.

    Returns
    -------
    int
        0 done, 1 some run failed, 2 bad input, 3 environment, 4 violation, 75 resumable, 130 stopped.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    code = subprocess.run([sys.executable, "-m", "wildfire_contest", *words], check=False).returncode
    # For a process ended by a signal, a shell reports 128 plus the signal's number.
    return code if code >= 0 else 128 - code
