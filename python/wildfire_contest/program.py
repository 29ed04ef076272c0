"""The program `wildfire` from Python."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence


def main(argv: Sequence[str] | None = None) -> int:
    """Do what the command line would and return its exit code.

    It runs in a process of its own, which shares the terminal: its output goes where that of this process goes, and
    Ctrl-C ends it as it ends the program.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments after the program's name; those of this process if it is left out.

    Returns
    -------
    int
        0 done, 1 some run failed, 2 bad input, 3 environment, 4 violation, 75 resumable, 130 stopped.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    code = subprocess.run([sys.executable, "-m", "wildfire_contest", *words], check=False).returncode
    # A process that a signal ended has the code that a shell gives it.
    return code if code >= 0 else 128 - code
