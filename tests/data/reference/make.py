#!/usr/bin/env python3
"""Makes the answers in this folder, by tools that share nothing with this program.

    pip install numpy==1.26.4 scipy==1.12.0 shapely==2.2.0 ompl==2.0.1 rsplan==1.0.10 pyretechnics==2026.10.20
    python3 make.py

Maps, fields, poses and conditions are random, from fixed seeds. Python 3.11 made what is here.

grid/        SciPy: distance transforms (brushfire), shortest paths in sparse graphs (wavefront, octile optima); NumPy: fields
movingai/    SciPy: shortest paths in which a diagonal needs both neighbours free, in the format of the Moving AI benchmark
reeds_shepp  OMPL and rsplan: lengths between poses
plan/        shapely: clearances of poses among bushes; OMPL: lengths without obstacles, which are lower bounds
clmapf/      instances in the format of CL-MAPF; shapely: nothing touches at starts and goals; OMPL: lower bounds
fire/        pyretechnics, uncompiled in floats of 64 bits: head fires, rates by direction, wind adjustment, a level set;
             ellipses that spread from a focus: in closed form; BEHAVE: see behave.cpp
"""

import hashlib
import json
import math
import shutil
import sys
import sysconfig
import tempfile
from pathlib import Path

import numpy as np
from scipy import ndimage
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

HERE = Path(__file__).resolve().parent
CROSS = [(1, 0), (-1, 0), (0, 1), (0, -1)]
DIAGONALS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]


def csv(name, header, rows):
    path = HERE / name
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [",".join(header)] + [",".join(repr(float(x)) if isinstance(x, float) else str(x) for x in row) for row in rows]
    path.write_text("\n".join(lines) + "\n")


def distances(occupied, source, steps, cuts_corners, is_octile):
    """Lengths of the shortest paths from a free cell to all; infinite where there is none."""
    rows, cols = occupied.shape
    edges = ([], [], [])
    for row, col in np.argwhere(~occupied):
        for down, right in steps:
            r, c = row + down, col + right
            if not (0 <= r < rows and 0 <= c < cols) or occupied[r, c]:
                continue
            if down and right and not cuts_corners and (occupied[row, c] or occupied[r, col]):
                continue
            for part, value in zip(edges, (row * cols + col, r * cols + c, math.sqrt(2) if is_octile and down and right else 1.0)):
                part.append(value)
    graph = csr_matrix((edges[2], (edges[0], edges[1])), shape=(occupied.size, occupied.size))
    return dijkstra(graph, indices=source[0] * cols + source[1]).reshape(occupied.shape)


