# Recordings of the last seconds in pieces, one case per run: recorded_rings.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import re
import resource
import signal
import subprocess

from recording_rig import ended, file, lines, recording, refused, rig, run_case, seconds, up
from rig import await_


# A ring is for those who look for what went wrong: of a run that passes nothing is kept.
def of_a_run():
    kept = rig.path("ring.mcap")
    call = ["run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf", "-d", "4s", "--record", kept, "--last", "1s"]
    rig.rtse(*call)
    assert not [name for name in os.listdir(rig.work) if name.startswith("ring")], os.listdir(rig.work)
    failed = rig.try_rtse(*call, "-x", f"{rig.source}/tests/scenario/impossible.yaml", "--hash-log", rig.path("run.hashlog"))
    assert failed.returncode == 1, failed
    info = json.loads(rig.rtse("--json", "recording", "info", kept))
    scans = next(c for c in info["channels"] if c["topic"] == "/RTCLaser0/range")
    assert 9 <= scans["samples"] <= 12 and scans["first"] >= 2.8, scans
    assert next(c for c in info["channels"] if c["topic"] == "/tf_static")["samples"] == 1, info
    assert next(c for c in info["channels"] if c["topic"] == "/hashes")["first"] >= 2.8, info
    assert not [name for name in os.listdir(rig.work) if name.startswith("ring-")], os.listdir(rig.work)
    assert refused_without_record().returncode == 2


def pieces():
    return sorted(name for name in os.listdir(rig.work) if re.fullmatch(r"run-\d+\.mcap", name))


def scan_times(name):
    done = rig.try_rtse("recording", "cat", rig.path(name), "RTCLaser0:range")  # a piece that has no end is told
    return [round(json.loads(line)["time"], 3) for line in done.stdout.splitlines()]


# A ring whose recorder is killed has two pieces, each complete in itself, which are put together; what held before is in it.
def killed():
    up()
    process = recording("RTCLaser0:range", "--views", "--last", "2")
    for _ in range(5):
        seconds(1.1)
    await_("the last scan is in a piece", lambda: pieces() and 5.5 in scan_times(pieces()[-1]))
    process.kill()
    process.wait()
    names = pieces()
    assert len(names) == 2 and names[0] != "run-001.mcap", names
    for name in names:
        info = json.loads(rig.try_rtse("--json", "recording", "info", rig.path(name)).stdout)
        assert [a["name"] for a in info["attachments"]] == ["world.sdf"] and info["run"]["lockstep"] == "yes", info
        assert next(c for c in info["channels"] if c["topic"] == "/tf_static")["samples"] == 1, info
    refused("recording", "info", file, code=2, says=f'is not there, but "{rig.path(names[0])}" and "{rig.path(names[1])}" of its ring; rtse recording repair {file} puts')
    assert rig.rtse("recording", "repair", file).startswith(f"{len(lines('cat', file))} samples kept of ")
    times = scan_times("run.mcap")
    assert times == [round(t / 10, 1) for t in range(35, 56)], times
    info = json.loads(rig.rtse("--json", "recording", "info", file))
    held = {c["topic"]: c["samples"] for c in info["channels"]}
    assert held["/tf_static"] == held["/sim/shapes"] == 1 and 3.3 < info["first"] and [a["name"] for a in info["attachments"]] == ["world.sdf"], info
    assert pieces() == []


# The pieces of a ring that was killed do not become part of the next one.
def again():
    up()
    first = recording("RTCLaser0:range", "--last", "1")
    seconds(3)
    await_("pieces are there", lambda: len(pieces()) == 2)
    first.kill()
    first.wait()
    # One may have been created and have nothing in it yet.
    with open(rig.path("run-009.mcap"), "wb") as out:
        out.write(b"\x89MCAP0\r\n")
    open(rig.path("run-010.mcap"), "wb").close()
    second = recording("RTCLaser0:range", "--last", "1")
    assert "of an earlier ring that was not put together, replaced" in second.stderr.readline()
    seconds(0.5)
    for words in (["recording", "repair", file], ["record", "-o", file, "RTCLaser0:range", "--last", "1"]):
        refused(*words, says=f'"{rig.path("run-001.mcap")}": is a segment of a ring that is still being recorded')
    said = ended(second)
    assert f'in "{file}"' in said and pieces() == [], (said, pieces())
    times = scan_times("run.mcap")
    assert 3 <= min(times) and max(times) - min(times) <= 1 and f"recorded {len(times)} samples of 1 channels" in said, (times, said)
    assert rig.try_rtse("record", "-o", file, "RTCLaser0:range", "--last", "1", "--split", "1s").returncode == 2
    # What cannot be put together stays in its pieces.
    third = recording("RTCLaser0:range", "--last", "1")
    seconds(1.5)
    os.mkdir(file)
    third.send_signal(signal.SIGINT)
    err = third.communicate(timeout=60)[1]
    assert third.returncode == 1 and err.count("\n") == 1 and f'"{file}": cannot be written: Is a directory; earlier samples are in "' in err, err
    assert len(pieces()) == 2 and not os.path.exists(file + ".part"), pieces()
    os.rmdir(file)
    assert "samples kept of" in rig.rtse("recording", "repair", file) and len(scan_times("run.mcap")) in (10, 11)


