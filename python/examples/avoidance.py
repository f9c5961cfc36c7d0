"""A task for rtmsim.Env: cross the obstacle course without touching anything."""
import math
import os
import pathlib

import numpy
import rtmsim
from rtmsim.env import spaces

sectors = 16  # of the scan; the robot sees the nearest thing in each


def world_file(name: str) -> str:
    """A world of rtm-sim: in the source tree, else installed."""
    for folder in (pathlib.Path(__file__).resolve().parents[2] / "worlds", pathlib.Path("/usr/share/rtm-sim/worlds")):
        if (folder / name).exists():
            return os.fspath(folder / name)
    raise FileNotFoundError(name)


class Avoidance(rtmsim.Env):
    """Observation: for each sector the distance of the nearest thing [m], then the measured vx [m/s] and va [rad/s].
    Action: vx [m/s], va [rad/s]. Reward: the way forward [m] of each step, -10 for a contact, which ends the episode."""

    def __init__(self, **options):
        super().__init__(world_file("obstacle_course.sdf"), physics_steps=100, **options)
        self.observation_space = spaces.Box(-10.0, 10.0, (sectors + 2,), numpy.float32)
        self.action_space = spaces.Box(numpy.float32([0, -1.5]), numpy.float32([0.5, 1.5]), dtype=numpy.float32)
        self._drive = self.world.drive("pioneer2dx")
        self._reach = self.world.info("pioneer2dx::laser")["max_range"]

    def start(self, world, random):
        world.set_pose("pioneer2dx", (-4.5, -4.5, random.uniform(0, math.pi / 2)))

    def act(self, world, action):
        self._drive.velocity(float(action[0]), va=float(action[1]))

    def observe(self, world):
        scan = numpy.nan_to_num(world.scan("pioneer2dx::laser"), posinf=self._reach, neginf=0)
        nearest = [part.min() for part in numpy.array_split(scan, sectors)]
        velocity = self._drive.measured_velocity
        return numpy.array([*nearest, velocity[0], velocity[2]], numpy.float32)

    def judge(self, world, observation):
        hits = [contact for contact in world.contacts("pioneer2dx") if "ground" not in contact["other"]]
        way = float(observation[-2]) * self.physics_steps * world.step_size
        return (way - 10 if hits else way), bool(hits)
