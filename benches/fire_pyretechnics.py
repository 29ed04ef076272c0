#!/usr/bin/env python3
"""A fire of this program against pyretechnics' level set, on the same landscape in one run: CPU time by burned cell.

    python3 benches/fire_pyretechnics.py [--side 400] [--rounds 3] [--wildfire target/release/wildfire]

The first call makes a virtual environment (--venv) and installs pyretechnics into it, which compiles for some minutes.
The landscape is grass (GR2) on a slope with a road that has gaps and a wind that turns half-way; the fire is lit in its
middle and burns for as long as it takes to come near the edge. Both run on one thread; what counts is the CPU time of
the spread alone, without start and files. The burned areas are compared too: a ratio of fires that differ says nothing.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CELL_M = 5
WIND_KM_H = 10
FUEL, ROAD = 102, 91
SLOPE, ASPECT = 0.2, 180
MOISTURE = (0.06, 0.07, 0.08, 0.60, 0.90)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=400, help="rows and columns")
    parser.add_argument("--rounds", type=int, default=3, help="fires of each")
    parser.add_argument("--wildfire", type=Path, default=ROOT / "target/release/wildfire", help="the program")
    parser.add_argument("--venv", type=Path, default=ROOT / "target/pyretechnics", help="where pyretechnics is installed")
    options = parser.parse_args()
    if not options.wildfire.exists():
        sys.exit(f"there is no {options.wildfire}: build it with `cargo build --release`, or name it with --wildfire")
    python = options.venv / "bin/python"
    if Path(sys.prefix).resolve() != options.venv.resolve():
        if not python.exists():
            venv.create(options.venv, with_pip=True)
        installed = subprocess.run([python, "-c", "import pyretechnics"], capture_output=True).returncode == 0
        if not installed:
            subprocess.run([python, "-m", "pip", "install", "--quiet", "pyretechnics"], check=True)
        sys.exit(subprocess.run([python, *sys.argv]).returncode)
    compare(options)


def compare(options):
    # Uphill and with the wind in turn the head does about 4 m/min.
    minutes = 0.35 * options.side * CELL_M / 4
    fuel = landscape(options.side)
    times = {"wildfire": [], "pyretechnics": []}
    burned = {}
    for _ in range(options.rounds):
        for name, burn in (("wildfire", burn_wildfire), ("pyretechnics", burn_pyretechnics)):
            cells, seconds = burn(options, fuel, minutes)
            burned[name] = cells
            times[name].append(seconds * 1e6 / len(cells))
    ours, theirs = (statistics.median(times[name]) for name in ("wildfire", "pyretechnics"))
    both, either = burned["wildfire"] & burned["pyretechnics"], burned["wildfire"] | burned["pyretechnics"]
    print(f"{options.side} x {options.side} cells of {CELL_M} m, {minutes:.0f} min, medians of {options.rounds} fires each")
    print(f"wildfire      {ours:7.2f} us per burned cell, {len(burned['wildfire'])} cells")
    print(f"pyretechnics  {theirs:7.2f} us per burned cell, {len(burned['pyretechnics'])} cells")
    print(f"{theirs / ours:.1f} times; intersection over union of the burned areas {len(both) / len(either):.3f}")
    sys.exit(0 if len(both) > 0.9 * len(either) else 1)


def landscape(side):
    """Rows of fuel numbers from the south."""
    rows = [[FUEL] * side for _ in range(side)]
    for row in range(side):
        if row % 40 != 0:
            rows[row][side * 5 // 8] = ROAD
    return rows


def burn_wildfire(options, fuel, minutes):
    """Burned cells as (row, column), and CPU seconds."""
    with tempfile.TemporaryDirectory() as folder:
        raster, arrival = Path(folder) / "fuel.asc", Path(folder) / "arrival.asc"
        head = f"ncols {options.side}\nnrows {options.side}\nxllcorner 0\nyllcorner 0\ncellsize {CELL_M}\n"
        raster.write_text(head + "\n".join(" ".join(map(str, row)) for row in reversed(fuel)) + "\n")
        wind = WIND_KM_H / 3.6
        command = [options.wildfire, "fire", "spread", "--fuel", raster, "--slope", SLOPE, "--aspect", ASPECT]
        command += ["--moisture", ",".join(map(str, MOISTURE)), "--duration", minutes * 60, "--arrival", arrival]
        command += ["--wind", f"0:{wind}@270,{minutes * 30}:{wind}@180", "--json"]
        command += ["--ignite", f"{options.side // 2},{options.side // 2}"]
        answer = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if answer.returncode != 0:
            sys.exit(answer.stderr)
        lines = [line.split() for line in arrival.read_text().splitlines() if line[0] in "-0123456789"]
    cells = {
        (options.side - 1 - line, col) for line, row in enumerate(lines) for col, time in enumerate(row) if float(time) >= 0
    }
    return cells, json.loads(answer.stdout)["cpu_s"]


def burn_pyretechnics(options, fuel, minutes):
    """The same by the level set of pyretechnics, compiled."""
    import time

    import numpy
    import pyretechnics.eulerian_level_set as level_set
    from pyretechnics.space_time_cube import SpaceTimeCube

    shape = (2, options.side, options.side)
    values = {"slope": SLOPE, "aspect": ASPECT, "canopy_cover": 0, "canopy_height": 0, "canopy_base_height": 0}
    values |= {"canopy_bulk_density": 0, "wind_speed_10m": WIND_KM_H, "foliar_moisture": 0.9}
    names = ["dead_1hr", "dead_10hr", "dead_100hr", "live_herbaceous", "live_woody"]
    values |= {f"fuel_moisture_{name}": moisture for name, moisture in zip(names, MOISTURE)}
    cubes = {name: SpaceTimeCube(shape, value) for name, value in values.items()}
    cubes["upwind_direction"] = SpaceTimeCube(shape, numpy.array([270.0, 180.0], dtype=numpy.float32).reshape(2, 1, 1))
    cubes["fuel_model"] = SpaceTimeCube(shape, numpy.array(fuel, dtype=numpy.float32))
    state = level_set.SpreadState(shape).ignite_cell((options.side // 2, options.side // 2))
    start = time.thread_time()
    level_set.spread_fire_with_phi_field(
        cubes,
        state,
        cube_resolution=(minutes / 2, CELL_M, CELL_M),
        start_time=0,
        max_duration=minutes,
    )
    seconds = time.thread_time() - start
    arrived = numpy.asarray(state.get_full_matrices(["time_of_arrival"])["time_of_arrival"])
    return {(int(row), int(col)) for row, col in zip(*numpy.nonzero(arrived >= 0))}, seconds


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
