"""Environments: the tests of Gymnasium and PettingZoo, and whole episodes."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import wildfire_contest as wf

gymnasium = pytest.importorskip("gymnasium")
pytest.importorskip("pettingzoo")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, seed_test  # noqa: E402

from wildfire_contest import envs  # noqa: E402
from wildfire_contest.vector import TruckVectorEnv  # noqa: E402

# Every bush that a Wumpus could light is asked for as the nearest, so that rules without chance play all of it.
NEAREST = {"wumpus.goal": "nearest-intact"}


def lead(outcome):
    """Points of the trucks, less the Wumpuses'."""
    return outcome["truck_score"] - outcome["wumpus_score"]


def same_events(one, other):
    return all(np.array_equal(one.events[name], other.events[name]) for name in one.events)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("actions", ["cells", "nearest"])
def test_gymnasium_accepts_the_environment(actions):
    check_env(gymnasium.make("wildfire/Truck-v0", scenario="smoke", actions=actions).unwrapped, skip_render_check=True)
    check_env(envs.TruckEnv("smoke", actions=actions, render_mode="rgb_array"))


def test_gymnasium_finds_an_environment_by_its_module():
    name = "wildfire_contest.envs:wildfire/Truck-v0"
    code = f"import gymnasium; print(gymnasium.make('{name}', scenario='smoke').reset(seed=1)[0]['time_s'])"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stdout.startswith("["), done.stderr


@pytest.mark.filterwarnings("ignore")
def test_pettingzoo_accepts_the_environments():
    parallel_api_test(envs.contest_v0.parallel_env("smoke"), num_cycles=300)
    parallel_seed_test(lambda: envs.contest_v0.parallel_env("smoke"), num_cycles=50)
    api_test(envs.contest_v0.env("smoke"), num_cycles=300)
    seed_test(lambda: envs.contest_v0.env("smoke"), num_cycles=50)


@pytest.mark.filterwarnings("ignore")
def test_pettingzoo_finds_the_environments_by_name():
    pettingzoo = pytest.importorskip("pettingzoo", minversion="1.27")
    assert isinstance(pettingzoo.make("parallel", "wildfire/Contest-v0", scenario="smoke"), envs.contest_v0.ContestParallel)
    assert isinstance(pettingzoo.make("aec", "wildfire/Contest-v0", scenario="smoke"), envs.contest_v0.ContestAEC)


def test_masks_in_infos_are_those_of_observations():
    env = envs.TruckEnv("smoke", actions="nearest")
    seen, info = env.reset(seed=1)
    for _ in range(4):
        assert np.array_equal(info["action_mask"], seen["action_mask"])
        seen, _, _, _, info = env.step(envs.nearest(seen))
    parallel = envs.contest_v0.parallel_env("smoke")
    seen, infos = parallel.reset(seed=1)
    several = 0
    while parallel.agents:
        for name in parallel.agents:
            assert np.array_equal(infos[name]["action_mask"], seen[name]["action_mask"])
            several += infos[name]["action_mask"].sum() > 1
        chosen = {name: int(infos[name]["action_mask"].nonzero()[0][-1]) for name in parallel.agents}
        seen, _, _, _, infos = parallel.step(chosen)
    assert several > 5
    one_by_one = envs.contest_v0.env("smoke")
    one_by_one.reset(seed=1)
    for name in one_by_one.agent_iter():
        seen, _, ended, _, info = one_by_one.last()
        assert np.array_equal(info["action_mask"], seen["action_mask"])
        assert all(infos["action_mask"].sum() == 1 for other, infos in one_by_one.infos.items() if other != name)
        one_by_one.step(None if ended else int(info["action_mask"].nonzero()[0][-1]))


