# The page of a run that has a limit, or whose programs are ended: run_page.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import base64
import json
import os
import re
import signal
import stat
import struct
import subprocess
import sys
import tempfile
import time
import zlib

case, bin_dir, lib_dir, source = sys.argv[1:]
watchdog = 240  # [s]; a bound on hanging
mib = 1 << 20


def until(what, ready):
    end = time.monotonic() + watchdog
    while True:
        answer = ready()
        if answer:
            return answer
        assert time.monotonic() < end, what
        time.sleep(0.02)


def run_words(seconds, *more):
    return [f"{bin_dir}/rtse", "run", f"{source}/worlds/systems/obstacle_avoidance.xml", "--world", f"{source}/worlds/obstacle_course.sdf", "--duration", str(seconds), "--module-path", lib_dir, *more]


def done(*words, code=0):
    ended = subprocess.run(words, timeout=watchdog, capture_output=True, text=True, check=False)
    assert ended.returncode == code, (ended.returncode, ended.stdout, ended.stderr)
    return ended.stdout if code == 0 else ended.stderr


def blocks(page):
    with open(page, encoding="utf8") as file:
        return dict(re.findall(r'id="run-([^"]+)">([^<]*)</script>', file.read()))


def index_of(page):
    return json.loads(zlib.decompress(base64.b64decode(blocks(page)["index"])))


# Of the process: the child rtse-page, once it is that.
def writer_of(process):
    def find():
        assert process.poll() is None, "it ended before its page"
        with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as file:
            children = file.read().split()
        for child in children:
            try:
                with open(f"/proc/{child}/comm", encoding="utf8") as file:
                    if file.read().strip() == "rtse-page":
                        return int(child)
            except OSError:
                pass  # it has ended meanwhile
        return None

    return until("rtse-page", find)


# No page is larger than its limit: it ends early and says so. One that cannot be so small is not written.
def limit(folder):
    recording, page, viewer = (os.path.join(folder, name) for name in ("run.mcap", "run.html", "viewer.html"))
    done(*run_words(45, "--record", recording))
    done(f"{bin_dir}/rtse", "page", recording, "-o", page)
    assert os.path.getsize(page) > 1.3 * mib, os.path.getsize(page)
    text = done(f"{bin_dir}/rtse", "page", recording, "-o", page, "--page-limit", "1")
    size = os.path.getsize(page)
    assert 0.85 * mib < size <= mib, size
    index = index_of(page)
    end = index["hello"]["recording"]["to"]
    left_out = [line for line in index["hello"]["page"]["left_out"] if line.startswith("everything after")]
    assert left_out == [f"everything after {end:g} s: the page has reached its limit"], (left_out, end)
    assert left_out[0] in text, text
    assert 1 < end < 44 and abs(index["parts"][-1][1] - end) < 1e-6, (end, index["parts"])
    parts = sorted(int(name) for name in blocks(page) if name.isdigit())
    assert parts == list(range(len(index["parts"]))), parts
    # Parts that were written make room for the index.
    with open(viewer, "w", encoding="utf8") as file:
        file.write("<!--run-->" + " " * (mib - 60_000))
    done(f"{bin_dir}/rtse-page", recording, "-o", page, "--page-limit", "1", "--viewer", viewer)
    assert os.path.getsize(page) <= mib, os.path.getsize(page)
    # Nothing fits.
    with open(viewer, "a", encoding="utf8") as file:
        file.write(" " * 60_000)
    before = os.path.getsize(page)
    problem = done(f"{bin_dir}/rtse-page", recording, "-o", page, "--page-limit", "1", "--viewer", viewer, code=1)
    assert problem == "rtse-page: the page needs more than its limit of 1 MiB (--page-limit)\n", problem
    assert os.path.getsize(page) == before and sorted(os.listdir(folder)) == ["run.html", "run.mcap", "viewer.html"], os.listdir(folder)


