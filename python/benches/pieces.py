"""Measure the pieces of docs/python.md beside the pure Python that courses use: ``python pieces.py [RUNS]``.

Prints milliseconds of CPU time, the median of several runs, after a check that both give the same answers.
"""

from __future__ import annotations

import heapq
import statistics
import sys
import time
from collections import deque
from math import acos, asin, atan2, cos, hypot, inf, pi, sin, sqrt, tau

import numpy as np

import wildfire_contest as wf

MOVES = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]


def astar(grid, start, goal):
    """Return the length of a shortest path over the free cells of a list of rows, by A* with octile distances."""
    rows, cols = len(grid), len(grid[0])

    def estimate(row, col):
        a, b = abs(row - goal[0]), abs(col - goal[1])
        return max(a, b) + (sqrt(2) - 1) * min(a, b)

    costs, closed, queue = {start: 0.0}, set(), [(estimate(*start), start)]
    while queue:
        _, cell = heapq.heappop(queue)
        if cell == goal:
            return costs[cell]
        if cell in closed:
            continue
        closed.add(cell)
        for down, right in MOVES:
            row, col = cell[0] + down, cell[1] + right
            if 0 <= row < rows and 0 <= col < cols and not grid[row][col]:
                cost = costs[cell] + (sqrt(2) if down and right else 1.0)
                if cost < costs.get((row, col), inf):
                    costs[row, col] = cost
                    heapq.heappush(queue, (cost + estimate(row, col), (row, col)))
    return inf


def wavefront(grid, goal):
    """Return 2 plus the steps to the goal, 1 on obstacles, 0 where no path leads, by breadth-first search."""
    rows, cols = len(grid), len(grid[0])
    values = [[1 if occupied else 0 for occupied in row] for row in grid]
    values[goal[0]][goal[1]] = 2
    queue = deque([goal])
    while queue:
        row, col = queue.popleft()
        for down, right in MOVES:
            r, c = row + down, col + right
            if 0 <= r < rows and 0 <= c < cols and values[r][c] == 0:
                values[r][c] = values[row][col] + 1
                queue.append((r, c))
    return values


def wrapped(angle):
    return (angle + pi) % tau - pi


def seen_from(a, b, radius):
    """Return a pose as seen from another, in turning radii."""
    dx, dy = (b[0] - a[0]) / radius, (b[1] - a[1]) / radius
    c, s = cos(a[2]), sin(a[2])
    return c * dx + s * dy, c * dy - s * dx, b[2] - a[2]


def dubins(a, b, radius):
    """Return the length of the shortest Dubins curve: words that begin with a left turn, then their mirror images."""
    x, y, phi = seen_from(a, b, radius)
    best = inf
    for y, phi in ((y, phi), (-y, -phi)):
        # Between the centres of two left circles; between a left and a right one.
        u, theta = hypot(x - sin(phi), y - 1 + cos(phi)), atan2(y - 1 + cos(phi), x - sin(phi))
        best = min(best, theta % tau + u + (phi - theta) % tau)
        if u <= 4:
            aside = acos(u / 4)
            t, middle = (theta + aside + pi / 2) % tau, pi + 2 * aside
            best = min(best, t + middle + (phi - t + middle) % tau)
        far, theta = hypot(x + sin(phi), y - 1 - cos(phi)), atan2(y - 1 - cos(phi), x + sin(phi))
        if far >= 2:
            u = sqrt(far * far - 4)
            t = (theta + atan2(2, u)) % tau
            best = min(best, t + u + (t - phi) % tau)
    return radius * best


def outer_arcs(u, v, xi, eta, phi):
    delta = wrapped(u - v)
    a, b = sin(u) - sin(delta), cos(u) - cos(delta) - 1
    t = atan2(eta * a - xi * b, xi * a + eta * b)
    if 2 * (cos(delta) - cos(v) - cos(u)) + 3 < 0:
        t += pi
    t = wrapped(t)
    return t, wrapped(t - u + v - phi)


