"""Measure the cost of Python: the overhead of a query through Python, and of the wheel.

    python python/benches/overhead.py [WHEEL]

Prints microseconds of CPU time of a query beyond the planner's own, and the size of a wheel. What building costs is
printed by `.ci/run`.
"""

from __future__ import annotations

import argparse
import pathlib
import sys
import time

import numpy as np

import wildfire_contest as wf

TARGET_US = 20.0
TARGET_MB = 20.0


class Timed:
    """Answers immediately, and sums the time that it works."""

    asked = 0
    own_s = 0.0

    def __init__(self, site: wf.Site) -> None:
        pass

    def plan(self, query: wf.Query) -> None:
        began = time.thread_time()
        Timed.asked += 1
        Timed.own_s += time.thread_time() - began


class Answering(Timed):
    """Does the same, reads the query, and answers with segments that the gate rejects immediately."""

    def plan(self, query: wf.Query) -> list[list[float]]:
        began = time.thread_time()
        Timed.asked += 1
        answer = [[0.0, query.start[0]], [1.0, 1.0]]
        Timed.own_s += time.thread_time() - began
        return answer


def overhead_us(factory: type[Timed]) -> float:
    """Return the microseconds per query beyond the planner's own time, from the CPU time columns."""
    Timed.asked, Timed.own_s = 0, 0.0
    rows = wf.plan(planner="timed", planners={"timed": factory}, goals=5000)
    spent = float(np.sum(rows["cpu_query_s"]))
    assert Timed.asked == rows.rows
    return 1e6 * (spent - Timed.own_s) / Timed.asked


def verdict(found: float, most: float) -> str:
    return "within" if found <= most else "MISSED:"


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("wheel", nargs="?", type=pathlib.Path)
    given = arguments.parse_args()
    met = True
    for name, factory in (("None", Timed), ("segments", Answering)):
        overhead_us(factory)
        found = min(overhead_us(factory) for _ in range(5))
        met &= found <= TARGET_US
        print(f"a query through Python, answered with {name}: {found:.1f} us, {verdict(found, TARGET_US)} {TARGET_US:.0f} us")
    if given.wheel:
        size = given.wheel.stat().st_size / 1e6
        met &= size <= TARGET_MB
        print(f"{given.wheel.name}: {size:.2f} MB, {verdict(size, TARGET_MB)} {TARGET_MB:.0f} MB")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
