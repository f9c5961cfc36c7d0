# The pytest plug-in of rtmsim: its fixtures, marks and reports, each in a pytest of its own.
import os
import subprocess
import sys

import pytest
from conftest import course, source

system = str(source / "worlds" / "systems" / "obstacle_avoidance.xml")
modules = f"[\"--module-path\", {os.environ['RTMSIM_LIB_DIR']!r}]"


@pytest.fixture
def run(tmp_path):
    def run_pytest(text, *options):
        (tmp_path / "test_it.py").write_text("import pytest\n" + text)
        return subprocess.run([sys.executable, "-B", "-m", "pytest", "-p", "no:cacheprovider", "--strict-markers", "--basetemp", tmp_path / "tmp",
                               *options, tmp_path], capture_output=True, text=True, timeout=300, cwd=tmp_path)
    return run_pytest


def test_a_test_gets_the_world_of_its_mark_once_per_seed(run):
    done = run(f"""
@pytest.mark.rtmsim({course!r}, seeds=[4, 5])
def test_it(world):
    world.step(10)
    assert world.seed in (4, 5) and world.time > 0
@pytest.mark.rtmsim({course!r}, seed=8)
def test_other(rtmsim_world):
    assert rtmsim_world.seed == 8
""", "-v")
    assert done.returncode == 0, done.stdout
    assert "test_it[seed4]" in done.stdout and "test_it[seed5]" in done.stdout and "3 passed" in done.stdout


def test_a_failing_test_reports_seed_time_and_hash(run):
    done = run(f"""
@pytest.mark.rtmsim({course!r}, seed=6)
def test_it(world):
    world.step(10)
    assert False
""")
    assert done.returncode == 1
    assert "seed 6, time 0.010 s, state hash" in done.stdout
    assert "repeat the test: pytest" in done.stdout


def test_a_world_without_a_mark_is_one_line(run):
    done = run("def test_it(world):\n    pass\n")
    assert "needs a mark" in done.stdout and "Traceback" not in done.stdout


def test_a_failing_run_of_a_system_leaves_recording_page_and_command(run, tmp_path):
    done = run(f"""
@pytest.mark.rtmsim({course!r}, seed=3)
def test_it(system):
    result = system({system!r}, duration=1, options={modules})
    assert result, result.logs
    system({system!r}, duration=1, options={modules}, expect=[{{"path_length": {{"model": "pioneer2dx", "min": 100}}}}]).check()
""")
    assert done.returncode == 1, done.stdout
    assert "repeat: rtse run" in done.stdout and "--seed 3" in done.stdout
    recording = done.stdout.split("recording: ")[-1].split()[0]
    assert os.path.exists(recording), done.stdout
    if os.access(os.path.join(os.environ["RTMSIM_BIN_DIR"], "rtse-page"), os.X_OK):
        assert os.path.exists(done.stdout.split("page: ")[-1].split()[0]), done.stdout


def test_the_plug_in_loads_nothing_before_a_fixture_is_used(run):
    done = run("import sys\ndef test_it():\n    assert 'rtmsim' not in sys.modules and 'numpy' not in sys.modules\n")
    assert done.returncode == 0, done.stdout


def test_fixtures_of_a_user_hide_the_short_names(run):
    done = run("@pytest.fixture\ndef world():\n    return 5\ndef test_it(world):\n    assert world == 5\n")
    assert done.returncode == 0, done.stdout
