# rtmsim.Env and rtmsim.BatchEnv, with the stand-ins and with a package that is named gymnasium.
import subprocess
import sys

import numpy
import pytest
import rtmsim
from conftest import course, source
from rtmsim import env as module


class Drive(rtmsim.Env):
    """Drive straight on."""

    def __init__(self, **options):
        super().__init__(course, physics_steps=20, **options)
        self.observation_space = module.spaces.Box(-numpy.inf, numpy.inf, (683,), numpy.float32)
        self.action_space = module.spaces.Box(-0.5, 0.5, (2,), numpy.float32)
        self._drive = self.world.drive("pioneer2dx")

    def act(self, world, action):
        self._drive.velocity(float(action[0]), va=float(action[1]))

    def observe(self, world):
        return numpy.append(world.scan("pioneer2dx::laser"), numpy.float32(self._drive.odometry[0]))

    def judge(self, world, observation):
        return float(observation[-1]), observation[-1] > 5


@pytest.fixture
def env():
    with Drive(time_limit=1.0) as made:
        yield made


def test_an_episode_has_the_shape_of_gymnasium(env):
    observation, info = env.reset(seed=5)
    assert observation.shape == (683,) and info["time"] == 0
    steps = 0
    while True:
        observation, reward, terminated, truncated, info = env.step([0.4, 0.0])
        steps += 1
        assert type(reward) is float and type(terminated) is bool and type(truncated) is bool
        if truncated or terminated:
            break
    assert truncated and steps == 50 and info["time"] == pytest.approx(1)
    assert reward > 0.1
    assert env.unwrapped is env
    assert env.render() is None
    env.close()
    env.close()


def test_a_seed_repeats_all_episodes_that_follow(env):
    def episodes():
        seen = [env.reset(seed=9)[0], env.step([0.1, 0])[0], env.reset()[0], env.step([0.1, 0])[0]]
        return numpy.stack(seen)
    first, second = episodes(), episodes()
    assert numpy.array_equal(first, second)
    assert not numpy.array_equal(first[0], first[2])


def test_the_world_is_rendered_as_an_array():
    with Drive(render_mode="rgb_array") as env:
        env.reset(seed=1)
        assert env.render().shape == (480, 640, 3)
    with pytest.raises(rtmsim.Error, match="render_mode"):
        Drive(render_mode="human")


def test_a_batch_does_what_its_environments_do_alone(env):
    with rtmsim.BatchEnv(lambda: Drive(time_limit=0.1), 3) as batch:
        observations, infos = batch.reset(seed=20)
        assert observations.shape == (3, 683) and len(infos) == 3
        actions = [[0.02, 0], [0.05, 0], [0.3, 0]]
        for number in range(5):
            observations, rewards, terminated, truncated, infos = batch.step(actions)
        assert truncated.tolist() == [True, True, True] and not terminated.any()
        assert infos[1]["final_observation"].shape == (683,)
        assert rewards.shape == (3,) and rewards[2] > rewards[0]
        last = [info["final_observation"] for info in infos]
        with pytest.raises(rtmsim.Error, match="one per environment"):
            batch.step(actions[:2])
    env.reset(seed=21)
    for number in range(5):
        alone, *_ = env.step(actions[1])
    assert numpy.array_equal(alone, last[1])


def test_spaces_of_the_stand_in_sample_what_they_contain():
    if module.is_gymnasium:
        pytest.skip("gymnasium is installed")
    box = module.spaces.Box(-1, [1, 2, 3], dtype=numpy.float64)
    space = module.spaces.Dict({"box": box, "number": module.spaces.Discrete(3, start=1)})
    space.seed(4)
    first = space.sample()
    assert space.contains(first) and first in space
    space.seed(4)
    assert numpy.array_equal(space.sample()["box"], first["box"])
    assert not box.contains([0, 0, 9]) and not space["number"].contains(4)


def test_where_gymnasium_is_installed_an_env_is_one_of_its(tmp_path):
    (tmp_path / "gymnasium").mkdir()
    (tmp_path / "gymnasium" / "__init__.py").write_text(
        "from . import spaces\nclass Env:\n    def reset(self, *, seed=None, options=None): self.seeded = seed\n")
    (tmp_path / "gymnasium" / "spaces.py").write_text("class Box: pass\n")
    text = (f"import sys; sys.path.insert(0, {str(tmp_path)!r})\nimport gymnasium, rtmsim\nfrom rtmsim import env\n"
            "assert issubclass(rtmsim.Env, gymnasium.Env) and env.spaces is gymnasium.spaces and env.is_gymnasium\n")
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", ["random_agent.py", "avoid_by_hand.py"])
def test_the_examples_run(example):
    done = subprocess.run([sys.executable, source / "python" / "examples" / example, "--episodes", "1", "--time-limit", "2"], capture_output=True,
                          text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "episode" in done.stdout
