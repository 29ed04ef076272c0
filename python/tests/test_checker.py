"""The collision core and curves, on one pose and on many."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

import wildfire_contest as wf


@pytest.fixture(scope="module")
def checker() -> wf.Checker:
    return wf.scenario("contest").checker(seed=7)


@pytest.fixture(scope="module")
def poses() -> np.ndarray:
    draw = np.random.default_rng(1)
    return np.column_stack([draw.uniform(-5, 255, (2000, 2)), draw.uniform(-10, 10, 2000)])


def distance_to_bushes(checker: wf.Checker, pose: np.ndarray) -> float:
    """Return metres from a dense net of points of the body to the nearest bush or the border."""
    x, y, heading = pose
    body = checker.vehicle
    along = np.linspace(-body.rear_overhang, body.length - body.rear_overhang, 50)
    across = np.linspace(-body.width / 2, body.width / 2, 23)
    a, b = (points.ravel() for points in np.meshgrid(along, across))
    px, py = x + math.cos(heading) * a - math.sin(heading) * b, y + math.sin(heading) * a + math.cos(heading) * b
    width, height = checker.size_m
    border = min(px.min(), py.min(), width - px.max(), height - py.max())
    rows, cols = np.nonzero(checker.occupied)
    dx = np.abs(px[:, None] - (cols + 0.5) * checker.cell_m) - checker.cell_m / 2
    dy = np.abs(py[:, None] - (rows + 0.5) * checker.cell_m) - checker.cell_m / 2
    gaps = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0))
    return min(border, float(gaps.min()))


def test_many_poses_are_answered_like_one(checker: wf.Checker, poses: np.ndarray) -> None:
    free, clearance = checker.pose_is_free(poses, 0.5), checker.clearance(poses)
    assert free.shape == clearance.shape == (2000,) and free.dtype == bool and clearance.dtype == np.float64
    for index in range(0, 2000, 50):
        assert checker.pose_is_free(tuple(poses[index]), 0.5) is bool(free[index])
        assert checker.clearance(poses[index]) == clearance[index]
    assert 0.1 < free.mean() < 0.9


def test_clearances_agree_with_a_net_of_points(checker: wf.Checker, poses: np.ndarray) -> None:
    compared = 0
    for pose, clearance in zip(poses[:300], checker.clearance(poses[:300]), strict=True):
        by_points = distance_to_bushes(checker, pose)
        if 0 < clearance < 1:
            compared += 1
            assert clearance - 1e-9 <= by_points <= clearance + 0.15, pose
        elif clearance <= 0:
            assert by_points <= 0.15, pose
        else:
            assert by_points >= clearance - 1e-9, pose
    assert compared > 20


def test_motions_and_curves_agree_with_their_poses(checker: wf.Checker, poses: np.ndarray) -> None:
    starts = poses[checker.pose_is_free(poses, 0.2)][:400]
    curvature, length = np.resize([0.0, 1 / 13, -1 / 20], len(starts)), np.resize([8.0, -6.0, 15.0, 3.0], len(starts))
    free = checker.motion_is_free(starts, curvature, length, 0.2)
    assert 0.1 < free.mean() < 1
    for index in range(0, len(starts), 7):
        path = wf.Path(starts[index], [[curvature[index], length[index]]])
        densely = checker.clearance(path.poses(step=0.05)[:, :3])
        assert free[index] == checker.motion_is_free(starts[index], curvature[index], length[index], 0.2)
        assert densely.min() > 0.16 if free[index] else densely.min() < 0.21
    ends = np.roll(starts, 1, axis=0)
    curves = checker.curve_is_free(starts, ends)
    for index in range(0, len(starts), 7):
        path = wf.Path.through(starts[index], ends[index], checker.vehicle.min_turn_radius)
        assert curves[index] == checker.curve_is_free(starts[index], ends[index])
        assert not curves[index] or checker.clearance(path.poses(0.05)[:, :3]).min() > 0
    assert (checker.curve_is_free(starts[0], ends) == checker.curve_is_free(np.tile(starts[0], (len(ends), 1)), ends)).all()


def test_goal_poses_are_free_and_in_the_goal(checker: wf.Checker) -> None:
    rows, cols = np.nonzero(checker.occupied)
    found = 0
    for row, col in list(zip(rows, cols, strict=True))[::10]:
        goal = wf.Disc((col + 0.5) * 5, (row + 0.5) * 5, 10.0)
        poses = checker.goal_poses(goal, n=16, clearance=0.1)
        assert poses.ndim == 2 and poses.shape[1] == 3 and len(poses) <= 16
        assert checker.pose_is_free(poses, 0.1).all()
        assert wf.Query((20, 32, 0), goal, checker).meets(poses).all()
        assert (poses == checker.goal_poses(goal, 16)).all()
        found += len(poses) == 16
    assert found > 10
    free = wf.Pose(20.0, 32.0, 0.0)
    assert checker.goal_poses(free).tolist() == [[20.0, 32.0, 0.0]]
    assert checker.goal_poses(wf.Disc(-100, -100, 1)).shape == (0, 3)


def test_a_query_knows_what_meets_its_goal(checker: wf.Checker) -> None:
    to_pose = wf.Query((20, 32, 0), wf.Pose(40, 32, 3.0), checker)
    assert to_pose.goal == wf.Pose(40, 32, 3.0) and isinstance(to_pose.goal, wf.Pose)
    assert to_pose.meets((40.0009, 32, 3.0)) is True and to_pose.meets((40.002, 32, 3.0)) is False
    assert to_pose.meets((40, 32, 3.0 - 2 * math.pi)) is True and to_pose.meets((40, 32, 3.002)) is False
    to_disc = wf.Query((20, 32, 0), wf.Disc(42, 32, 1), checker)
    assert isinstance(to_disc.goal, wf.Disc) and to_disc.start == (20, 32, 0)
    # The centre of the body is 1.5 m ahead of the rear axle.
    assert to_disc.meets([[39.6, 32, 0], [39.4, 32, 0], [41.4, 32, 0], [41.6, 32, 0]]).tolist() == [True, False, True, False]


def test_numbers_that_are_none_are_never_free(checker: wf.Checker) -> None:
    for bad in (float("nan"), float("inf"), 1e300):
        for pose in ((bad, 32, 0), (20, bad, 0), (20, 32, bad)):
            assert checker.pose_is_free(pose) is False and math.isnan(checker.clearance(pose))
            assert checker.motion_is_free(pose, 0, 1) is False
            assert checker.curve_is_free((20, 32, 0), pose) is False
            assert wf.Query((20, 32, 0), wf.Pose(20, 32, 0), checker).meets(pose) is False
            assert math.isnan(wf.reeds_shepp_length((20, 32, 0), pose, 13))
        assert checker.motion_is_free((20, 32, 0), bad, 1) is False
        assert checker.motion_is_free((20, 32, 0), 0, bad) is False
        with pytest.raises(ValueError, match="clearance is"):
            checker.pose_is_free((20, 32, 0), bad)
        with pytest.raises(ValueError):
            checker.goal_poses(wf.Disc(bad, 0, 1))
        with pytest.raises(ValueError):
            wf.Path((20, 32, 0), [[bad, 1]])
        with pytest.raises(ValueError):
            wf.Path.through((20, 32, 0), (bad, 1, 0), 13)


@pytest.mark.parametrize("poses", [[1, 2], [[1, 2, 3, 4]], "a pose", None, [[[1, 2, 3]]], [["a", "b", "c"]]])
def test_what_is_no_pose_is_refused_with_its_shape(checker: wf.Checker, poses: object) -> None:
    with pytest.raises((ValueError, TypeError), match="expected poses"):
        checker.clearance(poses)  # type: ignore[arg-type]


def test_numbers_of_poses_and_motions_go_together(checker: wf.Checker) -> None:
    three = np.tile([20.0, 32.0, 0.0], (3, 1))
    assert checker.motion_is_free(three, 0.0, 1.0).shape == (3,)
    assert checker.motion_is_free(three[0], [0.0, 0.01], 1.0).shape == (2,)
    with pytest.raises(ValueError, match="expected as many"):
        checker.motion_is_free(three, [0.0, 0.1], 1.0)
    with pytest.raises(ValueError, match="expected as many"):
        checker.curve_is_free(three, three[:2])
    assert checker.clearance(np.empty((0, 3))).shape == (0,)


def test_a_checker_of_a_map_of_ones_own() -> None:
    occupied = np.zeros((20, 30), dtype=bool)
    occupied[10, 15] = True
    checker = wf.Checker(occupied, cell_m=2.0, vehicle=wf.Vehicle(length=4, width=2, wheelbase=2.5, rear_overhang=0.8, min_turn_radius=6))
    assert checker.size_m == (60.0, 40.0) and checker.cell_m == 2.0 and checker.vehicle.min_turn_radius == 6
    assert (checker.occupied == occupied).all()
    # From (30, 20) to (32, 22); the bumper is 3.2 m ahead of the rear axle.
    assert checker.clearance((26, 21, 0)) == pytest.approx(0.8)
    for wrong in (np.zeros((0, 3), bool), np.zeros(3, bool), np.zeros((1, 5000), bool)):
        with pytest.raises((ValueError, TypeError)):
            wf.Checker(wrong)
    with pytest.raises(ValueError, match="no vehicle"):
        wf.Checker(occupied, vehicle=wf.Vehicle(length=-1))
    with pytest.raises(ValueError, match="cell_m"):
        wf.Checker(occupied, cell_m=float("nan"))


def test_paths_have_the_figures_that_one_can_reckon() -> None:
    path = wf.Path((0, 0, 0), [[0, 3], [1 / 10, 5 * math.pi], [0, -2]])
    assert path.length == pytest.approx(5 + 5 * math.pi) and path.cusps == 1 and len(path) == 3
    assert path.end == pytest.approx((13, 8, math.pi / 2))
    poses = path.poses(step=0.25)
    assert poses.shape[1] == 4 and (poses[0] == [0, 0, 0, 1]).all() and (poses[-1, 3], poses[-9, 3]) == (-1, 1)
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert steps.max() <= 0.25 + 1e-9 and poses[-1, :3] == pytest.approx(path.end)
    again = wf.Path(path.start, path.segments)
    assert again == path and (again.segments == path.segments).all()
    assert wf.Path((1, 2, 3), []).length == 0 and wf.Path((1, 2, 3), np.empty((0, 2))).poses().shape == (1, 4)
    for wrong in ([[1, 2, 3]], [1, 2], "a path", [[1], [2, 3]]):
        with pytest.raises(ValueError, match="expected segments"):
            wf.Path((0, 0, 0), wrong)  # type: ignore[arg-type]
    for step in (0.0, -1.0, float("nan"), 1e-300):
        with pytest.raises(ValueError, match="step is"):
            path.poses(step)


def test_paths_are_pickled() -> None:
    for path in (wf.Path((1, 2, 3), []), wf.Path.through((20, 32, 0), (60, 40, 1), 13.0)):
        assert pickle.loads(pickle.dumps(path)) == path


def test_lengths_of_curves_are_those_of_their_paths() -> None:
    draw = np.random.default_rng(2)
    a, b = (np.column_stack([draw.uniform(0, 60, (50, 2)), draw.uniform(-3, 3, 50)]) for _ in range(2))
    lengths = wf.reeds_shepp_length(a, b, 7.0)
    assert lengths == pytest.approx([wf.Path.through(one, other, 7.0).length for one, other in zip(a, b, strict=True)])
    assert (lengths >= np.hypot(*(a - b)[:, :2].T) - 1e-9).all() and (wf.dubins_length(a, b, 7.0) >= lengths - 1e-9).all()
    assert wf.reeds_shepp_length((0, 0, 0), (5, 0, 0), 7.0) == pytest.approx(5)
    with pytest.raises(ValueError, match="radius is"):
        wf.reeds_shepp_length((0, 0, 0), (5, 0, 0), 0.0)


def test_lengths_of_many_are_those_of_one_bit_for_bit() -> None:
    draw = np.random.default_rng(3)
    a, b = (np.column_stack([draw.uniform(0, 60, (200, 2)), draw.uniform(-9, 9, 200)]) for _ in range(2))
    for length in (wf.reeds_shepp_length, wf.dubins_length):
        assert length(a, b, 7.0).tolist() == [length(tuple(one), tuple(other), 7.0) for one, other in zip(a, b, strict=True)]
        assert length(a[0], b, 7.0).tolist() == [length(a[0], other, 7.0) for other in b]
        assert length(a, b[0], 7.0).tolist() == [length(one, b[0], 7.0) for one in a]
        assert math.isnan(length(a, np.where(b == b[5], math.nan, b), 7.0)[5])
        for radius in (0.0, -1.0, math.nan, math.inf):
            with pytest.raises(ValueError, match="radius is"):
                length(a, b, radius)
        with pytest.raises(ValueError, match=r"expected poses of shape \(3,\) or \(n, 3\), found shape \(200, 2\)"):
            length(a[:, :2], b, 7.0)
        with pytest.raises(ValueError, match="found 200 poses and 3 poses"):
            length(a, b[:3], 7.0)
    for one, other in zip(a[:50], b[:50], strict=True):
        forward = wf.Path.through(one, other, 7.0, forward_only=True)
        assert forward.length == pytest.approx(wf.dubins_length(one, other, 7.0)) and forward.cusps == 0
        assert np.hypot(*np.subtract(forward.end, other)[:2]) < 1e-9


@pytest.mark.parametrize("occupied", [np.zeros(3, bool), np.zeros((2, 2, 2)), "a map", None, [["a", "b"]], [[1], [1, 2]]])
def test_what_is_no_map_is_refused_with_its_shape(occupied: object) -> None:
    for ask in (wf.Checker, lambda it: wf.wavefront(it, (0, 0)), lambda it: wf.search_grid(it, (0, 0), (0, 0))):
        with pytest.raises(ValueError, match=r"^expected occupied of shape \(rows, cols\) with flags or numbers, found ") as caught:
            ask(occupied)  # type: ignore[operator]
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("planner", ["hybrid-astar", "prm-rs", "prm+primitives", "lattice"])
def test_paths_that_are_found_pass_the_judge(checker: wf.Checker, planner: str) -> None:
    start, goals = (20.0, 32.0, 0.0), [wf.Disc(120, 130, 8), (60.0, 32.0, 0.0)]
    for goal in goals:
        path = wf.find_path(checker, start, goal, planner, seed=3)  # type: ignore[arg-type]
        assert path.start == start and path == wf.find_path(checker, start, goal, planner, seed=3)  # type: ignore[arg-type]
        judged = wf.judge(checker, path, goal)
        assert judged["violation"] is None and judged["length_m"] == path.length and judged["cusps"] == path.cusps
        densely = checker.clearance(path.poses(0.02)[:, :3])
        assert judged["min_clearance_m"] == pytest.approx(densely.min(), abs=0.05) and densely.min() > 0.009
        assert 1 <= judged["lower_bound_ratio"] < 5
    with pytest.raises(wf.NoPath) as caught:
        row, col = np.argwhere(checker.occupied)[0]
        wf.find_path(checker, start, ((col + 0.5) * 5, (row + 0.5) * 5, 0.0), planner)  # type: ignore[arg-type]
    assert caught.value.reason == "goal-blocked"


def test_paths_that_break_a_rule_are_refused_with_it(checker: wf.Checker) -> None:
    start = (20.0, 32.0, 0.0)
    for segments, sentence in [
        ([(0, -20)], "from the border"),
        ([(0.2, 1)], "a turn of radius 5.00 m; the least is 13 m"),
        ([(0, 2)], "from the goal's pose, the most is 0.001 m"),
        ([(0, 1e6)], "it is 1000000.00 m long"),
    ]:
        judged = wf.judge(checker, wf.Path(start, segments), (60, 32, 0))
        assert list(judged) == ["violation"] and sentence in judged["violation"], judged
    with pytest.raises(ValueError, match="planner is 'rrt'; expected one of prm"):
        wf.find_path(checker, start, start, "rrt")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="start has numbers that are not finite"):
        wf.find_path(checker, (math.nan, 0, 0), start)


def test_grids_are_searched_as_breadth_first_search_does() -> None:
    occupied = np.random.default_rng(4).random((40, 50)) < 0.3
    start, goal = (2, 3), (37, 45)
    occupied[start] = occupied[goal] = False
    for neighbours in (4, 8):
        steps = wf.wavefront(occupied, np.array(goal), neighbours)
        assert steps[goal] == 2 and (steps[occupied] == 1).all()
        found = wf.search_grid(occupied, start, goal, "dijkstra", neighbours=neighbours)
        assert found.path[0].tolist() == list(start) and found.path[-1].tolist() == list(goal)
        moves = np.abs(np.diff(found.path, axis=0))
        assert moves.max() == 1 and moves.sum(axis=1).max() == neighbours // 4
        assert found.cost == pytest.approx(np.hypot(*moves.T).sum()) and not occupied[tuple(found.path.T)].any()
        assert len(moves) >= steps[start] - 2 and (neighbours == 8 or len(moves) == steps[start] - 2)
        again = wf.search_grid(occupied, start, goal, neighbours=neighbours)
        assert again.cost == found.cost and len(again.expanded) <= len(found.expanded)
    assert wf.search_grid(occupied, start, goal, "jps").cost == found.cost
    straight = wf.search_grid(occupied, start, goal, "theta")
    assert straight.cost <= found.cost and len(straight.path) < len(found.path)
    assert wf.search_grid(occupied, start, goal, "greedy").cost >= found.cost
    assert wf.search_grid(occupied, start, goal, corner_cutting=False).cost >= found.cost
    closed = np.zeros((3, 3), bool)
    closed[1] = True
    none = wf.search_grid(closed, (0, 0), (2, 2))
    assert none.path.shape == (0, 2) and none.cost == math.inf and none.expanded.shape == (3, 2)
    assert wf.search_grid(closed, (1, 1), (2, 2)).expanded.shape == (0, 2)
    assert wf.wavefront(closed, (0, 1)).tolist() == [[3, 2, 3], [1, 1, 1], [0, 0, 0]]


def test_what_a_grid_does_not_allow_is_refused_in_a_sentence() -> None:
    grid = np.zeros((3, 4), bool)
    grid[0, 1] = True
    for ask, sentence in [
        (lambda: wf.search_grid(grid, (0, 0), (0, 1)), "the goal at row 0, column 1 is occupied"),
        (lambda: wf.search_grid(grid, (3, 0), (0, 0)), "the start at row 3, column 0 lies outside the map of 3 rows and 4 columns"),
        (lambda: wf.wavefront(grid, (0, -1)), r"the goal is \(0, -1\); expected \(row, column\), from 0"),
        (lambda: wf.wavefront(grid, 3), r"the goal is 3; expected \(row, column\), from 0"),
        (lambda: wf.wavefront(grid, (0.5, 1)), r"the goal is \(0.5, 1\); expected \(row, column\), from 0"),
        (lambda: wf.wavefront(grid, (0, 0), 6), "neighbours is 6; expected 4 or 8"),
        (lambda: wf.wavefront(np.zeros((0, 4)), (0, 0)), r"occupied has shape \(0, 4\); expected 1 to 32767 cells per side"),
        (lambda: wf.search_grid(grid, (0, 0), (2, 2), "rrt"), "method is 'rrt'; expected 'astar'"),
        (lambda: wf.search_grid(grid, (0, 0), (2, 2), "jps", neighbours=4), "neighbours is 4; expected 8 for `jps`"),
    ]:
        with pytest.raises(ValueError, match=f"^{sentence}"):
            ask()
