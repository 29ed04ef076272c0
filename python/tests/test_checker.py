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
