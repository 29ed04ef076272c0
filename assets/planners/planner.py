#!/usr/bin/env python3
"""A planner for `wildfire`: an RRT of motions that the truck can drive, in plain Python.

Try it:      wildfire run contest --command mine='python3 FILE' --set unimog.planner=mine
Compare it:  wildfire plan --planner mine,prm-rs --command mine='python3 FILE' --goals 20

The simulation writes a question a line to stdin, this program an answer a line to stdout, both JSON. Whatever you print
for yourself goes to stderr. Metres; radians counter-clockwise from east; a pose is that of the middle of the rear axle.
`wildfire schema planner-protocol` describes every message.
"""
import json
import math
import random
import sys


def say(message):
    print(json.dumps(message), flush=True)  # without flush the simulation would wait for ever


class Field:
    def __init__(self, message):
        self.cell = message["cell_m"]
        self.width, self.height = message["cols"] * self.cell, message["rows"] * self.cell
        self.bushes = {tuple(cell) for cell in message["cells_cr"]}
        vehicle = message["vehicle"]
        self.radius = vehicle["min_turn_radius"]
        self.to_centre = vehicle["length"] / 2 - vehicle["rear_overhang"]  # from the rear axle forward
        self.length, self.half_width = vehicle["length"], vehicle["width"] / 2
        # The body as three discs that cover it, with a margin for what lies between two poses that are checked.
        self.disc = math.hypot(self.length / 6, self.half_width) + 0.3
        self.seed = message["seed"]

    def is_free(self, pose):
        """Says whether the body keeps clear of bushes and border. It is stricter than it must be, never less strict."""
        x, y, heading = pose
        for third in (-1, 0, 1):
            along = self.to_centre + third * self.length / 3
            if not self.disc_is_free(x + along * math.cos(heading), y + along * math.sin(heading)):
                return False
        return True

    def disc_is_free(self, x, y):
        r = self.disc
        if not (r < x < self.width - r and r < y < self.height - r):
            return False
        for col in range(int((x - r) // self.cell), int((x + r) // self.cell) + 1):
            for row in range(int((y - r) // self.cell), int((y + r) // self.cell) + 1):
                if (col, row) in self.bushes:
                    # The point of the bush's cell that is nearest to the disc's centre.
                    near_x = min(max(x, col * self.cell), (col + 1) * self.cell)
                    near_y = min(max(y, row * self.cell), (row + 1) * self.cell)
                    if math.hypot(x - near_x, y - near_y) < r:
                        return False
        return True

    def drive(self, pose, curvature, length, step=0.4):
        """Returns the pose after a motion of constant curvature, or None if something is in the way."""
        steps = max(1, math.ceil(abs(length) / step))
        for number in range(1, steps + 1):
            after = move(pose, curvature, length * number / steps)
            if not self.is_free(after):
                return None
        return after


def move(pose, curvature, length):
    """Returns the pose after a motion: an arc, or a straight if the curvature is 0; backwards if the length is negative."""
    x, y, heading = pose
    turned = heading + curvature * length
    if curvature == 0:
        return (x + length * math.cos(heading), y + length * math.sin(heading), heading)
    x += (math.sin(turned) - math.sin(heading)) / curvature
    y -= (math.cos(turned) - math.cos(heading)) / curvature
    return (x, y, turned)


def place_of(field, pose, goal):
    """Returns the point of the truck that counts for a goal: its centre for a disc, its rear axle for a pose."""
    if "pose" in goal:
        return pose[:2]
    return (pose[0] + field.to_centre * math.cos(pose[2]), pose[1] + field.to_centre * math.sin(pose[2]))


def is_in_goal(field, pose, goal):
    if "pose" in goal:  # this planner ends in poses only by luck; the rules allow 1 mm and 0.001 rad
        x, y, heading = goal["pose"]
        turned = math.remainder(pose[2] - heading, math.tau)
        return math.hypot(pose[0] - x, pose[1] - y) < 0.001 and abs(turned) < 0.001
    x, y, radius = goal["disc"]
    centre = place_of(field, pose, goal)
    return math.hypot(centre[0] - x, centre[1] - y) < radius - 0.01


def plan(field, start, goal, iterations, rng):
    """Grows a tree of poses from the start, by motions towards random points, until one is in the goal."""
    start = tuple(start)
    target = goal.get("disc") or goal["pose"]
    if is_in_goal(field, start, goal):
        return [], 0
    tree = [(start, None, None)]  # pose, index of the pose before, motion from there
    motions = [(curvature, length) for curvature in (0, 1 / field.radius, -1 / field.radius) for length in (4, -4)]
    for iteration in range(iterations):
        if rng.random() < 0.2:
            point = (target[0], target[1])
        else:
            point = (rng.uniform(0, field.width), rng.uniform(0, field.height))

        def distance(pose):
            x, y = place_of(field, pose, goal)
            return math.hypot(x - point[0], y - point[1])

        # From the pose of the tree that is nearest to the point, the motion that brings it nearest.
        nearest = min(range(len(tree)), key=lambda index: distance(tree[index][0]))
        ends = [(field.drive(tree[nearest][0], *motion), motion) for motion in motions]
        ends = [(end, motion) for end, motion in ends if end is not None]
        if not ends:
            continue
        end, motion = min(ends, key=lambda it: distance(it[0]))
        tree.append((end, nearest, motion))
        if is_in_goal(field, end, goal):
            segments, index = [], len(tree) - 1
            while tree[index][1] is not None:
                segments.append(list(tree[index][2]))
                index = tree[index][1]
            return segments[::-1], iteration + 1
    return None, iterations


def main():
    field = settings = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "hello":
            say({"type": "hello", "protocol": 1, "name": "rrt", "version": "1"})
        elif message["type"] == "field":
            field, settings = Field(message), message["settings"] or {}
            say({"type": "ready"})
        elif message["type"] == "plan":
            # A seed for each query, and a budget that is counted: the same question gets the same answer on any machine.
            rng = random.Random(f"{field.seed} {message['start']} {message['goal']}")
            budget = settings.get("iterations", 1500)
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
