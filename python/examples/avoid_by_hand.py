#!/usr/bin/env python3
"""An agent written by hand in several obstacle courses at the same time: it turns to where there is most room."""
import argparse

import numpy
import rtmsim
from avoidance import Avoidance, sectors

options = argparse.ArgumentParser(description=__doc__)
options.add_argument("--episodes", type=int, default=4, help="Number of episodes to finish (default 4)")
options.add_argument("--worlds", type=int, default=2, help="Number of worlds at the same time (default 2)")
options.add_argument("--seed", type=int, default=1, help="Seed of the first world (default 1)")
options.add_argument("--time-limit", type=float, default=20, help="Simulated seconds of an episode (default 20)")
chosen = options.parse_args()


def act(observation):
    distances = observation[:sectors]
    ahead = distances[sectors // 2 - 3:sectors // 2 + 3].min()
    if ahead > 0.9:
        return 0.4, 0.0
    right, left = distances[:sectors // 2].mean(), distances[sectors // 2:].mean()
    return (0.1 if ahead > 0.5 else 0.0), (1.0 if left > right else -1.0)


with rtmsim.BatchEnv(lambda: Avoidance(time_limit=chosen.time_limit), chosen.worlds) as batch:
    observations, _ = batch.reset(seed=chosen.seed)
    totals, finished = numpy.zeros(chosen.worlds), 0
    while finished < chosen.episodes:
        observations, rewards, terminated, truncated, infos = batch.step([act(one) for one in observations])
        totals += rewards
        for world in numpy.flatnonzero(terminated | truncated):
            print(f"episode {finished}, world {world}: reward {totals[world]:.2f} in {infos[world]['time']:.1f} s"
                  + (", touched something" if terminated[world] else ""))
            totals[world], finished = 0, finished + 1