def grid_case(name, occupied, start, goal):
    folder = HERE / "grid" / name
    folder.mkdir(parents=True)
    rows, cols = occupied.shape
    facts = {"rows": rows, "cols": cols, "start": start, "goal": goal, "occupied": int(occupied.sum()), "files": {}}
    facts |= {"start_free": not occupied[tuple(start)], "goal_free": not occupied[tuple(goal)]}

    def put(file, values, digits="%d"):
        text = "".join(",".join(digits % value for value in row) + "\n" for row in values)
        (folder / file).write_text(text)
        numbers = values.astype(float)
        facts["files"][file] = {
            "sha256": hashlib.sha256(text.encode()).hexdigest(),
            "sum": float(numbers.sum()),
            "max": float(numbers.max()),
            "zeros": int((numbers == 0).sum()),
        }

    (folder / "map.txt").write_text("".join("".join("01"[int(cell)] for cell in row) + "\n" for row in occupied))
    brushfire = {}
    for count, metric in ((4, "taxicab"), (8, "chessboard")):
        has_any = occupied.any()
        brushfire[count] = ndimage.distance_transform_cdt(~occupied, metric) + 1 if has_any else np.zeros((rows, cols), int)
        put(f"brushfire{count}.csv", brushfire[count])
        steps = distances(occupied, goal, CROSS + (DIAGONALS if count == 8 else []), True, False)
        reached = np.isfinite(steps)
        wave = np.where(reached, 2 + np.where(reached, steps, 0), occupied).astype(int)
        put(f"wavefront{count}.csv", wave)
        value = int(wave[tuple(start)])
        answer = {"unreached_free": int((wave == 0).sum()), "reachable": value > 1}
        facts[f"wavefront{count}"] = answer | {"value_at_start": value, "path_cells": value - 1, "path_steps": value - 2}
        near = brushfire[count] <= 5
        repulsion = np.where(near & has_any, 7.5 * (1 / np.maximum(brushfire[count], 1) - 1 / 5) ** 2, 0.0)
        put(f"repulsive{count}_Q5_eta15.csv", repulsion, "%.12g")
        down, right = np.indices((rows, cols)) - np.array(goal).reshape(2, 1, 1)
        attraction = 0.5 * (down**2 + right**2)
        put(f"total{count}.csv", attraction / attraction.max() * 10 + repulsion, "%.12g")
    put("attraction_d2_raw.csv", attraction, "%.12g")
    put("attraction_d2_scaled10.csv", attraction / attraction.max() * 10, "%.12g")
    put("attraction_mht_raw.csv", abs(down) + abs(right) + 0.0, "%.12g")
    depth = np.maximum(brushfire[4] - 1, 0)
    for name, from_zone in (("cost_literal.csv", 0), ("cost_continuous.csv", 12)):
        outer = np.maximum(0, 500 - 15 * (depth - from_zone))
        put(name, np.where(depth < 12, np.where(depth == 0, 1000, 800 - 25 * depth), outer) if has_any else 0 * depth)
    for fact, cuts_corners in (("octile_cut_allowed", True), ("octile_no_corner_cut", False)):
        length = distances(occupied, goal, CROSS + DIAGONALS, cuts_corners, True)[tuple(start)]
        facts[fact] = float(length) if np.isfinite(length) else None
    (folder / "case.json").write_text(json.dumps(facts, indent=1) + "\n")


def grids():
    rng = np.random.default_rng(1)
    free = lambda occupied: [list(map(int, rng.choice(np.argwhere(~occupied)))) for _ in range(2)]
    for number, (rows, cols, share) in enumerate([(17, 23, 0.2), (30, 19, 0.35), (24, 24, 0.1)]):
        occupied = rng.random((rows, cols)) < share
        grid_case(f"random_{number}", occupied, *free(occupied))
    rooms = np.zeros((21, 31), bool)
    rooms[[0, 10, 20], :] = rooms[:, [0, 10, 20, 30]] = True
    rooms[5, [10, 20]] = rooms[15, [10, 20]] = rooms[10, [5, 25]] = False
    grid_case("rooms", rooms, [2, 2], [18, 28])
    walled = np.zeros((12, 15), bool)
    walled[4:9, 6:11] = True
    walled[6, 8] = False
    grid_case("walled_goal", walled, [1, 1], [6, 8])
    grid_case("no_obstacle", np.zeros((9, 13), bool), [8, 0], [2, 10])


