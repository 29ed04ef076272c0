"""RRTConnect of OMPL: a planner for `wildfire`, a program that reads queries from stdin and answers on stdout.

It needs `pip install ompl==2.0.1`. OMPL searches over Reeds-Shepp curves of the truck's turning radius; this program
tests whether they are free. Generators are seeded, and a query ends after a number of checks, not by time. Goals are
poses. Licence: CC0-1.0.
"""
import json
import math
import sys

from ompl import base, geometric, util

CHECKS = 10_000  # of OMPL's condition to stop, in a query
ROUNDS = 20  # of shortening
MARGIN = 0.05  # m kept from bushes and border
FAR = 2.0  # m; gaps are measured up to here


class Field:
    def __init__(self, message):
        self.seed, self.cell = message["seed"], message["cell_m"]
        self.size = message["cols"] * self.cell, message["rows"] * self.cell
        self.bushes = {tuple(bush) for bush in message["cells_cr"]}
        car = message["vehicle"]
        self.radius = car["min_turn_radius"]
        self.long, self.wide = car["length"] / 2, car["width"] / 2
        self.ahead = self.long - car["rear_overhang"]  # from the rear axle to the centre of the body
        # No point of the body moves farther than this while the rear axle moves 1 m.
        self.stretch = math.hypot(1 + self.wide / self.radius, (self.ahead + self.long) / self.radius)
        self.near = {}

    def bushes_near(self, col, row):
        """Lists the centres of bushes that may be within FAR of a body whose centre is in a cell."""
        if (col, row) not in self.near:
            ring = math.ceil((math.hypot(self.long, self.wide) + FAR) / self.cell)
            cells = [(col + dc, row + dr) for dc in range(-ring, ring + 1) for dr in range(-ring, ring + 1)]
            self.near[col, row] = [tuple((i + 0.5) * self.cell for i in cell) for cell in cells if cell in self.bushes]
        return self.near[col, row]

    def gap(self, state):
        """Returns a lower bound on the distance from the body to bushes and border, by the separating axis theorem."""
        cos, sin, half = math.cos(state.getYaw()), math.sin(state.getYaw()), self.cell / 2
        x, y = state.getX() + self.ahead * cos, state.getY() + self.ahead * sin
        east = self.long * abs(cos) + self.wide * abs(sin)
        north = self.long * abs(sin) + self.wide * abs(cos)
        turned = half * (abs(cos) + abs(sin))
        gap = min(x - east, y - north, self.size[0] - x - east, self.size[1] - y - north, FAR)
        for bush_x, bush_y in self.bushes_near(int(x // self.cell), int(y // self.cell)):
            dx, dy = bush_x - x, bush_y - y
            gap = min(gap, max(
                abs(dx) - east - half,
                abs(dy) - north - half,
                abs(dx * cos + dy * sin) - self.long - turned,
                abs(dy * cos - dx * sin) - self.wide - turned,
            ))
        return gap


class CurveIsFree(base.MotionValidator):
    """The gap at a pose proves how far the next part of the curve is free."""

    def __init__(self, information, field, space):
        super().__init__(information)
        self.field, self.space, self.here, self.curves = field, space, space.allocState(), 0

    def checkMotion(self, begin, end):
        self.curves += 1
        if self.field.gap(end) < MARGIN:
            return False
        length, done = self.space.distance(begin, end), 0.0
        while done < length:
            self.space.interpolate(begin, end, done / length, self.here)
            gap = self.field.gap(self.here)
            if gap < MARGIN:
                return False
            done += gap / self.field.stretch
        return True


def after(checks):
    """Returns a condition that stops OMPL after a number of checks."""
    left = checks

    def is_met():
        nonlocal left
        left -= 1
        return left < 0

    return base.PlannerTerminationCondition(is_met)


def plan(field, start, goal):
    """Returns poses to the goal, joined by shortest Reeds-Shepp curves, or None, and the number of curves tested."""
    space = base.ReedsSheppStateSpace(field.radius)
    bounds = base.RealVectorBounds(2)
    for axis, size in enumerate(field.size):
        bounds.setLow(axis, 0.0)
        bounds.setHigh(axis, size)
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(lambda state: field.gap(state) >= MARGIN)
    validator = CurveIsFree(information, field, space)
    information.setMotionValidator(validator)
    ends = []
    for x, y, heading in (start, goal):
        state = space.allocState()
        state.setX(x)
        state.setY(y)
        state.setYaw(math.remainder(heading, math.tau))
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(information))
    setup.solve(after(CHECKS))
    if not setup.haveExactSolutionPath():
        return None, validator.curves
    path = setup.getSolutionPath()
    geometric.PathSimplifier(information).simplify(path, after(ROUNDS))
    return [[state.getX(), state.getY(), state.getYaw()] for state in path.getStates()][1:], validator.curves


def main():
    util.setLogLevel(util.LogLevel.LOG_NONE)
    field = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "hello":
            answer = {"type": "hello", "protocol": 1, "name": "ompl-rrt-connect", "version": "2.0.1"}
        elif message["type"] == "field":
            field, answer = Field(message), {"type": "ready"}
        elif message["type"] == "plan":
            util.RNG.setSeed(field.seed % (2**31 - 1) + 1)
            poses, curves = plan(field, message["start"], message["goal"]["pose"])
            answer = {"type": "none", "reason": "budget-spent"} if poses is None else {"type": "path", "poses": poses}
            answer.update(id=message["id"], expansions=curves)
        else:
            break
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
