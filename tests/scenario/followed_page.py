# The page of a run that is written while its recording grows: followed_page.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import json
import os
import re
import subprocess
import sys
import tempfile
import time

case, bin_dir, lib_dir, source = sys.argv[1:]
watchdog = 240  # [s]; a bound on hanging
head = 80       # [%] of the recording that is there while it is followed
system = f"{source}/worlds/systems/obstacle_avoidance.xml"
world = f"{source}/worlds/obstacle_course.sdf"


def until(what, ready):
    end = time.monotonic() + watchdog
    while not ready():
        assert time.monotonic() < end, what
        time.sleep(0.05)


def blocks(page):
    with open(page, encoding="utf8") as file:
        return dict(re.findall(r'id="run-([^"]+)">([^<]*)</script>', file.read()))


class Followed:
    """rtse-page at a recording of 100 s that grows: the first part is there, the rest comes with end()."""

    def __init__(self, folder):
        self.whole, self.growing, self.page = (os.path.join(folder, name) for name in ("whole.mcap", "growing.mcap", "run.html"))
        run = [f"{bin_dir}/rtse", "run", system, "--world", world, "--duration", "100", "--record", self.whole, "--module-path", lib_dir]
        subprocess.run(run, check=True, timeout=watchdog, stdout=subprocess.DEVNULL)
        with open(self.whole, "rb") as file:
            self.octets = file.read()
        self.grow(self.octets[: len(self.octets) * head // 100])
        with open(self.page, "w", encoding="utf8") as old:
            old.write("the page before")
        self.process = subprocess.Popen([f"{bin_dir}/rtse-page", self.growing, "-o", self.page, "--follow", "1"], stdin=subprocess.PIPE)

    def grow(self, octets):
        with open(self.growing, "ab") as file:
            file.write(octets)

    # [bytes] of the page that has no name yet, or that of a part.
    def written(self):
        folder = f"/proc/{self.process.pid}/fd"
        sizes = [0]
        for name in os.listdir(folder):
            try:
                target = os.readlink(f"{folder}/{name}")
                if os.path.dirname(self.page) in target and not target.endswith(".mcap"):
                    sizes.append(os.stat(f"{folder}/{name}").st_size)
            except OSError:
                pass  # closed meanwhile
        return max(sizes)

    def has_parts(self):
        assert self.process.poll() is None, "rtse-page has ended"
        return self.written() > 1_000_000  # more than the viewer and the world

    def left(self):
        folder = os.path.dirname(self.page)
        return sorted(set(os.listdir(folder)) - {"whole.mcap", "growing.mcap", "other.html"})

    def is_as_before(self):
        with open(self.page, encoding="utf8") as old:
            return self.left() == ["run.html"] and old.read() == "the page before"


# Each block is that of the page that is written afterwards, but for the result in the index.
def same(followed):
    until("parts of the page", followed.has_parts)
    assert followed.is_as_before(), followed.left()
    followed.grow(followed.octets[len(followed.octets) * head // 100:])
    followed.process.communicate(json.dumps({"passed": False, "why": ["so"], "seed": 3}).encode(), timeout=watchdog)
    assert followed.process.returncode == 0
    other = followed.page.replace("run.html", "other.html")
    subprocess.run([f"{bin_dir}/rtse-page", followed.whole, "-o", other], check=True, timeout=watchdog, stdout=subprocess.DEVNULL)
    mine, wanted = blocks(followed.page), blocks(other)
    assert mine.keys() == wanted.keys(), (mine.keys(), wanted.keys())
    different = [name for name in mine if mine[name] != wanted[name]]
    assert different == ["index"], different
    assert followed.left() == ["run.html"], followed.left()


# A run that ends without a result leaves the page before it.
def given_up(followed):
    until("parts of the page", followed.has_parts)
    followed.process.stdin.close()
    assert followed.process.wait(watchdog) == 1
    assert followed.is_as_before(), followed.left()


def killed(followed):
    until("parts of the page", followed.has_parts)
    followed.process.kill()
    followed.process.wait(watchdog)
    assert followed.is_as_before(), followed.left()


with tempfile.TemporaryDirectory() as place:
    it = Followed(place)
    try:
        {"same": same, "given_up": given_up, "killed": killed}[case](it)
    finally:
        if it.process.poll() is None:
            it.process.kill()
            it.process.wait()