# Files that only have names of pieces stay, and so do those of a ring that is being recorded.
def taken():
    up()
    own = rig.path("run-077.mcap")
    with open(own, "w") as out:
        out.write("somebody's own")
    refused("record", "-o", file, "RTCLaser0:range", "--last", "1", says=f'"{own}": is not a segment of a ring recording, but has a name that a segment of this one may take')
    os.remove(own)
    split = recording("RTCLaser0:range", "--split", "1s")
    seconds(2.5)
    ended(split)
    before = {name: open(rig.path(name), "rb").read() for name in pieces()}
    refused("record", "-o", file, "RTCLaser0:range", "--last", "1", says=f'"{rig.path("run-001.mcap")}": is not a segment of a ring')
    assert before == {name: open(rig.path(name), "rb").read() for name in pieces()} and len(before) >= 2, list(before)
    for name in before:
        os.remove(rig.path(name))
    ring = recording("RTCLaser0:range", "--last", "1")
    seconds(1.5)
    await_("two pieces are there", lambda: len(pieces()) == 2)
    live = f'"{rig.path("run-002.mcap")}": is a segment of a ring that is still being recorded'
    for words in ([file], [file, "--split", "10m"], [rig.path("run-001.mcap")], [rig.path("run-002.mcap")]):
        refused("record", "RTCLaser0:range", "-o", *words, says=live)
    said = ended(ring)
    assert f'in "{file}"' in said and pieces() == [] and len(scan_times("run.mcap")) in (10, 11), said
    plain = recording("RTCLaser0:range")
    seconds(0.5)
    for words in ([], ["--last", "1"]):
        refused("record", "-o", file, "RTCLaser0:range", *words, says=f'"{file}": is being written by another process')
    refused("recording", "repair", file, says=f'"{file}": is being written by another process')
    ended(plain)
    assert scan_times("run.mcap")


# Time that begins anew is another run: its last seconds count.
def reset():
    up()
    process = recording("RTCLaser0:range", "--views", "--last", "1")
    seconds(5)
    rig.simctl("reset")
    seconds(2.5)
    ended(process)
    times = scan_times("run.mcap")
    assert times and 1.4 <= min(times) and max(times) <= 2.5, times
    assert pieces() == [] and max(s["time"] for s in lines("cat", file)) <= 2.5


# A full disk: what is in the pieces stays, and is told as it is.
def full_disk():
    up()

    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (400000, 400000))
    process = recording("RTCLaser0:range", "--last", "1h", preexec_fn=small)
    for _ in range(100):
        if process.poll() is None:
            seconds(4)
    err = process.communicate(timeout=60)[1]
    piece = rig.path("run-001.mcap")
    assert process.returncode == 1 and err.count("\n") == 1, err
    assert f'"{piece}": cannot be written: File too large; earlier samples are in "{piece}", rtse recording repair {file} puts it together' in err, err
    kept = len(scan_times("run-001.mcap"))
    assert kept > 0 and rig.rtse("recording", "repair", file) == f'{kept} samples kept of "{piece}"\n', kept
    assert len(scan_times("run.mcap")) == kept


# A recorder that is killed in the middle of a run fails the run, which says where the pieces are.
def of_a_killed_recorder():
    call = [f"{rig.bin_dir}/rtse", "run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf",
            "-d", "2000", "--record", file, "--last", "1s"]
    run = subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    await_("pieces are there", lambda: len(pieces()) == 2)
    found = [int(pid) for pid in os.listdir("/proc") if pid.isdigit() and is_recorder(pid)]
    assert len(found) == 1, found
    os.kill(found[0], signal.SIGKILL)
    out, err = run.communicate(timeout=200)
    assert run.returncode == 1 and f"rtse recording repair {file} puts it together" in out + err, (out, err)
    assert 1 <= len(pieces()) <= 3, pieces()  # a segment may just have been started, or may be about to be removed
    done = rig.try_rtse("recording", "repair", file)  # 1: it was killed while it wrote, and the last samples are cut
    assert done.returncode in (0, 1) and "samples kept of" in done.stdout and scan_times("run.mcap"), done


def is_recorder(pid):
    try:
        with open(f"/proc/{pid}/cmdline", "rb") as text:
            words = text.read().split(b"\0")
    except OSError:
        return False  # it has ended
    return words[0].endswith(b"/rtse-recorder") and file.encode() in words


def refused_without_record():
    return rig.try_rtse("run", f"{rig.source}/worlds/systems/obstacle_avoidance.xml", "-w", f"{rig.source}/worlds/obstacle_course.sdf", "--last", "1")


run_case(globals())
