#!/usr/bin/env python3
"""A planner for `wildfire`: the shortest Reeds-Shepp curve where it is free, otherwise an RRT of such curves.

Try it:      wildfire run contest --command mine='python3 FILE' --set unimog.planner=mine
Compare it:  wildfire plan --planner mine,prm-rs --command mine='python3 FILE' --goals 20

The simulation writes one query per line to stdin, this program writes one answer per line to stdout, both JSON. Print
your own messages to stderr. Metres; radians counter-clockwise from east; a pose is that of the middle of the rear axle.
`wildfire schema planner-protocol` describes every message.
"""
import json
import math
import random
import sys

QUARTER, HALF_TURN, TURN = math.pi / 2, math.pi, math.tau
CURVES = 1000  # tried per query, unless the setting `curves` overrides it; a count is reproducible, time is not
STEP = 15.0  # m, the largest growth of the tree per step
MARGIN = 0.1  # m kept from bushes and border; the rules require 0.01 m
FAR = 2.0  # m; gaps are measured up to here, so that only a few bushes near the truck are checked


def say(message):
    print(json.dumps(message), flush=True)  # without flush the simulation would wait forever


# ---- The field and the truck ----------------------------------------------------------------------------------------


class Field:
    def __init__(self, message):
        self.seed = message["seed"]
        self.cell = message["cell_m"]
        self.width, self.height = message["cols"] * self.cell, message["rows"] * self.cell
        vehicle = message["vehicle"]
        self.radius = vehicle["min_turn_radius"]
        self.half_length, self.half_width = vehicle["length"] / 2, vehicle["width"] / 2
        self.to_centre = self.half_length - vehicle["rear_overhang"]  # from the rear axle forward
        # While the rear axle drives 1 m, no point of the body moves by more than the outer corner does in a turn.
        reach = abs(self.to_centre) + self.half_length
        self.stretch = math.hypot(1 + self.half_width / self.radius, reach / self.radius)
        # For each cell, the centres of the bushes that can be within FAR of a body whose centre is in the cell.
        ring = math.ceil((math.hypot(self.half_length, self.half_width) + FAR) / self.cell)
        self.near = {}
        for col, row in message["cells_cr"]:
            for near_col in range(col - ring, col + ring + 1):
                for near_row in range(row - ring, row + ring + 1):
                    bushes = self.near.setdefault((near_col, near_row), [])
                    bushes.append(((col + 0.5) * self.cell, (row + 0.5) * self.cell))

    def centre(self, pose):
        return (pose[0] + self.to_centre * math.cos(pose[2]), pose[1] + self.to_centre * math.sin(pose[2]))

    def gap(self, pose):
        """Returns a lower bound on the distance from the body to bushes and border, FAR at most; negative if they meet.

        Two rectangles are apart if they are so along a side of one of them (the separating axis theorem), and at least
        as far as along that side.
        """
        (x, y), half = self.centre(pose), self.cell / 2
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        long, wide = self.half_length, self.half_width
        east = long * abs(cos) + wide * abs(sin)  # half the body's extent along the axes of the field
        north = long * abs(sin) + wide * abs(cos)
        gap = min(x - east, self.width - x - east, y - north, self.height - y - north, FAR)
        turned = half * (abs(cos) + abs(sin))  # half a bush's extent along the axes of the body
        for bush_x, bush_y in self.near.get((x // self.cell, y // self.cell), ()):
            dx, dy = bush_x - x, bush_y - y
            apart = max(
                abs(dx) - east - half,
                abs(dy) - north - half,
                abs(dx * cos + dy * sin) - long - turned,
                abs(dy * cos - dx * sin) - wide - turned,
            )
            if apart < gap:
                gap = apart
        return gap


def move(pose, curvature, length):
    """Returns the pose after a motion: an arc, or a straight if the curvature is 0; in reverse if the length is negative."""
    x, y, heading = pose
    if curvature == 0:
        return (x + length * math.cos(heading), y + length * math.sin(heading), heading)
    turned = heading + curvature * length
    x += (math.sin(turned) - math.sin(heading)) / curvature
    y -= (math.cos(turned) - math.cos(heading)) / curvature
    return (x, y, turned)


def length_of(segments):
    return sum(abs(length) for _, length in segments)


def is_in_disc(field, pose, goal):
    """Returns whether the truck's centre is in the goal, if that is a disc; curves to a pose end there anyway."""
    x, y, radius = goal.get("disc", (0, 0, 0))
    return math.dist(field.centre(pose), (x, y)) < radius - 0.01


def drive(field, pose, segments, goal, most=math.inf):
    """Drives along segments until the body is not free, the goal is reached or `most` metres are driven.

    Returns the segments driven, the pose there, and whether the goal or the end of the segments was reached.
    """
    driven, gap = [], field.gap(pose)
    for curvature, length in segments:
        begin, done, sign = pose, 0.0, math.copysign(1, length)
        while done < abs(length):
            if is_there := is_in_disc(field, pose, goal):
                break
            # Nothing can be hit before the gap is used up, so that there is nothing to check on the way there.
            to = min(done + max(gap, MARGIN) / field.stretch, abs(length))
            after = move(begin, curvature, sign * to)
            gap = field.gap(after)
            if gap < MARGIN or to > most:
                break
            pose, done = after, to
        if done > 0:
            driven.append([curvature, sign * done])
        if done < abs(length):
            return driven, pose, is_there
        most -= done
    return driven, pose, True


# ---- Reeds-Shepp curves (Reeds and Shepp, 1990) ---------------------------------------------------------------------


def curves_from_left(x, y, turn):
    """Lists curves from (0, 0, 0) to (x, y, turn) that begin with a left arc, for a turning radius of 1.

    A curve is a list of (side, length): side 1 is a left arc, -1 a right arc, 0 a straight; reverse has negative lengths.
    Every formula solves the same equation. The centre of the first circle is (0, 1), that of the last one follows from the
    goal, and the parts in between lead from one to the other: a straight adds its length times a unit vector, two circles
    that touch add 2. Not every curve here is the shortest of its kind, but each ends in the goal, and the shortest of all
    is among them.
    """
    curves = []

    def add(*parts):
        # Either way round a circle ends in the same pose; the shorter is taken.
        curves.append([(side, math.remainder(length, TURN) if side else length) for side, length in parts])

    # The last circle is to the left of the goal, `d` from the first in the direction `angle`.
    dx, dy = x - math.sin(turn), y - 1 + math.cos(turn)
    d, angle = math.hypot(dx, dy), math.atan2(dy, dx)
    for sign in (1, -1):  # the direction of the straight
        quarter, along = sign * QUARTER, angle if sign > 0 else angle + HALF_TURN
        add((1, along), (0, sign * d), (1, turn - along))
        if d >= 2:  # a quarter circle to the right before or after the straight
            straight = sign * math.sqrt(d * d - 4)
            offset = math.atan2(2, straight)
            head = angle - offset
            add((1, head + quarter), (-1, quarter), (0, straight - 2 * sign), (1, turn - head))
            head = angle + offset
            add((1, head), (0, straight - 2 * sign), (-1, quarter), (1, turn - head + quarter))
        if d <= 4:  # no straight, but a circle that touches both others
            half = sign * math.asin(d / 4)
            first = along + half
            add((1, first), (-1, 2 * half), (1, turn - first + 2 * half))
    # The last circle is to the right of the goal.
    dx, dy = x + math.sin(turn), y - 1 - math.cos(turn)
    d, angle = math.hypot(dx, dy), math.atan2(dy, dx)
    for sign in (1, -1):
        quarter, along = sign * QUARTER, angle if sign > 0 else angle + HALF_TURN
        add((1, along + quarter), (-1, quarter), (0, sign * (d - 2)), (-1, along - turn))
        add((1, along), (0, sign * (d - 2)), (1, quarter), (-1, along + quarter - turn))
        if d >= 2:
            straight = sign * math.sqrt(d * d - 4)
            offset = math.atan2(2, straight)
            head = angle + offset
            add((1, head), (0, straight), (-1, head - turn))
            head = angle - offset  # quarter circles before and after the straight
            add((1, head + quarter), (-1, quarter), (0, straight - 4 * sign), (1, quarter), (-1, head + quarter - turn))
        if d <= 2:  # two circles in between, driven equally far, one forward and one in reverse
            middle, head = sign * math.acos((2 + d) / 4), angle + QUARTER
            add((1, head + middle), (-1, middle), (1, -middle), (-1, head - middle - turn))
        elif d <= 6:  # two circles in between, driven equally far in one direction
            middle = sign * math.acos((20 - d * d) / 16)
            first = angle + QUARTER - math.atan2(2 * math.sin(middle), 4 - 2 * math.cos(middle))
            add((1, first), (-1, middle), (1, middle), (-1, first - turn))
    return curves


def shortest_curve(start, end, radius):
    """Returns the shortest Reeds-Shepp curve between two poses, as segments of curvature and length."""
    dx, dy = (end[0] - start[0]) / radius, (end[1] - start[1]) / radius
    cos, sin = math.cos(start[2]), math.sin(start[2])
    x, y, turn = dx * cos + dy * sin, dy * cos - dx * sin, end[2] - start[2]
    # Curves that begin with a right arc are those to the mirrored end, mirrored.
    left, right = curves_from_left(x, y, turn), curves_from_left(x, -y, -turn)
    curves = left + [[(-side, length) for side, length in curve] for curve in right]
    shortest = min(curves, key=lambda curve: sum(abs(length) for _, length in curve))
    return [[side / radius, length * radius] for side, length in shortest if abs(length) > 1e-9]


# ---- The search -----------------------------------------------------------------------------------------------------


def curves_to_goal(field, pose, goal):
    """Lists shortest curves to a pose, or to a disc: to its centre at eight headings, since any will do there."""
    if "pose" in goal:
        aims = [goal["pose"]]
    else:
        (x, y, _), ahead = goal["disc"], field.to_centre
        headings = [pose[2] + eighth * QUARTER / 2 for eighth in range(8)]
        aims = [(x - ahead * math.cos(heading), y - ahead * math.sin(heading), heading) for heading in headings]
    return [shortest_curve(pose, aim, field.radius) for aim in aims]


def drive_to_goal(field, pose, goal):
    """Returns the shortest free curve from a pose into the goal, or None, and the number of curves tried."""
    curves = curves_to_goal(field, pose, goal)
    drives = [drive(field, pose, segments, goal) for segments in curves]
    return min((driven for driven, _, is_done in drives if is_done), key=length_of, default=None), len(curves)


def plan(field, start, goal, most_curves, rng):
    """Returns the segments of a path from the start into the goal, or None, and the number of curves tried."""
    path, curves = drive_to_goal(field, start, goal)
    if path is not None:
        return path, curves
    x, y = (goal.get("disc") or goal["pose"])[:2]
    spread = 20 + math.dist(start[:2], (x, y)) / 2
    tree = [(start, None, [])]  # pose, index of the pose before, segments from there
    while curves < most_curves:
        # Around start and goal, where the path probably is.
        aim_x = rng.uniform(min(x, start[0]) - spread, max(x, start[0]) + spread)
        aim_y = rng.uniform(min(y, start[1]) - spread, max(y, start[1]) + spread)
        heading = rng.uniform(0, TURN)
        nearest = min(range(len(tree)), key=lambda index: math.dist(tree[index][0][:2], (aim_x, aim_y)))
        towards = shortest_curve(tree[nearest][0], (aim_x, aim_y, heading), field.radius)
        driven, pose, _ = drive(field, tree[nearest][0], towards, goal, STEP)
        curves += 1
        if length_of(driven) < 1:
            continue
        tree.append((pose, nearest, driven))
        path, tried = drive_to_goal(field, pose, goal)
        curves += tried
        if path is not None:
            index = len(tree) - 1
            while index:
                _, before, driven = tree[index]
                path, index = driven + path, before
            return path, curves
    return None, curves


def main():
    field = settings = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "hello":
            say({"type": "hello", "protocol": 1, "name": "rs-rrt", "version": "1"})
        elif message["type"] == "field":
            field, settings = Field(message), message["settings"] or {}
            say({"type": "ready"})
        elif message["type"] == "plan":
            # A seed for each query, and a budget that is counted: the same question gets the same answer on any machine.
            rng = random.Random(f"{field.seed} {message['start']} {message['goal']}")
            budget = settings.get("curves", CURVES)
            segments, expansions = plan(field, message["start"], message["goal"], budget, rng)
            if segments is None:
                answer = {"type": "none", "reason": "budget-spent"}
            else:
                answer = {"type": "path", "segments": segments}
            say({**answer, "id": message["id"], "expansions": expansions})
        elif message["type"] == "end":
            break


if __name__ == "__main__":
    main()
