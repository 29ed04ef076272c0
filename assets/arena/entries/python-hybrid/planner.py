"""Hybrid A* in plain Python: a planner for `wildfire`, a program that reads queries from stdin and answers on stdout.

It searches over short arcs and straights, forward and in reverse. Every few expansions it tries Dubins curves to the
goal; such curves also shorten the path at the end. Effort is bounded by a number of expansions, not by time. Goals are
poses. Licence: CC0-1.0.
"""
import heapq
import json
import math
import random
import sys

BUDGET = 6000  # expansions of a query
STEP = 5.0  # m, the length of a motion
HEADINGS = 24
GRID = 2.5  # m, side of a cell of the search
WEIGHT = 1.2  # of the heuristic
CUSP = 2.0  # m, cost of a change of direction
MARGIN = 0.05  # m kept from bushes and border
FAR = 2.0  # m; gaps are measured up to here
SHORTCUTS = 300  # attempts to shorten a path


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

    def gap(self, pose):
        """Returns a lower bound on the distance from the body to bushes and border, by the separating axis theorem."""
        cos, sin, half = math.cos(pose[2]), math.sin(pose[2]), self.cell / 2
        x, y = pose[0] + self.ahead * cos, pose[1] + self.ahead * sin
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

    def is_free(self, pose, segments):
        """Returns whether nothing is hit on the way; the gap at a pose proves how far the next part is free."""
        for curvature, length in segments:
            done = 0.0
            while True:
                gap = self.gap(move(pose, curvature, math.copysign(done, length)))
                if gap < MARGIN:
                    return False
                if done >= abs(length):
                    break
                done = min(done + gap / self.stretch, abs(length))
            pose = move(pose, curvature, length)
        return True


def move(pose, curvature, length):
    x, y, heading = pose
    if curvature == 0:
        return x + length * math.cos(heading), y + length * math.sin(heading), heading
    turned = heading + curvature * length
    x += (math.sin(turned) - math.sin(heading)) / curvature
    y -= (math.cos(turned) - math.cos(heading)) / curvature
    return x, y, turned


def end_of(pose, segments):
    for curvature, length in segments:
        pose = move(pose, curvature, length)
    return pose


def length_of(segments):
    return sum(abs(length) for _, length in segments)


def forward_curves(start, end, radius):
    """Lists Dubins curves of an arc, a straight and an arc."""
    curves = []
    for first in (1, -1):
        for last in (1, -1):
            dx = end[0] - last * radius * math.sin(end[2]) - start[0] + first * radius * math.sin(start[2])
            dy = end[1] + last * radius * math.cos(end[2]) - start[1] - first * radius * math.cos(start[2])
            apart, along, straight = math.hypot(dx, dy), math.atan2(dy, dx), math.hypot(dx, dy)
            if first != last:
                if apart < 2 * radius:
                    continue
                along += first * math.asin(2 * radius / apart)
                straight = math.sqrt(apart * apart - 4 * radius * radius)
            one = first * (along - start[2]) % math.tau
            two = last * (end[2] - along) % math.tau
            curve = [(first / radius, one * radius), (0.0, straight), (last / radius, two * radius)]
            curves.append([part for part in curve if 1e-9 < part[1] < math.tau * radius - 1e-9 or part[0] == 0])
    return curves


def shortest_free(field, start, end, most=math.inf):
    """Returns the shortest free Dubins curve below `most` metres, forward or in reverse, or None."""
    curves = forward_curves(start, end, field.radius)
    for curve in forward_curves(end, start, field.radius):
        curves.append([(curvature, -length) for curvature, length in reversed(curve)])
    for curve in sorted(curves, key=length_of):
        if length_of(curve) >= most:
            return None
        if field.is_free(start, curve):
            return curve
    return None


def search(field, start, goal):
    """Returns the segments of a path to a pose, or None, and the number of expansions."""
    def estimate(pose):
        return WEIGHT * math.dist(pose[:2], goal[:2])

    def key(pose):
        return int(pose[0] // GRID), int(pose[1] // GRID), round(pose[2] / math.tau * HEADINGS) % HEADINGS

    # Estimated cost, a number that breaks ties, cost, pose, direction, segments as a linked list.
    queue, closed, count, expansions = [(estimate(start), 0, 0.0, start, 0, None)], set(), 0, 0
    while queue and expansions < BUDGET:
        _, _, cost, pose, direction, path = heapq.heappop(queue)
        if key(pose) in closed:
            continue
        closed.add(key(pose))
        expansions += 1
        if expansions % 4 == 1 or math.dist(pose[:2], goal[:2]) < 30:
            if (curve := shortest_free(field, pose, goal)) is not None:
                before = []
                while path is not None:
                    path, segment = path
                    before.append(segment)
                return before[::-1] + curve, expansions
        for curvature in (0.0, 1 / field.radius, -1 / field.radius):
            for sign in (1, -1):
                segment = curvature, sign * STEP
                after = move(pose, *segment)
                if key(after) in closed or not field.is_free(pose, [segment]):
                    continue
                count += 1
                to = cost + STEP + (CUSP if direction == -sign else 0)
                heapq.heappush(queue, (to + estimate(after), count, to, after, sign, (path, segment)))
    return None, expansions


def split(path, at):
    """Cuts a path after a length."""
    head, tail = [], []
    for curvature, length in path:
        part = min(max(at, 0.0), abs(length))
        at -= abs(length)
        if part > 0:
            head.append((curvature, math.copysign(part, length)))
        if part < abs(length):
            tail.append((curvature, math.copysign(abs(length) - part, length)))
    return head, tail


def shorten(field, start, path, rng):
    """Replaces parts of a path by shorter free curves."""
    for _ in range(SHORTCUTS):
        whole = length_of(path)
        begin, end = sorted(min(max(rng.uniform(-0.2, 1.2), 0.0), 1.0) * whole for _ in range(2))
        head, rest = split(path, begin)
        middle, tail = split(rest, end - begin)
        here = end_of(start, head)
        curve = shortest_free(field, here, end_of(here, middle), length_of(middle) - 0.01)
        if curve is not None:
            path = head + curve + tail
    return path


def main():
    field = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "hello":
            answer = {"type": "hello", "protocol": 1, "name": "python-hybrid", "version": "1"}
        elif message["type"] == "field":
            field, answer = Field(message), {"type": "ready"}
        elif message["type"] == "plan":
            start, goal = message["start"], message["goal"]["pose"]
            path, expansions = search(field, start, goal)
            if path is None:
                answer = {"type": "none", "reason": "budget-spent"}
            else:
                answer = {"type": "path", "segments": shorten(field, start, path, random.Random(field.seed))}
            answer.update(id=message["id"], expansions=expansions)
        else:
            break
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
