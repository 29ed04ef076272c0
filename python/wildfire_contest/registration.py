"""The environments' names in Gymnasium's registry. Gymnasium calls `register_envs` when it is imported."""

from gymnasium.envs.registration import register, registry


def register_envs() -> None:
    """Register the environments, once."""
    if "wildfire/Truck-v0" in registry:
        return
    register(
        id="wildfire/Truck-v0",
        entry_point="wildfire_contest.envs:TruckEnv",
        vector_entry_point="wildfire_contest.vector:truck_vector_env",
    )
    register(id="wildfire/Drive-v0", entry_point="wildfire_contest.envs:DriveEnv", max_episode_steps=1000)
