"""The program `wildfire`, run as a console script or as ``python -m wildfire_contest``."""

from __future__ import annotations

import sys

from wildfire_contest._core import command_line


def run() -> int:
    """Run the program with the arguments of the process and return its exit code."""
    return command_line(["wildfire", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(run())
