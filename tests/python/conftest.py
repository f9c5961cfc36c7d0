# Shared by the tests of the Python module: folders of this build, and that nothing stays in shared memory.
import os
import pathlib

import pytest

source = pathlib.Path(__file__).resolve().parents[2]
course = str(source / "worlds" / "obstacle_course.sdf")


@pytest.fixture(scope="session")
def worlds():
    return source / "worlds"


@pytest.fixture(scope="session")
def test_worlds():
    return source / "tests" / "worlds"


@pytest.fixture
def course_world():
    import rtmsim
    with rtmsim.World(course, seed=1) as world:
        yield world


def segments_of(server_id):
    prefix = f"rtmsim-{os.getuid()}-{server_id}."
    return [name for name in os.listdir("/dev/shm") if name.startswith(prefix)]


# Waits for a condition, at most 30 s.
def until(condition):
    import time
    end = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end, "the condition did not become true"
        time.sleep(0.01)
