#!/usr/bin/env python3
"""Drives of OMPL's planners beside those of the program's own: success and quality over CPU time.

    python3 benches/against_ompl/measure.py --program target/release/wildfire --csv ompl.csv --svg ompl.svg

Needs Python 3.9, a C++ compiler and OMPL's headers (Debian: `g++`, `libompl-dev`). `planner.cpp` is built and asked by
`wildfire plan` like any other program that plans (docs/own-planner.md): fields, goals, lower bounds, CPU clock, gate and
audit are the same for all. Every coverage has `--fields` fields of the scenario `drives`, seeds 1, 2, ..., and on each
`--goals` random poses; a field's seed is also that of all planners.

It ends with exit code 1 if a path has a violation or is refused, if a planner of ours that should reach every goal does not,
or if OMPL reaches so little that the comparison must be at fault; with 77 if OMPL or the compiler is not there.
"""

import argparse
import csv
import glob
import json
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from statistics import fmean, median

import picture

HERE = Path(__file__).resolve().parent
NOT_THERE = 77
COVERAGES = (0.1, 0.2)
BUDGETS_S = (0.001, 0.01, 0.1, 1.0)
# By the names that the program knows them by.
OMPL = {
    "rrtconnect": "RRTConnect",
    "rrtconnect-simplified": "RRTConnect+simplified",
    "prmstar": "PRMstar+simplified",
    "rrtstar": "RRTstar+simplified",
    "bitstar": "BITstar+simplified",
    "aitstar": "AITstar+simplified",
}
USUAL = "usual settings"
# Settings of our planners, from little effort to much, and from little clearance to much.
OURS = {
    "hybrid-astar": {
        "effort": [
            "hybrid.shortcuts=0",
            "",
            "hybrid.shortcuts=1000 hybrid.pulls=10",
            "hybrid.shortcuts=10000 hybrid.pulls=100",
        ],
        "clearance": [f"hybrid.clearance_m={metres}" for metres in (0.1, 0.3, 0.75, 1.25, 2)],
    },
    "prm-rs": {
        "effort": [
            "prm_rs.samples=50 prm_rs.shortcuts=0",
            "",
            "prm_rs.samples=1000 prm_rs.shortcuts=1000 prm_rs.pulls=10",
            "prm_rs.samples=5000 prm_rs.shortcuts=10000 prm_rs.pulls=100",
        ],
        "clearance": [f"prm_rs.clearance_m={metres}" for metres in (0.1, 0.3, 0.6, 1.25, 2)],
    },
    "prm+primitives": {"effort": [""]},
    "lattice": {"effort": [""]},
}
# With their usual settings these reach every goal.
SURE = ("hybrid-astar", "prm-rs", "lattice")
# RRTConnect reaches at least this share with the largest budget, or something is wrong with how it is asked.
LEAST_OF_RRTCONNECT = 0.9


@dataclass
class Row:
    """What a planner with a budget or with settings did on the fields of one coverage."""

    coverage: float
    planner: str
    kind: str  # "budget", "effort" or "clearance": what is varied
    setting: str
    queries: int
    success: float
    cpu_mean_s: float
    cpu_median_s: float
    build_mean_s: float
    # Of the drives that were found; empty where there are none.
    length_over_bound_mean: float
    length_over_bound_median: float
    clearance_median_m: float
    cusps_mean: float


def main():
    options = arguments()
    with tempfile.TemporaryDirectory() as folder:
        planner = build(Path(folder))
        reports = ask_all(options, planner)
    complaints = []
    rows = []
    for coverage in options.coverage:
        rows += rows_of(coverage, [report for report in reports if report["coverage"] == coverage], complaints)
    complaints += failures_of(rows)
    print_table(rows)
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([field.name for field in fields(Row)])
            writer.writerows(map(astuple, rows))
    if options.svg:
        Path(options.svg).write_text(picture.draw(rows), encoding="utf-8")
    for complaint in complaints:
        print(f"FAILED: {complaint}", file=sys.stderr)
    sys.exit(1 if complaints else 0)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/wildfire", help="the program that is measured")
    parser.add_argument("--fields", type=int, default=10, help="fields of each coverage")
    parser.add_argument("--goals", type=int, default=5, help="goals on each field")
    parser.add_argument("--coverage", type=float, nargs="+", default=COVERAGES, help="shares of the cells under bushes")
    parser.add_argument("--budgets", type=float, nargs="+", default=BUDGETS_S, help="CPU seconds of a query of OMPL")
    parser.add_argument("--jobs", type=int, default=2, help="fields that are measured at the same time")
    parser.add_argument("--csv", help="write the rows")
    parser.add_argument("--svg", help="draw the rows")
    return parser.parse_args()