def words(x, y, phi):
    """Yield lengths of words that begin with a left turn forward (Reeds and Shepp 1990, section 8)."""
    xi, eta = x - sin(phi), y - 1 + cos(phi)
    u, theta = hypot(xi, eta), atan2(eta, xi)
    v = wrapped(phi - theta)
    if theta >= 0 and v >= 0:  # L+ S+ L+
        yield theta + u + v
    if u <= 4:  # L+ R- L
        arc = -2 * asin(u / 4)
        t = wrapped(theta + arc / 2 + pi)
        if t >= 0:
            yield t - arc + abs(wrapped(phi - t + arc))
    if u >= 2:  # L+ R- S- L-
        side = sqrt(u * u - 4)
        t = wrapped(theta + atan2(side, -2))
        v = wrapped(phi - pi / 2 - t)
        if t >= 0 and side >= 2 and v <= 0:
            yield t + pi / 2 + side - 2 - v
    xi, eta = x + sin(phi), y - 1 - cos(phi)
    rho, theta = hypot(xi, eta), atan2(eta, xi)
    if rho >= 2:
        side = sqrt(rho * rho - 4)
        t = wrapped(theta + atan2(2, side))
        v = wrapped(t - phi)
        if t >= 0 and v >= 0:  # L+ S+ R+
            yield t + side + v
        t = atan2(xi, -eta)
        v = wrapped(t + pi / 2 - phi)
        if t >= 0 and v <= 0:  # L+ R- S- R-
            yield t + pi / 2 + rho - 2 - v
        u = 4 - side
        t = wrapped(atan2((4 - u) * xi - 2 * eta, -2 * xi + (u - 4) * eta))
        v = wrapped(t - phi)
        if u <= 0 and t >= 0 and v >= 0:  # L+ R- S- L- R+
            yield t + pi - u + v
    if rho <= 2:  # L+ R+ L- R-
        u = acos((2 + rho) / 4)
        t, v = outer_arcs(u, -u, xi, eta, phi)
        if t >= 0 and v <= 0:
            yield t + 2 * u - v
    if rho * rho <= 20 and rho >= 2:  # L+ R- L- R+
        u = -acos((20 - rho * rho) / 16)
        t, v = outer_arcs(u, u, xi, eta, phi)
        if u >= -pi / 2 and t >= 0 and v >= 0:
            yield t - 2 * u + v


def reeds_shepp(a, b, radius):
    """Return the length of the shortest Reeds-Shepp curve, the words read in all eight symmetries."""
    x, y, phi = seen_from(a, b, radius)
    best = inf
    # Read from the end, a curve leads from the end's pose to the start.
    for x, y in ((x, y), (x * cos(phi) + y * sin(phi), x * sin(phi) - y * cos(phi))):
        for x, y, phi in ((x, y, phi), (-x, y, -phi), (x, -y, -phi), (-x, -y, phi)):
            best = min(best, *words(x, y, phi), inf)
    return radius * best


def corners(x, y, heading, vehicle):
    c, s = cos(heading), sin(heading)
    ends = (-vehicle.rear_overhang, vehicle.length - vehicle.rear_overhang)
    half = vehicle.width / 2
    around = [(ends[0], -half), (ends[1], -half), (ends[1], half), (ends[0], half)]
    return [(x + c * along - s * across, y + s * along + c * across) for along, across in around]


def overlap(one, other):
    """Return whether two convex polygons touch, by the theorem of the separating axis."""
    for polygon in (one, other):
        for (x, y), (to_x, to_y) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            nx, ny = y - to_y, to_x - x
            of_one = [nx * px + ny * py for px, py in one]
            of_other = [nx * px + ny * py for px, py in other]
            if max(of_one) < min(of_other) or max(of_other) < min(of_one):
                return False
    return True


