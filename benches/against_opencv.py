#!/usr/bin/env python3
"""Brushfire of this crate against OpenCV's and SciPy's distance transforms, in one run, call by call in turn.

    python3 benches/against_opencv.py [--side 4096] [--rounds 9]

Needs NumPy and OpenCV (`cv2`); SciPy's columns appear where SciPy is installed. All use one thread and are timed by the
CPU clock of that thread; outputs are kept from call to call, except SciPy's distances, which it does not let be kept.
OpenCV writes 32-bit floats (64 MB for 4096 cells a side) or, for the city-block distance, bytes that end at 255; SciPy
writes 32-bit integers; the crate writes 16-bit integers.

Every cell of the crate's result must equal OpenCV's plus one, or the script ends with exit code 1.
"""

import argparse
import contextlib
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import cv2
    import numpy
except ImportError as error:
    sys.exit(f"not compared: {error.name} is not installed for {sys.executable}")
try:
    from scipy.ndimage import distance_transform_cdt
except ImportError:
    distance_transform_cdt = None

KINDS = ["random10", "random30", "blobs", "single", "maze"]
ROOT = Path(__file__).resolve().parent.parent


class Server:
    """The benchmark `grid`, which obeys one-line commands."""

    def __init__(self):
        # Built first, so that what is timed never waits for a compiler.
        subprocess.run(["cargo", "bench", "--bench", "grid", "--no-run"], cwd=ROOT, check=True)
        command = ["cargo", "bench", "--quiet", "--bench", "grid", "--", "--serve"]
        self.process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            sys.exit(f"the benchmark ended at `{command}`")
        return answer.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=4096, help="rows and columns of the maps")
    parser.add_argument("--rounds", type=int, default=9, help="calls of each function on each map")
    options = parser.parse_args()
    if distance_transform_cdt is None:
        print("SciPy is not installed: its columns are left out")
    cv2.setNumThreads(1)
    print(f"OpenCV {cv2.__version__}, {options.side} x {options.side} cells, medians of {options.rounds} calls in turn")
    print(f"{'map':10} {'neighbours':10} {'wildfire':>11}  peers: ms (times slower)")
    server = Server()
    differences = 0
    for kind in KINDS:
        free = draw(server, kind, options.side)
        for neighbours in (4, 8):
            medians = measure(server, free, neighbours, options.rounds)
            print(f"{kind:10} {neighbours:10} {row(medians)}")
            differing = compare(server, free, neighbours)
            if differing:
                print(f"{kind}, {neighbours} neighbours: {differing} cells differ from OpenCV's plus one")
            differences += differing
    cells = 2 * len(KINDS) * options.side**2
    print(f"{differences} of {cells} cells differ from OpenCV's plus one")
    sys.exit(1 if differences else 0)


def draw(server, kind, side):
    """The map as OpenCV wants it: 0 where occupied, 1 where free."""
    server.ask(f"draw {kind} {side}")
    with scratch_file() as file:
        server.ask(f"save {file}")
        occupied = numpy.fromfile(file, dtype=numpy.uint8).reshape(side, side)
    return 1 - occupied


def peers(free, neighbours):
    """Functions to time by their name; each returns its distances."""
    metric = cv2.DIST_L1 if neighbours == 4 else cv2.DIST_C
    floats = numpy.empty(free.shape, numpy.float32)
    found = {"OpenCV 32F": lambda: cv2.distanceTransform(free, metric, 3, floats, cv2.CV_32F)}
    if neighbours == 4:
        # Bytes are offered for the city-block distance alone.
        octets = numpy.empty(free.shape, numpy.uint8)
        found["OpenCV 8U"] = lambda: cv2.distanceTransform(free, metric, 3, octets, cv2.CV_8U)
    if distance_transform_cdt is not None:
        name = "taxicab" if neighbours == 4 else "chessboard"
        found["SciPy"] = lambda: distance_transform_cdt(free, metric=name)
    return found


def measure(server, free, neighbours, rounds):
    """Median milliseconds by name, ours first."""
    functions = peers(free, neighbours)
    times = {name: [] for name in ["wildfire", *functions]}
    # One round more than asked for: the first only warms.
    for _ in range(rounds + 1):
        times["wildfire"].append(float(server.ask(f"brushfire {neighbours}")))
        for name, function in functions.items():
            start = time.thread_time()
            function()
            times[name].append((time.thread_time() - start) * 1e3)
    return {name: statistics.median(spans[1:]) for name, spans in times.items()}


def row(medians):
    ours = medians["wildfire"]
    others = [(name, ms) for name, ms in medians.items() if name != "wildfire"]
    return f"{ours:8.2f} ms  " + "  ".join(f"{name} {ms:6.1f} ({ms / ours:4.1f})" for name, ms in others)


def compare(server, free, neighbours):
    """Number of cells in which ours is not OpenCV's plus one."""
    distances = peers(free, neighbours)["OpenCV 32F"]()
    with scratch_file() as file:
        (distances + 1).astype("<u2").tofile(file)
        return int(server.ask(f"compare {file}"))


@contextlib.contextmanager
def scratch_file():
    """A file name for the time of a `with`."""
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder) / "map"


if __name__ == "__main__":
    main()