def build(folder):
    """The program that asks OMPL."""
    compiler = shutil.which("g++") or shutil.which("c++")
    headers = sorted(path for path in glob.glob("/usr/include/ompl*") + glob.glob("/usr/local/include/ompl*")
                     if Path(path, "ompl/config.h").is_file())
    if not compiler or not headers:
        print("not compared: there is no C++ compiler, or no OMPL (Debian: g++, libompl-dev)")
        sys.exit(NOT_THERE)
    program = folder / "planner"
    command = [compiler, "-O2", "-std=c++17", "-isystem", headers[-1], "-isystem", "/usr/include/eigen3",
               HERE / "planner.cpp", "-o", program, "-lompl"]
    subprocess.run(command, check=True)
    return program


def ask_all(options, planner):
    """Reports of `wildfire plan`: OMPL's of each field and budget, and ours of each field and setting."""
    asked = []
    for coverage in options.coverage:
        for seed in range(1, options.fields + 1):
            # The longest first, so that no core waits at the end.
            for budget_s in sorted(options.budgets, reverse=True):
                commands = [f"--command={name}={planner} {ompl} {budget_s}" for name, ompl in OMPL.items()]
                asked.append((coverage, seed, "budget", f"{budget_s:g}", [*OMPL], commands))
            for name, kinds in OURS.items():
                for kind, settings in kinds.items():
                    for setting in settings:
                        changes = [f"--set=unimog.{change}" for change in setting.split()]
                        asked.append((coverage, seed, kind, setting or USUAL, [name], changes))
    asked.sort(key=lambda question: -float(question[3]) if question[2] == "budget" else 0)

    def ask(question):
        coverage, seed, kind, setting, names, further = question
        command = [options.program, "plan", "--json", f"--seed={seed}", f"--goals={options.goals}",
                   f"--set=field.coverage={coverage}", f"--planner={','.join(names)}", *further]
        answer = subprocess.run(command, capture_output=True, text=True)
        # 4 says that a path has a violation, which is counted below.
        if answer.returncode not in (0, 4):
            sys.exit(f"{' '.join(command)}\nended with code {answer.returncode}\n{answer.stderr}")
        return {"coverage": coverage, "seed": seed, "kind": kind, "setting": setting, **json.loads(answer.stdout)}

    with ThreadPoolExecutor(options.jobs) as pool:
        return list(pool.map(ask, asked))


def rows_of(coverage, reports, complaints):
    """A row for each planner and setting, in the order in which they were asked."""
    drives = {}
    for report in reports:
        for drive in report["rows"]:
            complaint = drive["violation"] or drive["reason"]
            if complaint not in (None, "budget spent", "disconnected"):
                where = f"coverage {coverage}, seed {report['seed']}, goal {drive['goal']}"
                complaints.append(f"{where}: {drive['planner']}, {report['setting']}: {complaint}")
            drives.setdefault((drive["planner"], report["kind"], report["setting"]), []).append(drive)

    def row(planner, kind, setting, drives):
        found = [drive for drive in drives if drive["success"]]

        def over(statistic, member):
            return statistic([drive[member] for drive in found]) if found else None

        cpu = [drive["cpu_query_s"] for drive in drives]
        return Row(coverage, planner, kind, setting, len(drives), len(found) / len(drives), fmean(cpu), median(cpu),
                   fmean(drive["cpu_build_s"] for drive in drives),
                   over(fmean, "lower_bound_ratio"), over(median, "lower_bound_ratio"),
                   over(median, "min_clearance_m"), over(fmean, "cusps"))

    rows = [row(*key, found) for key, found in drives.items()]
    names = [*OMPL, *OURS]
    # Budgets rise in the table; our settings keep their order.
    return sorted(rows, key=lambda row: (names.index(row.planner), float(row.setting) if row.kind == "budget" else 0))


def failures_of(rows):
    """What must not be: a sure planner of ours that fails, or an OMPL that hardly plans."""
    for row in rows:
        where = f"coverage {row.coverage}: {row.planner} reaches {row.success:.0%}"
        if row.planner in SURE and row.setting == USUAL and row.success < 1:
            yield f"{where}, and 100 % were expected"
        largest = max((float(other.setting) for other in rows if other.kind == "budget"), default=0)
        if row.planner == "rrtconnect" and float(row.setting) == largest and row.success < LEAST_OF_RRTCONNECT:
            yield f"{where} within {largest:g} s, and {LEAST_OF_RRTCONNECT:.0%} were expected"


def print_table(rows):
    head = f"{'bushes':>6} {'planner':21} {'budget, settings':54} {'success':>7} {'CPU ms':>8} {'build':>6}"
    print(f"{head} {'len/bound':>9} {'clear. m':>8} {'cusps':>5}")
    for row in rows:
        setting = f"{1000 * float(row.setting):g} ms" if row.kind == "budget" else row.setting
        text = f"{row.coverage:6.0%} {row.planner:21} {setting:54} {row.success:7.0%} {1000 * row.cpu_mean_s:8.2f}"
        text += f" {1000 * row.build_mean_s:6.1f}"
        if row.success > 0:
            text += f" {row.length_over_bound_mean:9.3f} {row.clearance_median_m:8.2f} {row.cusps_mean:5.2f}"
        print(text)


if __name__ == "__main__":
    main()
