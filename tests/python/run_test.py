# rtmsim.run and rtmsim.Recording: a system of components, judged, and what it has recorded.
import os
import subprocess

import numpy
import pytest
import rtmsim
from conftest import course, source

system = str(source / "worlds" / "systems" / "obstacle_avoidance.xml")
modules = ["--module-path", os.environ["RTMSIM_LIB_DIR"]]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    file = tmp_path_factory.mktemp("run") / "run.mcap"
    result = rtmsim.run(system, course, duration=3, record=file, options=modules, expect=[{"path_length": {"model": "pioneer2dx", "min": 0.1}}])
    return file, result


def test_a_run_has_a_result_with_its_verdicts(recorded):
    file, result = recorded
    assert result.passed and result, result.why + result.logs
    assert result.check() is result
    assert result.simulated == pytest.approx(3)
    assert result.recording == str(file) and file.exists()
    assert len(result.verdicts) >= 1 and all(verdict.passed for verdict in result.verdicts)
    assert result.command.startswith("rtse run ") and "--seed 1" in result.command
    assert len(result.state_hash) == 16


def test_a_run_that_fails_says_why_and_how_to_repeat_it():
    result = rtmsim.run(system, course, duration=1, options=modules, expect=[{"path_length": {"model": "pioneer2dx", "min": 100}}])
    assert not result.passed and not result
    assert result.why
    with pytest.raises(AssertionError, match="repeat: rtse run"):
        result.check()


def test_seeds_make_a_run_each():
    results = rtmsim.run(system, course, duration=0.5, seeds=[3, 4], options=modules, jobs=2)
    assert [result.seed for result in results] == [3, 4]
    assert all(results)
    assert results[0].state_hash != results[1].state_hash


def test_files_that_do_not_exist_are_errors():
    with pytest.raises(rtmsim.Error, match="no_such.xml"):
        rtmsim.run("no_such.xml", course)
    with pytest.raises(rtmsim.Error, match="no_such"):
        rtmsim.Recording("no_such.mcap")


def test_samples_of_a_recording_are_arrays(recorded):
    file, _ = recorded
    with rtmsim.Recording(file) as recording:
        assert recording.damage == ""
        assert recording.end == pytest.approx(3, abs=0.2)
        assert "world.sdf" in recording.attachments and b"<sdf" in recording.attachment("world.sdf")
        assert recording.metadata["run"]["seed"] == "1"
        laser = next(name for name in recording.channels if name.startswith("/sim/laser/"))
        scans = recording.samples(laser)
        assert scans["ranges"].shape == (len(scans["time"]), 682) and scans["ranges"].dtype == numpy.float32
        assert (numpy.diff(scans["time"]) > 0).all()
        assert len(scans["time"]) == recording.channels[laser]
        part = recording.samples(laser, start=1, end=2)
        assert part["time"].min() >= 1 and part["time"].max() <= 2


def test_every_channel_of_a_recording_can_be_decoded(recorded):
    file, _ = recorded
    with rtmsim.Recording(file) as recording:
        for topic, count in recording.channels.items():
            if count:
                assert len(recording.samples(topic)["time"]) == count, topic


def test_samples_are_those_that_rtse_exports(recorded, tmp_path):
    import csv
    file, _ = recorded
    rtse = os.path.join(os.environ["RTMSIM_BIN_DIR"], "rtse")
    subprocess.run([rtse, "recording", "export", file, "-o", tmp_path], check=True, capture_output=True, timeout=120)
    with rtmsim.Recording(file) as recording:
        port = next(name for name in recording.channels if name.endswith("/velocity"))
        samples = recording.samples(port)
        with open(tmp_path / (port[1:].replace("/", ".") + ".csv"), encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        assert len(rows) == len(samples["time"])
        for place in samples:
            if place != "time" and place in rows[0]:
                assert numpy.allclose([float(row[place]) for row in rows], samples[place]), place


def test_channels_that_do_not_exist_are_named_with_those_that_do(recorded):
    file, _ = recorded
    with rtmsim.Recording(file) as recording:
        with pytest.raises(rtmsim.NotFound, match="/clock"):
            recording.samples("/clocks")


def test_two_iterators_of_a_recording_at_a_time_have_a_place_each(recorded):
    with rtmsim.Recording(recorded[0]) as recording:
        topic = "/sim/laser/pioneer2dx/laser"
        alone = [time for _, time, _ in recording.messages(topic)]
        assert len(alone) > 3
        assert [(one[1], other[1]) for one, other in zip(recording.messages(topic), recording.messages(topic))] == [(time, time) for time in alone]
        for _, time, _ in recording.messages(topic):
            assert next(recording.messages(topic))[1] == alone[0]