@pytest.mark.parametrize("scenario", ["smoke", "fleet"])
def test_who_plays_the_nearest_plays_the_rules_run(scenario):
    scenario = wf.scenario(scenario, NEAREST | {"duration_s": 600})
    expected = lead(wf.run(scenario, 3).outcome)
    env = envs.TruckEnv(scenario, actions="nearest", k=200)
    seen, _ = env.reset(seed=3)
    gained, passed_s, ended = 0.0, 0.0, False
    while not ended:
        assert seen in env.observation_space
        assert seen["agents"][:, 7].sum() == 1, "one is asked"
        assert seen["action_mask"][1:].any(), "there is something to choose from"
        seen, reward, ended, truncated, info = env.step(envs.nearest(seen))
        assert not truncated
        assert info["illegal"] == 0
        gained, passed_s = gained + reward, passed_s + info["dt_s"]
    # The points of the Wumpuses before the first question are nobody's reward.
    first, _ = env.reset(seed=3)
    assert gained + 0.0 == pytest.approx(expected + float((first["cells"] > 1).sum()))
    assert passed_s + first["time_s"][0] == pytest.approx(seen["time_s"][0], abs=1e-3)
    assert seen["action_mask"].sum() == 1


@pytest.mark.parametrize("radius_m", [40, 90])
def test_who_plays_by_sight_sees_what_a_dispatched_team_sees(radius_m):
    sight = {"sight.field": "radius", "sight.radius_m": radius_m, "dispatch.policy": "nearest", "duration_s": 500}
    scenario = wf.scenario("fleet", NEAREST | sight)
    expected = lead(wf.run(scenario, 3).outcome)
    everywhere = wf.run(wf.scenario("fleet", NEAREST | sight | {"sight.field": "everything"}), 3)
    assert expected != lead(everywhere.outcome)
    # A team decides when fires begin or end, and a wait must not end before.
    env, other = (envs.TruckEnv(scenario, observe=what, wait_s=1e6) for what in ("sight", "everything"))
    (seen, _), (everything, _) = env.reset(seed=3), other.reset(seed=3)
    rows, cols = np.nonzero(everything["cells"])
    centres = np.stack([cols, rows], axis=1) * 5 + 2.5
    # The points of the Wumpuses before the first question are nobody's reward.
    gained, ended = -float((everything["cells"] > 1).sum()), False
    while not ended:
        near = (np.linalg.norm(centres[:, None] - everything["agents"][2:, :2], axis=2) <= radius_m).any(axis=1)
        assert np.array_equal(seen["cells"][rows, cols], np.where(near, everything["cells"][rows, cols], 1))
        assert (seen["agents"][:2] == [-1, -1, 0, 0, -1, -1, 0, 0]).all(), "nobody sees a Wumpus"
        allowed = seen["action_mask"][1:].reshape(seen["cells"].shape)[rows, cols] == 1
        assert not (allowed & ~near).any()
        distances = np.linalg.norm(centres - seen["agents"][seen["agents"][:, 7] == 1][0, :2], axis=1)
        place = np.where(allowed, distances, np.inf).argmin()
        action = 1 + rows[place] * seen["cells"].shape[1] + cols[place] if allowed.any() else 0
        (seen, reward, ended, _, info), (everything, *_) = env.step(action), other.step(action)
        assert info["illegal"] == 0
        gained += reward
    assert gained == pytest.approx(expected)


def test_only_trucks_play_by_sight():
    with pytest.raises(ValueError, match="what trucks see"):
        envs.TruckEnv("fleet", play=["wumpus_0"], observe="sight")
    with pytest.raises(ValueError, match="everything"):
        envs.TruckEnv("fleet", observe="fog")


@pytest.mark.parametrize("goal", ["unimog", "wumpus"])
def test_a_policy_that_answers_as_the_rule_does_plays_the_rules_run(goal):
    rule = wf.scenario("fleet", NEAREST | {"duration_s": 400})
    own = rule.with_({f"{goal}.goal": "mine"})
    policy = envs.Policy(envs.nearest, actions="nearest", k=300)
    expected, played = wf.run(rule, 5), wf.run(own, 5, policies={"mine": policy})
    assert same_events(expected, played)
    assert list(played.agents["policy"]).count("mine") == (3 if goal == "unimog" else 2)
    batch = wf.batch(own, "5..6", policies={"mine": policy})
    assert batch.runs["truck_score"][0] == expected.outcome["truck_score"]
    with pytest.raises(wf.ScenarioError, match="no policy of this name is known"):
        wf.run(own, 5)


