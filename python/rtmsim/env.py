"""Env and BatchEnv: worlds as environments for learning, in the shape of gymnasium.

Where gymnasium is installed, Env is a subclass of gymnasium.Env and its spaces are those of gymnasium. Otherwise the stand-ins of this
module have the same members.
"""
from __future__ import annotations

import numpy

from . import _core
from ._core import Error
from .world import World, step_all

try:
    import gymnasium
    Base = gymnasium.Env
    spaces = gymnasium.spaces
    is_gymnasium = True
except ImportError:
    is_gymnasium = False

    class _Space:
        def __init__(self, shape, dtype, seed=None):
            self.shape, self.dtype = shape, numpy.dtype(dtype)
            self._random = numpy.random.default_rng(seed)

        def seed(self, seed=None):
            self._random = numpy.random.default_rng(seed)
            return seed

    class Box(_Space):
        """Arrays between low and high."""

        def __init__(self, low, high, shape=None, dtype=numpy.float32, seed=None):
            shape = shape if shape is not None else numpy.broadcast(low, high).shape
            super().__init__(tuple(shape), dtype, seed)
            self.low = numpy.broadcast_to(numpy.asarray(low, dtype), self.shape).copy()
            self.high = numpy.broadcast_to(numpy.asarray(high, dtype), self.shape).copy()

        def sample(self):
            low = numpy.where(numpy.isfinite(self.low), self.low, -1e6)
            high = numpy.where(numpy.isfinite(self.high), self.high, 1e6)
            return self._random.uniform(low, high).astype(self.dtype)

        def contains(self, x):
            x = numpy.asarray(x)
            return x.shape == self.shape and bool(numpy.all(x >= self.low)) and bool(numpy.all(x <= self.high))

        __contains__ = contains

        def __repr__(self):
            return f"Box({self.low.min() if self.low.size else ''}, {self.high.max() if self.high.size else ''}, {self.shape}, {self.dtype})"

    class Discrete(_Space):
        """Whole numbers from start on, n of them."""

        def __init__(self, n, seed=None, start=0):
            super().__init__((), numpy.int64, seed)
            self.n, self.start = int(n), int(start)

        def sample(self):
            return self.start + int(self._random.integers(self.n))

        def contains(self, x):
            return float(x) == int(x) and self.start <= int(x) < self.start + self.n

        __contains__ = contains

        def __repr__(self):
            return f"Discrete({self.n})"

    class Dict(_Space):
        """A dict of spaces."""

        def __init__(self, parts, seed=None):
            super().__init__(None, object, seed)
            self.spaces = dict(parts)

        def seed(self, seed=None):
            for number, part in enumerate(self.spaces.values()):
                part.seed(None if seed is None else seed + number)
            return seed

        def sample(self):
            return {name: part.sample() for name, part in self.spaces.items()}

        def contains(self, x):
            return isinstance(x, dict) and x.keys() == self.spaces.keys() and all(part.contains(x[n]) for n, part in self.spaces.items())

        __contains__ = contains

        def __getitem__(self, name):
            return self.spaces[name]

    class spaces:  # noqa: N801, as gymnasium names its module
        Box, Discrete, Dict = Box, Discrete, Dict

    class Base:
        """What gymnasium.Env has."""

        metadata: dict = {"render_modes": []}
        render_mode = None
        spec = None
        _random = None

        @property
        def unwrapped(self):
            """This."""
            return self

        @property
        def np_random(self):
            """The random numbers of this environment, seeded by reset()."""
            if self._random is None:
                self._random = numpy.random.default_rng()
            return self._random

        @np_random.setter
        def np_random(self, value):
            self._random = value

        def reset(self, *, seed=None, options=None):
            if seed is not None:
                self._random = numpy.random.default_rng(seed)

        def step(self, action):
            raise NotImplementedError

        def render(self):
            raise NotImplementedError

        def close(self):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            self.close()
            return False