# The page is written after the run if the program that wrote it beside the run was killed.
def writer_killed(folder):
    page = os.path.join(folder, "run.html")
    with subprocess.Popen(run_words(60, "--page", page), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        os.kill(writer_of(process), signal.SIGKILL)
        out, problems = process.communicate(timeout=watchdog)
    assert process.returncode == 0, (out, problems)
    assert index_of(page)["hello"]["page"]["passed"] is True
    assert os.listdir(folder) == ["run.html"], os.listdir(folder)


# A page that cannot be written costs nobody the recording, and the report does not attach what has its name.
def page_fails(folder):
    page, report = (os.path.join(folder, name) for name in ("run.html", "run.xml"))
    with subprocess.Popen(run_words(60, "--page", page, "--junit", report), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        writer_of(process)
        os.mkdir(page)
        problems = process.communicate(timeout=watchdog)[1]
    recording = f"{page}.{process.pid}.mcap"
    assert process.returncode == 1 and problems == f'rtse: page "{page}": is a folder; the recording is kept: {recording}\n', problems
    assert sorted(os.listdir(folder)) == ["run.html", os.path.basename(recording), "run.xml"], os.listdir(folder)
    with open(report, encoding="utf8") as file:
        assert "ATTACHMENT" not in file.read()
    os.rmdir(page)
    done(f"{bin_dir}/rtse", "page", recording, "-o", page)
    assert index_of(page)["parts"]


# Programs that are told to end leave no file.
def ended(folder):
    recording, page = (os.path.join(folder, name) for name in ("run.mcap", "run.html"))
    done(*run_words(100, "--record", recording))
    for number in (signal.SIGTERM, signal.SIGKILL, signal.SIGINT):
        with subprocess.Popen([f"{bin_dir}/rtse", "page", recording, "-o", page], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            writer = writer_of(process)
            process.send_signal(number)
            process.wait(watchdog)
        until("the end of rtse-page", lambda gone=writer: not os.path.exists(f"/proc/{gone}/exe"))
        assert os.listdir(folder) == ["run.mcap"], (number, os.listdir(folder))


# What a user did not name is in no message.
def messages(folder):
    page, bad = (os.path.join(folder, name) for name in ("run.html", "bad.mcap"))
    with open(bad, "w", encoding="utf8") as file:
        file.write("hello")
    rtse = f"{bin_dir}/rtse"
    nowhere = os.path.join(folder, "none/run.html")
    assert done(rtse, "page", bad, "-o", page, code=2) == f'rtse: "{bad}": is not an MCAP file: it does not start with the magic bytes\n'
    with open(bad, "wb") as file:
        file.write(b"\x89MCAP0\r\nhello")
    assert done(rtse, "page", bad, "-o", nowhere, code=1) == f'rtse: page "{nowhere}": No such file or directory\n'
    assert done(rtse, "page", bad, "-o", bad, code=1) == f'rtse: page "{bad}": is the recording; expected another file\n'
    assert done(*run_words(1, "--page", nowhere), code=2) == f'rtse: file "{nowhere}": there is no folder {os.path.dirname(nowhere)}\n'
    pipe, link = (os.path.join(folder, name) for name in ("pipe", "link"))
    os.mkfifo(pipe)
    os.symlink(pipe, link)
    for file in (pipe, link):
        assert done(rtse, "page", bad, "-o", file, code=1) == f'rtse: page "{file}": is no ordinary file\n'
    assert stat.S_ISFIFO(os.lstat(pipe).st_mode) and os.path.islink(link)
    os.remove(pipe), os.remove(link)
    for words in (["page", bad, "-o", ""], run_words(1, "--page", "")[1:], ["recording", "export", bad, "--html", ""], ["replay", bad, "--into", "A", "--compare", "--page", ""]):
        problem = done(rtse, *words, code=2)
        assert 'expected the name of a file or folder, got ""' in problem and problem.count("\n") == 1, problem
    problem = done(*run_words(1, "--page", "/proc/run.html"), code=2)
    assert problem == 'rtse: file "/proc/run.html": cannot be written: No such file or directory\n', problem
    viewer = done(f"{bin_dir}/rtse-page", bad, "-o", page, "--viewer", nowhere, code=1)
    assert viewer.startswith(f"rtse-page: the viewer is missing: {nowhere}; "), viewer
    assert sorted(os.listdir(folder)) == ["bad.mcap"], os.listdir(folder)


# Of a recording with a broken chunk the page, info, cat and compare have all the rest, and say what is missing.
def damaged(folder):
    recording, broken, page = (os.path.join(folder, name) for name in ("run.mcap", "broken.mcap", "run.html"))
    rtse = f"{bin_dir}/rtse"
    done(*run_words(10, "--record", recording))
    with open(recording, "rb") as file:
        octets = bytearray(file.read())
    at, chunks = 8, []
    while at + 9 <= len(octets) - 8:
        kind, size = struct.unpack_from("<BQ", octets, at)
        if kind == 6:
            chunks.append((at, size))
        at += 9 + size
    at, size = chunks[len(chunks) // 2]
    first, last = (time / 1e9 for time in struct.unpack_from("<QQ", octets, at + 9))
    assert 0 < first < last < 10, (first, last, len(chunks))
    octets[at + 9 + size // 2] ^= 0x55
    with open(broken, "wb") as file:
        file.write(octets)
    where = f'"{broken}": octet {at}: '
    times = f"from {first:g} to {last:g} s: "

    def said(*words):
        ended = subprocess.run((rtse, *words), timeout=watchdog, capture_output=True, text=True, check=False)
        assert ended.returncode == 1 and ended.stderr.count(where) == 1 and ended.stderr.count("\n") == 1, (words, ended)
        return ended.stdout, ended.stderr

    done(rtse, "page", broken, "-o", page)
    index = index_of(page)
    (line,) = (line for line in index["hello"]["page"]["left_out"] if "damaged" in line)
    assert line.startswith(f"what is damaged in the recording: {times}{where}"), line
    assert index["hello"]["recording"]["damage"] in line and abs(index["parts"][-1][1] - 10) < 0.1, (line, index["parts"])
    assert "channel" in said("recording", "info", broken)[0]
    ranges = [json.loads(one)["time"] for one in said("recording", "cat", broken, "RTCLaser0:range")[0].splitlines()]
    assert ranges[0] < first and ranges[-1] > last and not [time for time in ranges if first < time < last], ranges
    for pair in ((recording, broken), (broken, recording)):
        out, problem = said("recording", "compare", *pair)
        assert out.startswith("equal in what can be read: ") and problem.startswith(f"rtse: not compared {times}{where}"), (out, problem)


with tempfile.TemporaryDirectory() as place:
    {one.__name__: one for one in (damaged, limit, writer_killed, page_fails, ended, messages)}[case](place)
