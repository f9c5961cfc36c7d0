"""Fixtures `world` and `system` (also rtmsim_world, rtmsim_system), and the mark `rtmsim`. Every pytest loads this module, so it imports nothing of rtmsim before a fixture does.

    @pytest.mark.rtmsim("worlds/obstacle_course.sdf", seeds=range(3))
    def test_the_robot_drives(world):
        world.drive("pioneer2dx").velocity(0.3)
        world.advance(2)

Without `seeds` the seed is 1. A test that fails reports the seed and the command that repeats it.
"""
from __future__ import annotations

import os

import pytest


def pytest_configure(config):
    config.addinivalue_line("markers", "rtmsim(world, seed=1, seeds=None, ...): world of the fixture `world`, as the arguments of rtmsim.World; "
                                       "`seeds`: the test runs once per seed")


def pytest_generate_tests(metafunc):
    mark = metafunc.definition.get_closest_marker("rtmsim")
    seeds = mark.kwargs.get("seeds") if mark else None
    if seeds is not None:
        if "_rtmsim_seed" not in metafunc.fixturenames:
            metafunc.fixturenames.append("_rtmsim_seed")
        metafunc.parametrize("_rtmsim_seed", list(seeds), ids=lambda seed: f"seed{seed}")


def _marked(request):
    mark = request.node.get_closest_marker("rtmsim")
    if mark is None:
        return None, {}
    options = dict(mark.kwargs)
    options.pop("seeds", None)
    world = mark.args[0] if mark.args else options.pop("world", None)
    callspec = getattr(request.node, "callspec", None)
    if callspec is not None and "_rtmsim_seed" in callspec.params:
        options["seed"] = callspec.params["_rtmsim_seed"]
    return world, options


def _found(request, file):
    """A path is one from the folder of the test file, then from the root of the tests."""
    if isinstance(file, str) and "<" in file:
        return file
    for folder in (request.path.parent, request.config.rootpath):
        if (folder / os.fspath(file)).exists():
            return str(folder / os.fspath(file))
    return file


@pytest.fixture
def rtmsim_world(request, record_property):
    """A rtmsim.World as the mark says, at time 0; closed after the test."""
    import rtmsim
    file, options = _marked(request)
    if file is None:
        pytest.fail("the fixture `world` needs a mark: @pytest.mark.rtmsim(\"FILE.sdf\")", pytrace=False)
    record_property("seed", options.get("seed", 1))
    with rtmsim.World(_found(request, file), **options) as world:
        request.node._rtmsim_world = (world.seed, world)
        yield world


@pytest.fixture
def world(rtmsim_world):
    """The same as rtmsim_world."""
    return rtmsim_world


@pytest.fixture
def rtmsim_system(request, record_property, tmp_path):
    """A function run(system, world=None, **options) as rtmsim.run(). The world and the seed are those of the mark. It records; a test that
    fails keeps the recording and reports its file and the command that repeats the run."""
    import rtmsim
    file, marked = _marked(request)
    results = request.node._rtmsim_results = []

    def run(system, world=None, **options):
        if "seed" in marked:
            options.setdefault("seed", marked["seed"])
        options.setdefault("record", tmp_path / f"run{len(results)}.mcap")
        world = file if world is None else world
        if world is None:
            raise rtmsim.Error("the fixture `system` needs a world: a mark @pytest.mark.rtmsim(\"FILE.sdf\"), or an argument")
        outcome = rtmsim.run(_found(request, system), _found(request, world), **options)
        results.extend(outcome if isinstance(outcome, list) else [outcome])
        record_property("seed", results[-1].seed)
        return outcome

    return run


@pytest.fixture
def system(rtmsim_system):
    """The same as rtmsim_system."""
    return rtmsim_system


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    report = (yield).get_result()
    if call.when != "call":
        return
    results = getattr(item, "_rtmsim_results", [])
    if report.passed:
        for result in results:
            if result.recording and os.path.exists(result.recording):
                os.remove(result.recording)
        return
    lines = []
    seed_and_world = getattr(item, "_rtmsim_world", None)
    if seed_and_world:
        try:
            lines.append(f"seed {seed_and_world[0]}, time {seed_and_world[1].time:.3f} s, state hash {seed_and_world[1].hash()}")
        except Exception as problem:
            lines.append(f"seed {seed_and_world[0]}; {problem}")
    for result in results:
        lines.append(f"{'passed' if result.passed else result.why}\nrepeat: {result.command}")
        if not os.path.exists(result.recording):
            continue
        lines.append(f"recording: {result.recording}")
        page = _page_of(result)
        if page:
            lines.append(f"page: {page}")
    if lines:
        report.sections.append(("rtmsim", "\n".join([*lines, f"repeat the test: pytest '{item.nodeid}'"])))


def _page_of(result):
    """The run as one page, beside its recording; None where it cannot be made."""
    import subprocess
    from rtmsim._server import program
    page = os.path.splitext(result.recording)[0] + ".html"
    try:
        done = subprocess.run([program("rtse"), "recording", "export", result.recording, "--html", page], capture_output=True, timeout=120)
    except Exception:
        return None
    return page if done.returncode == 0 and os.path.exists(page) else None
