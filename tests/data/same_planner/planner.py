"""The planner of `tests/contest/same_planner.rs`, as a class of Python and as a program: `python3 planner.py`.

Drives the shortest curve to the first place about the goal whose cell, and all cells around it, are bare.
"""

import json
import math
import sys

PLACES = [
    (1.0, 0.0, 1.5),
    (0.75, 0.75, 2.25),
    (0.0, 1.0, 3.0),
    (-0.75, 0.75, -2.5),
    (-1.0, 0.0, -1.5),
    (-0.75, -0.75, -0.75),
    (0.0, -1.0, 0.0),
    (0.75, -0.75, 0.75),
]
OUT = 0.75


class FirstPlaceOnCells:
    def __init__(self, cols, rows, cell_m, bushes):
        self.cols, self.rows, self.cell_m, self.bushes = cols, rows, cell_m, bushes

    def is_bare(self, x, y):
        col, row = math.floor(x / self.cell_m), math.floor(y / self.cell_m)
        around = [(c, r) for r in (row - 1, row, row + 1) for c in (col - 1, col, col + 1)]
        return all(0 <= c < self.cols and 0 <= r < self.rows and (c, r) not in self.bushes for c, r in around)

    def end(self, goal_x, goal_y, radius):
        """Return the pose to stop in, or None."""
        for east, north, heading in PLACES:
            x = goal_x + OUT * radius * east
            y = goal_y + OUT * radius * north
            if self.is_bare(x, y):
                return [x, y, heading]
        return None


class FirstPlace:
    """The planner as the package takes it."""

    def __init__(self, site):
        occupied = site.checker.occupied
        bushes = {(int(col), int(row)) for row, col in zip(*occupied.nonzero())}
        self.on_cells = FirstPlaceOnCells(occupied.shape[1], occupied.shape[0], site.checker.cell_m, bushes)

    def plan(self, query):
        import wildfire_contest as wf

        end = self.on_cells.end(query.goal.x, query.goal.y, query.goal.radius)
        if end is None:
            raise wf.NoPath("goal-blocked")
        return [end]


def main():
    """Speak the protocol of programs."""
    on_cells = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "hello":
            answer = {"type": "hello", "protocol": 1, "name": "first-place", "version": "1"}
        elif message["type"] == "field":
            bushes = {tuple(cell) for cell in message["cells_cr"]}
            on_cells = FirstPlaceOnCells(message["cols"], message["rows"], message["cell_m"], bushes)
            answer = {"type": "ready"}
        elif message["type"] == "plan":
            end = on_cells.end(*message["goal"]["disc"])
            answer = {"id": message["id"]}
            if end is None:
                answer.update(type="none", reason="goal-blocked")
            else:
                answer.update(type="path", poses=[end])
        else:
            return
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
