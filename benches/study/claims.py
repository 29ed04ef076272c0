#!/usr/bin/env python3
"""Tables of docs/paper/study.md from the rows of its batches: `claims.py planners/runs.csv searches/runs.csv`.

Prints means over seeds: bushes that each planner extinguishes, and whose search takes more CPU time.
"""

import csv
import sys
from collections import defaultdict
from statistics import fmean

PLANNERS = ("prm+primitives", "prm-rs", "hybrid-astar", "lattice")


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if row["status"] == "done"]


def table(rows, title, value, columns, key, digits):
    """Prints the means of `value` by size and coverage, with a column for each value of `key`."""
    cells = defaultdict(list)
    for row in rows:
        cells[float(row["field.size_m"]), float(row["field.coverage"]), row[key]].append(value(row))
    print(f"\n## {title}\n\n| size m | coverage | {' | '.join(columns)} |\n|---:|---:|{'---:|' * len(columns)}")
    for size, coverage in sorted({cell[:2] for cell in cells}):
        means = [fmean(cells[size, coverage, name]) if cells[size, coverage, name] else float("nan") for name in columns]
        print(f"| {size:.0f} | {coverage:.2f} | {' | '.join(f'{mean:.{digits}f}' for mean in means)} |")


def main(planners, searches):
    rows = read(planners)
    for charge, word in (("0", "free"), ("0.0005", "charged")):
        part = [row for row in rows if float(row["unimog.seconds_per_expansion"]) == float(charge)]
        table(part, f"Extinguished, planning {word}", lambda row: float(row["extinguished"]), PLANNERS, "planner", 1)
    free = [row for row in rows if float(row["unimog.seconds_per_expansion"]) == 0]
    table(free, "CPU ms of the truck for each ms of the Wumpus",
          lambda row: float(row["cpu_unimog_total_s"]) / float(row["cpu_wumpus_s"]), PLANNERS, "planner", 1)
    table(free, "CPU ms of the roadmap alone for each ms of the Wumpus",
          lambda row: float(row["cpu_prm_total_s"]) / float(row["cpu_wumpus_s"]), PLANNERS[:2], "planner", 1)
    table(free, "Failed queries in a run",
          lambda row: sum(float(row[name]) for name in row if name.startswith("truck_failed_")), PLANNERS, "planner", 2)
    table(read(searches), "CPU ms of the Wumpus's search", lambda row: 1000 * float(row["cpu_wumpus_s"]),
          ("astar", "wavefront"), "wumpus.planner", 2)


if __name__ == "__main__":
    main(*sys.argv[1:])
