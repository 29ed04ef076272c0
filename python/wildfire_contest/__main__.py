"""The program `wildfire`, as the console script and as ``python -m wildfire_contest``."""

from __future__ import annotations

import sys

from wildfire_contest._core import command_line


def run() -> int:
    """Do what the arguments of the process say and return the exit code."""
    return command_line(["wildfire", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(run())