def moving_ai():
    rng = np.random.default_rng(2)
    occupied = ndimage.binary_dilation(rng.random((48, 64)) < 0.06, iterations=1)
    folder = HERE / "movingai"
    folder.mkdir()
    lines = ["type octile", "height 48", "width 64", "map"] + ["".join(".@"[int(cell)] for cell in row) for row in occupied]
    (folder / "islands.map").write_text("\n".join(lines) + "\n")
    lines, cells = ["version 1"], np.argwhere(~occupied)
    while len(lines) < 61:
        start, goal = rng.choice(cells, 2)
        length = distances(occupied, goal, CROSS + DIAGONALS, False, True)[tuple(start)]
        if np.isfinite(length):
            places = [start[1], start[0], goal[1], goal[0]]
            lines.append("\t".join(map(str, [int(length // 4), "islands.map", 64, 48, *places, f"{length:.5e}"])))
    (folder / "islands.scen").write_text("\n".join(lines) + "\n")


def ompl_length(kind, radius, start, goal):
    from ompl import base

    space = getattr(base, f"{kind}StateSpace")(radius)
    states = [space.allocState() for _ in range(2)]
    for state, (x, y, heading) in zip(states, (start, goal)):
        state.setX(x), state.setY(y), state.setYaw(heading)
    return space.distance(*states)


def curves():
    import rsplan

    rng = np.random.default_rng(3)
    rows = []
    for number in range(300):
        size = (3.0, 10.0, 30.0, 60.0, 250.0)[number % 5]
        draw = lambda: [round(float(x), 6) for x in (*rng.uniform(0, size, 2), rng.uniform(-math.pi, math.pi))]
        start, goal = draw(), draw()
        other = rsplan.path(tuple(start), tuple(goal), 13.0, 0.0, 0.05, 0.0).total_length
        lengths = [ompl_length(kind, 13.0, start, goal) for kind in ("ReedsShepp", "Dubins")]
        assert abs(other - lengths[0]) < 1e-9, (start, goal)
        rows.append([*start, *goal, lengths[0], other, lengths[1]])
    # Straight ahead and back, quarter circles, beside, and far away: no second answer.
    quarter = math.pi / 2
    for goal in [(10, 0, 0), (-10, 0, 0), (13, 13, quarter), (13, -13, -quarter), (-13, 13, -quarter), (0, 5, 0), (1e4, 1e4, 0)]:
        lengths = [ompl_length(kind, 13.0, (0, 0, 0), goal) for kind in ("ReedsShepp", "Dubins")]
        rows.append([0, 0, 0, *goal, lengths[0], "", lengths[1]])
    header = ["x0", "y0", "th0", "x1", "y1", "th1", "rs_len_ompl_2_0_1", "rs_len_rsplan_1_0_10", "dubins_len_ompl_2_0_1"]
    csv("reeds_shepp.csv", header, rows)


def body(x, y, heading, rear, front, width):
    from shapely import affinity, geometry

    box = geometry.box(-rear, -width / 2, front, width / 2)
    return affinity.translate(affinity.rotate(box, heading, (0, 0), use_radians=True), x, y)


def fields():
    from shapely import geometry, ops

    shapes = [[(0, 0), (1, 0), (2, 0), (3, 0)], [(0, 0), (1, 0), (2, 0), (2, 1)], [(0, 0), (1, 0), (1, 1), (2, 1)]]
    shapes += [[(0, 0), (0, 1), (1, 0), (1, 1)], [(0, 0), (1, 0), (2, 0), (1, 1)]]
    lengths = []
    for number in range(2):
        rng, cells = np.random.default_rng(10 + number), set()
        while len(cells) < 200:
            col, row = rng.integers(0, 47, 2)
            shape = shapes[rng.integers(len(shapes))]
            cells |= {(int(col + (b if number else a)), int(row + (a if number else b))) for a, b in shape}
        bushes = ops.unary_union([geometry.box(5 * col, 5 * row, 5 * col + 5, 5 * row + 5) for col, row in cells])
        edge, poses = geometry.box(0, 0, 250, 250).exterior, []
        while len(poses) < 11:
            pose = [round(float(x), 3) for x in (*rng.uniform(5, 245, 2), rng.uniform(-math.pi, math.pi))]
            truck = body(*pose, 0.95, 3.95, 2.2)
            clearance = min(truck.distance(bushes), truck.distance(edge))
            # Half of them stand tightly.
            if 0.5 <= clearance < (0.9 if len(poses) % 2 else 99):
                poses.append({"pose": pose, "clearance_m": clearance})
        field = {"field": number, "n": 50, "cell_m": 5, "cells_cr": sorted(cells), "start": poses[0]["pose"], "goals": poses[1:]}
        (HERE / "plan").mkdir(exist_ok=True)
        (HERE / f"plan/field_{number:02}.json").write_text(json.dumps(field) + "\n")
        for goal, pose in enumerate(poses[1:]):
            lengths.append([number, goal, ompl_length("ReedsShepp", 13.0, poses[0]["pose"], pose["pose"])])
    csv("plan/lengths.csv", ["field", "goal", "lower_bound_m"], lengths)


def instances():
    from shapely import geometry

    bounds, folder = [], HERE / "clmapf"
    folder.mkdir()
    for number, (agents, discs) in enumerate([(4, 0), (6, 10), (8, 14)]):
        rng = np.random.default_rng(20 + number)
        centres = [[round(float(x), 3) for x in rng.uniform(4, 46, 2)] for _ in range(discs)]
        obstacles = [geometry.Point(centre).buffer(0.9) for centre in centres]
        ends = []
        for _ in range(2):
            placed = []
            while len(placed) < agents:
                x, y = map(int, rng.integers(4, 47, 2))
                yaw = float(rng.choice([0, 1.57, -1.57, 3.14]))
                # Yaw is clockwise in this format.
                car = body(x, y, -yaw, 1.0, 2.0, 2.0)
                if all(car.distance(o) > 0.2 for o in obstacles) and all(math.dist((x, y), other[:2]) > 7 for other in placed):
                    placed.append((x, y, yaw))
            ends.append(placed)
        lines = ["agents:"] + [f"- {{name: agent{i}, start: {list(a)}, goal: {list(b)}}}" for i, (a, b) in enumerate(zip(*ends))]
        lines += ["map:", "  dimensions: [50, 50]", "  obstacles:"] + [f"  - {centre}" for centre in centres or [[-1, -1]]]
        (folder / f"instance_{number}.yaml").write_text("\n".join(lines) + "\n")
        turned = lambda pose: (pose[0], pose[1], -pose[2])
        bounds.append([f"instance_{number}.yaml", sum(ompl_length("ReedsShepp", 3.0, turned(a), turned(b)) for a, b in zip(*ends))])
    csv("clmapf/bounds.csv", ["instance", "flowtime_bound_m"], bounds)


def landscapes():
    import pyretechnics.eulerian_level_set as level_set
    from pyretechnics.space_time_cube import SpaceTimeCube

    side, rows, shape = 121, [], (1, 121, 121)
    cases = [("small_wind", 122, 9, 240, 0, 90, 130, (45, 25)), ("small_slope", 102, 0, 0, 0.577, 180, 68, (22, 60))]
    for name, fuel, wind, wind_from, slope, aspect, minutes, (row, col) in cases:
        values = {"fuel_model": fuel, "slope": slope, "aspect": aspect, "wind_speed_10m": wind, "upwind_direction": wind_from}
        values |= {"canopy_cover": 0, "canopy_height": 0, "canopy_base_height": 0, "canopy_bulk_density": 0}
        values |= {"fuel_moisture_dead_1hr": 0.06, "fuel_moisture_dead_10hr": 0.07, "fuel_moisture_dead_100hr": 0.08}
        values |= {"fuel_moisture_live_herbaceous": 0.6, "fuel_moisture_live_woody": 0.9, "foliar_moisture": 0.9}
        cubes = {name: SpaceTimeCube(shape, value) for name, value in values.items()}
        state = level_set.SpreadState(shape).ignite_cell((row, col))
        span = {"cube_resolution": (minutes, 5, 5), "start_time": 0, "max_duration": minutes}
        level_set.spread_fire_with_phi_field(cubes, state, **span)
        arrival = np.asarray(state.get_full_matrices(["time_of_arrival"])["time_of_arrival"])
        burned = arrival >= 0
        assert not (burned[0].any() or burned[-1].any() or burned[:, 0].any() or burned[:, -1].any()), name
        lines = ["ncols 121", "nrows 121", "xllcorner 0", "yllcorner 0", "cellsize 5", "NODATA_value -9999"]
        lines += [" ".join(f"{time:.2f}" if time >= 0 else "-9999" for time in line) for line in arrival[::-1]]
        (HERE / "fire/landscapes").mkdir(parents=True, exist_ok=True)
        (HERE / f"fire/landscapes/{name}.asc").write_text("\n".join(lines) + "\n")
        rows.append([name, side, side, 5, minutes, row, col, int(burned.sum())])
    header = ["name", "rows", "cols", "cell_m", "duration_min", "ignition_row_from_south", "ignition_col", "burned"]
    csv("fire/landscapes/cases.csv", header, rows)


def uncompiled_pyretechnics():
    """Its compiled build has floats of 32 bits."""
    for name in [name for name in sys.modules if name.startswith("pyretechnics")]:
        del sys.modules[name]
    copy = Path(tempfile.mkdtemp())
    source = Path(sysconfig.get_paths()["purelib"]) / "pyretechnics"
    shutil.copytree(source, copy / "pyretechnics", ignore=shutil.ignore_patterns("*.so", "*.c", "__pycache__"))
    sys.path.insert(0, str(copy))


def moistures(rng):
    dead = rng.uniform(0.03, 0.2)
    return [round(float(x), 3) for x in (dead, dead + 0.01, dead + 0.02, rng.uniform(0.3, 1.5), rng.uniform(0.6, 1.5))]


CONDITIONS = ["number", "m_1h", "m_10h", "m_100h", "m_live_herb", "m_live_woody", "wind_midflame_mps", "wind_from_deg"]
CONDITIONS += ["slope_rise_run", "aspect_deg", "wind_limit"]


def fires():
    uncompiled_pyretechnics()
    import pyretechnics.fuel_models as fm
    import pyretechnics.surface_fire as sf

    rng = np.random.default_rng(4)

    def head(row):
        number, *moisture = row[:6]
        wind, wind_from, slope, aspect, limit = row[6:11]
        model = fm.moisturize(fm.get_fuel_model(number), (*moisture[:3], 0.0, *moisture[3:]))
        alone = sf.calc_surface_fire_behavior_no_wind_no_slope(model)
        return alone, sf.calc_surface_fire_behavior_max(alone, wind * 60, wind_from, slope, aspect, bool(limit), "behave")

    def conditions(number, limit):
        wind, slope = round(float(rng.uniform(0, 12)), 2), round(float(rng.uniform(0, 0.8)), 3)
        wind, slope = (0.0 if rng.random() < 0.15 else wind), (0.0 if rng.random() < 0.25 else slope)
        angles = [round(float(x), 1) for x in rng.uniform(0, 360, 2)]
        moisture = moistures(rng)
        if number in (4, 5, 7, 10):
            # Programs disagree whether their live fuel is of herbs or of wood.
            moisture[3] = moisture[4]
        return [number, *moisture, wind, angles[0], slope, angles[1], limit]

    numbers = [number for number in fm.list_fuel_model_numbers() if fm.is_burnable_fuel_model_number(number)]
    numbers = [number for number in numbers if number <= 13 or 101 <= number <= 204]
    rows = []
    for number in numbers:
        for limit in (0, 1, 1):
            row = conditions(number, limit)
            alone, fire = head(row)
            if fire.max_spread_rate < 1e-6:
                continue
            direction = math.degrees(math.atan2(fire.max_spread_direction[0], fire.max_spread_direction[1])) % 360
            answers = [alone.base_spread_rate, alone.base_fireline_intensity, fire.max_spread_rate, direction]
            answers += [fire.max_fireline_intensity, fire.max_flame_length, fire.length_to_width_ratio, fire.eccentricity]
            rows.append([len(rows) + 1, *row, *answers])
    answers = ["r0_m_min", "i0_kw_m", "r_m_min", "azimuth_deg", "intensity_kw_m", "flame_m", "length_to_width", "eccentricity"]
    csv("fire/surface_public.csv", ["id", *CONDITIONS, *("p_" + name for name in answers)], rows)

    models = []
    for number in numbers:
        model = fm.get_fuel_model(number)
        load, sav = model.w_o, model.sigma
        models.append([number, *(float(load[i]) for i in (0, 1, 2, 4, 5)), *(float(sav[i]) for i in (0, 1, 2, 4, 5))])
        models[-1] += [float(model.delta), float(model.M_x[0]), float(model.h[0])]
        # Live fuel of these is wood, as in BEHAVE.
        if number in (4, 5, 7, 10):
            row = models[-1]
            row[4], row[5], row[9], row[10] = 0.0, row[4] + row[5], 0.0, max(row[9], row[10])
    classes = ["1h", "10h", "100h", "live_herb", "live_woody"]
    header = ["number", "w_1h_lb_ft2", *("w_" + name for name in classes[1:])]
    header += ["sav_1h_per_ft", *("sav_" + name for name in classes[1:]), "depth_ft", "mx_dead", "heat_btu_lb"]
    csv("fire/fuel_models_lb.csv", header, models)

    cases, rates = [], []
    for case, number in enumerate([1, 4, 8, 102, 122, 145, 165, 183]):
        cases.append([case, *conditions(number, 1)])
        cases[-1][2:5] = [0.05, 0.06, 0.07]
        if case % 2:
            cases[-1][9] = 0.0
        _, fire = head(cases[-1][1:])
        uphill = np.array([-math.sin(math.radians(cases[-1][10])), -math.cos(math.radians(cases[-1][10]))]) * cases[-1][9]
        for azimuth in range(0, 360, 10):
            x, y = math.sin(math.radians(azimuth)), math.cos(math.radians(azimuth))
            direction = np.array([x, y, uphill[0] * x + uphill[1] * y])
            found = sf.calc_surface_fire_behavior_in_direction(fire, tuple(direction / np.linalg.norm(direction)))
            rates.append([case, azimuth, found.spread_rate])
    csv("fire/azimuth_cases.csv", ["case", *CONDITIONS], cases)
    csv("fire/azimuth.csv", ["case", "azimuth_deg", "p_front_normal_m_min"], rates)

    rows = []
    for number in range(80):
        depth, height, cover = rng.uniform(0.2, 6), rng.uniform(5, 120), rng.uniform(0.1, 1)
        row = [round(float(x), 3) for x in (depth, 0 if number % 2 else height, 0 if number % 2 else cover)]
        factor = sf.calc_wind_adjustment_factor(row[0], row[1], row[2])
        rows.append([*row, factor])
    csv("fire/wind_adjustment.csv", ["depth_ft", "canopy_height_ft", "canopy_cover", "p_waf"], rows)


def ellipses():
    rng, rows = np.random.default_rng(5), []
    for case, shape in enumerate([1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0]):
        heading, eccentricity = (0, 30, 45, 100, 200, 290, 350, 75)[case], math.sqrt(1 - 1 / shape**2)
        for _ in range(60):
            col, row = map(int, rng.integers(-50, 51, 2))
            if not (col or row):
                continue
            # The rate towards an angle from the head, seen from the focus where the fire began.
            angle = math.atan2(col, row) - math.radians(heading)
            rate = 0.1 * (1 - eccentricity) / (1 - eccentricity * math.cos(angle))
            rows.append([case, 0.1, shape, heading, 5, col, row, 5 * math.hypot(col, row) / rate])
    csv("fire/analytic.csv", ["case", "r_m_s", "length_to_width", "heading_deg", "cell_m", "d_col", "d_row_north", "arrival_s"], rows)


def main():
    for name in ("grid", "movingai", "plan", "clmapf", "fire/landscapes"):
        shutil.rmtree(HERE / name, ignore_errors=True)
    for part in (grids, moving_ai, curves, fields, instances, landscapes, fires, ellipses):
        part()


if __name__ == "__main__":
    main()