def test_all_cells_are_the_same_choice():
    def act(seen):
        row = int(np.flatnonzero(seen["agents"][:, 7])[0])
        x, y = seen["agents"][row, :2].astype(float)
        rows, cols = seen["cells"].shape
        options = np.flatnonzero(seen["action_mask"][1:])
        far = np.hypot((options % cols + 0.5) * 5 - x, (options // cols + 0.5) * 5 - y)
        assert set(seen["cells"].reshape(-1)[options]) == {2}
        return 1 + options[np.argmin(far)]

    rule = wf.scenario("smoke", NEAREST)
    played = wf.run(rule.with_({"unimog.goal": "mine"}), 2, policies={"mine": act})
    assert same_events(wf.run(rule, 2), played)


def test_who_fails_to_answer_waits(capfd):
    calls = []

    def broken(_):
        calls.append(1)
        raise RuntimeError("no idea")

    scenario = wf.scenario("smoke", {"unimog.goal": "mine"})
    run = wf.run(scenario, 1, policies={"mine": broken})
    assert run.outcome["extinguished"] == 0
    assert run.outcome["truck_stuck_s"] == 0
    assert len(calls) > 3
    assert capfd.readouterr().err.count("RuntimeError: no idea") == 1, "the first is printed whole"
    asked = run.outcome["policy_asked"]
    assert asked > 0 and run.outcome["policy_failed_crashed"] == asked
    assert "policy mine at " in run.messages[0]
    text = wf.run(scenario, 1, policies={"mine": lambda _: "west"})
    assert text.outcome["policy_failed_bad_answer"] == text.outcome["policy_asked"]
    waits = wf.run(scenario, 1, policies={"mine": lambda _: None})
    assert waits.outcome["policy_asked"] > 0 and waits.outcome["policy_failed_bad_answer"] == 0 and not waits.messages
    nonsense = wf.run(scenario, 1, policies={"mine": lambda _: 10**9})
    assert nonsense.outcome["policy_illegal"] == nonsense.outcome["policy_asked"]
    assert nonsense.outcome["extinguished"] == 0

    def end(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        wf.run(scenario, 1, policies={"mine": end})


def test_crews_build_line_where_a_policy_says():
    asked = []

    def act(seen):
        asked.append(seen["line"])
        return np.array([[60, 60], [300, 60], [300, 300]])

    scenario = wf.scenario("line", {"line.policy": "mine", "duration_s": 3000})
    run = wf.run(scenario, 1, policies={"mine": act})
    assert len(asked) == 1 and asked[0]["crews"][0]["count"] == 4 and asked[0]["square_m"] == 10
    times = np.array(asked[0]["forecast_s"], dtype=float)
    assert times.shape == (60, 60) and np.nanmin(times) == 300
    assert run.outcome["line_built_m"] > 400 and run.outcome["policy_failed_bad_answer"] == 0
    for answer in ([], None, [[1, 2, 3]], [[1, 2], [3, float("nan")]]):
        idle = wf.run(scenario, 1, policies={"mine": lambda _, answer=answer: answer})
        assert idle.outcome["policy_failed_bad_answer"] == 1 and idle.outcome["line_built_m"] == 0


def test_a_policy_is_made_once_in_every_run():
    made = []

    def make(site):
        made.append(site)
        return lambda _: 0

    scenario = wf.scenario("fleet", {"unimog.0.goal": "mine", "unimog.2.goal": "mine", "duration_s": 60})
    scenario = scenario.with_({"policy.mine.settings.depth": 3})
    batch = wf.batch(scenario, "1..3", policies={"mine": envs.Policy(make, per_run=True)})
    assert list(batch.runs["policy"]) == ["mine;nearest-burning;mine"] * 3
    assert [site["plays"] for site in made] == [["unimog/0", "unimog/2"]] * 3
    assert [site["settings"] for site in made] == [{"depth": 3}] * 3
    assert len({site["draw"] for site in made}) == 3


def test_masked_actions_wait_and_others_are_refused():
    env = envs.TruckEnv("smoke")
    seen, _ = env.reset(seed=1)
    wrong = int(np.flatnonzero(seen["action_mask"] == 0)[0])
    after, _, _, _, info = env.step(wrong)
    assert info["illegal"] == 1
    assert 0 < info["dt_s"] <= 10.0 + 1e-6
    env.reset(seed=1)
    waited, _, _, _, info = env.step(0)
    assert info["illegal"] == 0
    assert all(np.array_equal(after[name], waited[name]) for name in seen)
    for outside in (-1, env.action_space.n):
        with pytest.raises(ValueError, match="expected 0 to"):
            env.step(outside)
    with pytest.raises(ValueError, match="unimog_0"):
        envs.TruckEnv("smoke", play=["unimog_7"])


def test_who_has_not_begun_is_told_so():
    for env in (envs.TruckEnv("smoke"), envs.contest_v0.parallel_env("smoke"), envs.contest_v0.env("smoke")):
        with pytest.raises(IndexError, match="call reset first"):
            env.step({} if isinstance(env, envs.contest_v0.ContestParallel) else 0)
    with pytest.raises(IndexError, match="call reset first"):
        TruckVectorEnv(2, "smoke").step(np.zeros(2, np.int64))


def test_a_mask_restarts_some_of_the_contests():
    vector = TruckVectorEnv(3, "smoke", actions="nearest")
    began_s = vector.reset(seed=5)[0]["time_s"][:, 0].copy()
    for _ in range(4):
        seen, _, _, _, infos = vector.step(np.ones(3, np.int64))
        assert np.array_equal(infos["action_mask"], seen["action_mask"])
    seen, _ = vector.reset(options={"reset_mask": [True, False, False]})
    assert (seen["time_s"][1:, 0] > began_s[1:]).all()
    seen, _ = vector.reset(options={"reset_mask": np.array([False, True, False])}, seed=[None, 6, None])
    assert seen["time_s"][1, 0] == began_s[1]
    assert seen["time_s"][2, 0] > began_s[2]
    with pytest.raises(ValueError, match="reset_mask has shape"):
        vector.reset(options={"reset_mask": [True]})
    with pytest.raises(ValueError, match=r"found actions of shape \(3, 1\); expected \(3,\)"):
        vector.step(np.ones((3, 1)))


def test_learners_find_masks_and_vectors():
    env = gymnasium.make("wildfire/Truck-v0", scenario="smoke")
    seen, _ = env.reset(seed=1)
    masks = env.get_wrapper_attr("action_masks")()
    assert masks.dtype == bool and np.array_equal(masks, seen["action_mask"] == 1)
    vector = gymnasium.make_vec("wildfire/Truck-v0", 3, scenario="smoke", threads=2)
    assert isinstance(vector.unwrapped, TruckVectorEnv) and vector.num_envs == 3


def test_gymnasium_alone_is_enough():
    script = "import sys; sys.modules['pettingzoo'] = None; import wildfire_contest as wf; wf.envs.TruckEnv('smoke').reset()"
    subprocess.run([sys.executable, "-c", script], check=True)


def test_seeds_to_train_and_to_test_with_do_not_meet():
    assert set(range(1, 1001)) <= set(envs.TEST_SEEDS[1:1001])
    assert envs.TEST_SEEDS.stop <= envs.TRAINING_SEEDS.start
    one, other = envs.TruckEnv("smoke"), envs.TruckEnv("smoke")
    one.reset(seed=4)
    other.reset(seed=4)
    for _ in range(3):
        drawn = [env.reset()[0] for env in (one, other)]
        assert np.array_equal(drawn[0]["cells"], drawn[1]["cells"])
    generator = np.random.default_rng(0)
    assert all(envs.random_seed(generator) in envs.TRAINING_SEEDS for _ in range(1000))


@pytest.mark.parametrize("actions", ["cells", "nearest"])
def test_contests_side_by_side_are_those_of_one(actions):
    n, steps = 5, 60
    vectors = [TruckVectorEnv(n, "smoke", actions=actions, threads=threads) for threads in (1, 3)]
    single = [envs.TruckEnv("smoke", actions=actions) for _ in range(n)]
    for vector in vectors:
        vector.reset(seed=7)
    alone = [env.reset(seed=7 + lane)[0] for lane, env in enumerate(single)]
    over = np.zeros(n, bool)
    dice = np.random.default_rng(1)
    for _ in range(steps):
        masks = vectors[0]._seen["action_mask"]
        chosen = np.array([dice.choice(np.flatnonzero(mask)) for mask in masks])
        results = [vector.step(chosen) for vector in vectors]
        for name in results[0][0]:
            assert np.array_equal(results[0][0][name], results[1][0][name]), "threads change nothing"
        for lane in np.flatnonzero(~over):
            seen, reward, ended, _, info = single[lane].step(chosen[lane])
            alone[lane] = seen
            assert all(np.array_equal(seen[name], results[0][0][name][lane]) for name in seen)
            assert (reward, ended) == (results[0][1][lane], results[0][2][lane])
            assert info["dt_s"] == results[0][4]["dt_s"][lane]
            over[lane] = ended


@pytest.mark.parametrize("autoreset", ["next-step", "same-step"])
def test_contests_that_ended_begin_again(autoreset):
    vector = TruckVectorEnv(3, "smoke", autoreset=autoreset, actions="nearest")
    seen, _ = vector.reset(seed=1)
    ends, before = 0, np.zeros(3, bool)
    for _ in range(400):
        chosen = np.array([envs.nearest({"action_mask": mask}) for mask in seen["action_mask"]])
        seen, reward, ended, truncated, infos = vector.step(chosen)
        assert not truncated.any()
        if autoreset == "next-step":
            assert (reward[before] == 0).all()
            assert (seen["time_s"][before, 0] < 60).all()
        elif ended.any():
            assert (seen["time_s"][ended, 0] < 60).all()
            assert all(infos["final_obs"][lane]["action_mask"].sum() == 1 for lane in np.flatnonzero(ended))
        ends, before = ends + ended.sum(), ended.copy()
    assert ends >= 3


def test_whole_episodes_of_several_agents():
    scenario = wf.scenario("fleet", NEAREST | {"duration_s": 500})
    expected = lead(wf.run(scenario, 2).outcome)
    env = envs.contest_v0.parallel_env(scenario, actions="nearest", k=300)
    seen, infos = env.reset(seed=2)
    before = env._contest.contests.facts(0)
    sums = dict.fromkeys(env.possible_agents, 0.0)
    while env.agents:
        asked = {name for name in env.agents if seen[name]["action_mask"][1:].any()}
        assert asked, "somebody is asked"
        assert set(seen) == set(infos) == set(env.possible_agents)
        # Who is not asked is not listened to.
        chosen = {name: envs.nearest(seen[name]) if name in asked else 1 for name in env.agents}
        seen, rewards, ends, cuts, infos = env.step(chosen)
        assert all(seen[name] in env.observation_space(name) for name in seen)
        assert all(infos[name]["illegal"] == 0 for name in infos)
        assert not any(cuts.values())
        assert len(set(ends.values())) == 1
        for name, reward in rewards.items():
            sums[name] += reward
    assert env._contest.contests.facts(0) > before
    trucks = {sums[name] for name in sums if name.startswith("unimog")}
    assert trucks == {expected}
    assert {sums[name] for name in sums if name.startswith("wumpus")} == {-expected}

    turns = envs.contest_v0.env(scenario, actions="nearest", k=300)
    turns.reset(seed=2)
    totals = dict.fromkeys(turns.possible_agents, 0.0)
    for name in turns.agent_iter():
        seen, reward, ended, _, _ = turns.last()
        totals[name] += reward
        turns.step(None if ended else envs.nearest(seen))
    assert totals == sums


def test_a_truck_is_steered_to_its_goal_or_into_something():
    env = gymnasium.make("wildfire/Drive-v0")
    check_env(env.unwrapped, skip_render_check=True)
    seen, _ = env.reset(seed=3)
    again, _ = env.reset(seed=3)
    assert all(np.array_equal(seen[name], again[name]) for name in seen)
    far = float(np.hypot(*seen["goal"][:2]))
    assert far > 30
    assert seen["clearance"][31:33, 31:33].min() > 0, "the truck stands where nothing is"
    nearer, steps, ended = 0.0, 0, False
    while not ended:
        bearing = np.arctan2(seen["goal"][1], seen["goal"][0])
        seen, reward, ended, cut, info = env.step(np.array([np.clip(bearing, -1, 1), 1.0], np.float32))
        assert not cut
        steps += 1
        last = 0.0 if not ended else 10.0 if info["arrived"] else -10.0
        nearer += reward - last
        assert far - nearer == pytest.approx(np.hypot(*seen["goal"][:2]), abs=1e-3)
    assert steps > 2
    with pytest.raises(ValueError, match="from -1 to 1"):
        env.unwrapped.step(np.array([2.0, 0.0], np.float32))


def test_pictures_have_three_colours():
    env = envs.TruckEnv("smoke", render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert picture.shape == (800, 800, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 5
    assert envs.TruckEnv("smoke").render() is None


@pytest.mark.parametrize("actions", ["cells", "nearest"])
def test_a_restored_contest_goes_on_as_the_saved_one_did(actions):
    env = envs.TruckEnv("fleet", actions=actions)
    choose = envs.nearest if actions == "nearest" else lambda seen: int(np.flatnonzero(seen["action_mask"])[-1])
    seen, _ = env.reset(seed=3)
    for _ in range(25):
        seen = env.step(choose(seen))[0]
    saved = env.save()
    copies = [saved, pickle.loads(pickle.dumps(saved))]

    def go_on(seen, steps):
        trace = []
        for _ in range(steps):
            seen, reward, *_ = env.step(choose(seen))
            trace.append((reward, seen["time_s"].tolist(), seen["agents"].tolist(), seen["cells"].tolist()))
        return trace

    expected = go_on(seen, 40)
    for copy in copies:
        restored, info = env.restore(copy)
        assert (info["dt_s"], info["illegal"]) == (0.0, 0)
        assert np.array_equal(info["action_mask"], restored["action_mask"])
        assert all(np.array_equal(restored[name], seen[name]) for name in seen)
        assert go_on(restored, 40) == expected
        futures = [go_on(env.restore(copy, future=future)[0], 40) for future in (1, 1, 2)]
        assert futures[0] == futures[1] != futures[2]
        assert futures[0] != expected
    # A future is part of what is saved.
    seen, _ = env.restore(saved, future=2)
    seen = env.step(choose(seen))[0]
    again = pickle.loads(pickle.dumps(env.save()))
    expected = go_on(seen, 39)
    assert expected == futures[2][1:]
    assert go_on(env.restore(again)[0], 39) == expected
    with pytest.raises(ValueError, match="other settings"):
        envs.TruckEnv("smoke", actions=actions).restore(saved)
    with pytest.raises(IndexError, match="reset first"):
        envs.TruckEnv("smoke", actions=actions).save()