def is_free(pose, vehicle, polygons, size_m):
    """Return whether a body touches neither a polygon nor the border; polygons come with a centre and a radius."""
    body = corners(*pose, vehicle)
    if any(not (0 < x < size_m[0] and 0 < y < size_m[1]) for x, y in body):
        return False
    x, y = sum(corner[0] for corner in body) / 4, sum(corner[1] for corner in body) / 4
    reach = hypot(vehicle.length, vehicle.width) / 2
    near = (polygon for cx, cy, radius, polygon in polygons if hypot(cx - x, cy - y) <= radius + reach)
    return not any(overlap(body, polygon) for polygon in near)


def cells_as_polygons(checker):
    side = checker.cell_m
    for row, col in zip(*np.nonzero(checker.occupied), strict=True):
        x, y = float(col) * side, float(row) * side
        square = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
        yield x + side / 2, y + side / 2, side / sqrt(2), square


def median_ms(work, runs):
    def once():
        began = time.thread_time()
        answer = work()
        return 1e3 * (time.thread_time() - began), answer

    timed = [once() for _ in range(runs)]
    return statistics.median(ms for ms, _ in timed), timed[0][1]


def main() -> None:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    random = np.random.default_rng(1)
    print(f"{'':44}  pure Python  package   ratio")

    def row(title, pure, package, same):
        slow_ms, expected = median_ms(pure, runs)
        fast_ms, found = median_ms(package, runs)
        assert same(expected, found), title
        print(f"{title:44} {slow_ms:9.1f} ms {fast_ms:6.2f} ms {slow_ms / fast_ms:7.0f}")

    occupied = random.random((300, 300)) < 0.25
    occupied[5, 5] = occupied[290, 290] = False
    lists = occupied.tolist()
    row(
        "A*, 300 x 300 cells",
        lambda: astar(lists, (5, 5), (290, 290)),
        lambda: wf.search_grid(occupied, (5, 5), (290, 290)).cost,
        lambda one, other: abs(one - other) < 1e-9,
    )
    row(
        "wavefront, 300 x 300 cells",
        lambda: wavefront(lists, (290, 290)),
        lambda: wf.wavefront(occupied, (290, 290)),
        np.array_equal,
    )
    a, b = (np.column_stack([random.uniform(0, 60, (2000, 2)), random.uniform(-pi, pi, 2000)]) for _ in range(2))
    pairs = list(zip(map(tuple, a.tolist()), map(tuple, b.tolist()), strict=True))
    for title, pure, package in (
        ("Reeds-Shepp", reeds_shepp, wf.reeds_shepp_length),
        ("Dubins", dubins, wf.dubins_length),
    ):
        row(
            f"{title}, 2000 lengths, one array",
            lambda pure=pure: [pure(*pair, 13.0) for pair in pairs],
            lambda package=package: package(a, b, 13.0),
            lambda one, other: np.allclose(one, other, rtol=0, atol=1e-6),
        )
    row(
        "Reeds-Shepp, 2000 lengths, 2000 calls",
        lambda: [reeds_shepp(*pair, 13.0) for pair in pairs],
        lambda: [wf.reeds_shepp_length(*pair, 13.0) for pair in pairs],
        lambda one, other: np.allclose(one, other, rtol=0, atol=1e-6),
    )
    checker = wf.scenario("contest").checker(seed=7)
    polygons = list(cells_as_polygons(checker))
    poses = np.column_stack([random.uniform(0, 250, (2000, 2)), random.uniform(-pi, pi, 2000)])
    listed = [tuple(pose) for pose in poses.tolist()]
    # The checker keeps 1 cm; pure Python only tests for contact.
    clear = np.abs(checker.clearance(poses) - 0.005) > 0.006
    row(
        f"{len(listed)} poses against {len(polygons)} squares, one array",
        lambda: [is_free(pose, checker.vehicle, polygons, checker.size_m) for pose in listed],
        lambda: checker.pose_is_free(poses),
        lambda one, other: np.array_equal(np.array(one)[clear], other[clear]),
    )


if __name__ == "__main__":
    main()