class Env(Base):
    """A world as an environment. A task is a subclass that sets `observation_space` and `action_space` and has these methods:

    act(world, action)             commands the robot; called before the steps
    observe(world)                 the observation, in observation_space
    judge(world, observation)      (reward, terminated); called after the steps
    start(world, random)           optional: arranges the world after a reset, with a numpy Generator

    `world`: as of World, or a World. `physics_steps`: in each step(). `time_limit`: simulated seconds until `truncated`; None: never.
    `render_mode`: None or "rgb_array", a uint8 array (height, width, 3).

    reset(seed=...) seeds the sensor noise and `np_random`; without a seed the next seed is drawn from np_random, so each episode differs
    and a whole sequence repeats. A reset takes some milliseconds; nothing is started again.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(self, world, *, physics_steps: int = 10, time_limit: float | None = None, render_mode: str | None = None, **world_options):
        if render_mode not in (None, "rgb_array"):
            raise Error(f"render_mode must be None or 'rgb_array', got {render_mode!r}")
        self.render_mode = render_mode
        self.physics_steps = _core.whole("physics_steps", physics_steps, 1)
        self.time_limit = None if time_limit is None else _core.seconds("time_limit", time_limit)
        self._owns_world = not isinstance(world, World)
        self.world = World(world, **world_options) if self._owns_world else world

    def act(self, world: World, action) -> None:
        """Commands the robot. Of the task."""
        raise NotImplementedError("act(world, action) of this task")

    def observe(self, world: World):
        """The observation, in observation_space. Of the task."""
        raise NotImplementedError("observe(world) of this task")

    def judge(self, world: World, observation):
        """(reward, terminated). Of the task."""
        raise NotImplementedError("judge(world, observation) of this task")

    def start(self, world: World, random) -> None:
        """Arranges the world after a reset; by default nothing."""

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        """Returns (observation, info)."""
        super().reset(seed=None if seed is None else _core.seed(seed))
        self.world.reset(int(self.np_random.integers(1 << 62)))
        self.start(self.world, self.np_random)
        return self.observe(self.world), {"time": self.world.time}

    def step(self, action):
        """Returns (observation, reward, terminated, truncated, info)."""
        self.act(self.world, action)
        return self._outcome(self.world.step(self.physics_steps))

    def _outcome(self, time: float):
        observation = self.observe(self.world)
        reward, terminated = self.judge(self.world, observation)
        truncated = self.time_limit is not None and time >= self.time_limit - 1e-9
        return observation, float(reward), bool(terminated), bool(truncated), {"time": time}

    def render(self):
        """The world from above: a uint8 array (height, width, 3), or None without a render mode."""
        return self.world.screenshot(640, 480, top=True) if self.render_mode else None

    def close(self) -> None:
        """Closes the world, unless it was given as a World. Several calls are allowed."""
        if self._owns_world:
            self.world.close()


class BatchEnv:
    """Several environments of one task, stepped at the same time: each has a simulator process, and all make their steps in parallel.

    `make`: a function that returns an Env. Observations, rewards, terminated and truncated are arrays with one row per environment. An
    environment whose episode has ended is reset in the same step(): the observation is then the first one of the next episode, and
    infos[i]["final_observation"] the last one of the old.
    """

    def __init__(self, make, count: int):
        self.envs: list[Env] = []
        count = _core.whole("count", count, 1)
        try:
            for _ in range(count):
                env = make()
                if not isinstance(env, Env):
                    raise Error(f"BatchEnv: expected a function that returns an Env, got {_core.shown(env)}")
                self.envs.append(env)
        except BaseException:
            self.close()
            raise
        self.num_envs = count
        self.single_observation_space = self.envs[0].observation_space
        self.single_action_space = self.envs[0].action_space

    def reset(self, *, seed: int | None = None):
        """Environment i gets seed + i. Returns (observations, infos)."""
        first = None if seed is None else _core.seed(seed)
        made = [env.reset(seed=None if first is None else first + number) for number, env in enumerate(self.envs)]
        return _stack([one[0] for one in made]), [one[1] for one in made]

    def step(self, actions):
        """Returns (observations, rewards, terminated, truncated, infos)."""
        if len(actions) != len(self.envs):
            raise Error(f"expected {len(self.envs)} actions, one per environment, got {len(actions)}")
        for env, action in zip(self.envs, actions):
            env.act(env.world, action)
        steps = {env.physics_steps for env in self.envs}
        if len(steps) == 1:
            times = step_all([env.world for env in self.envs], steps.pop())
        else:
            times = [env.world.step(env.physics_steps) for env in self.envs]
        outcomes = [env._outcome(time) for env, time in zip(self.envs, times)]
        observations, infos = [], []
        for env, (observation, _, terminated, truncated, info) in zip(self.envs, outcomes):
            if terminated or truncated:
                info["final_observation"] = observation
                observation, first = env.reset()
                info["reset"] = first
            observations.append(observation)
            infos.append(info)
        column = lambda index, dtype: numpy.array([outcome[index] for outcome in outcomes], dtype)  # noqa: E731
        return _stack(observations), column(1, numpy.float64), column(2, bool), column(3, bool), infos

    def close(self) -> None:
        """Closes all environments."""
        for env in self.envs:
            env.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def _stack(observations):
    if isinstance(observations[0], dict):
        return {name: _stack([one[name] for one in observations]) for name in observations[0]}
    return numpy.stack([numpy.asarray(one) for one in observations])
