#!/usr/bin/env python3
"""An agent without a plan in the obstacle course: prints the reward of each episode."""
import argparse

from avoidance import Avoidance

options = argparse.ArgumentParser(description=__doc__)
options.add_argument("--episodes", type=int, default=3, help="Number of episodes (default 3)")
options.add_argument("--seed", type=int, default=1, help="Seed of the first episode (default 1)")
options.add_argument("--time-limit", type=float, default=20, help="Simulated seconds of an episode (default 20)")
chosen = options.parse_args()

with Avoidance(time_limit=chosen.time_limit) as env:
    env.action_space.seed(chosen.seed)
    for episode in range(chosen.episodes):
        env.reset(seed=chosen.seed if episode == 0 else None)
        total, ended = 0.0, False
        while not ended:
            _, reward, terminated, truncated, info = env.step(env.action_space.sample())
            total += reward
            ended = terminated or truncated
        print(f"episode {episode}: reward {total:.2f} in {info['time']:.1f} s" + (", touched something" if terminated else ""))
