"""A simulator process of this program. It ends with close(), with this process however that ends, and never by Ctrl-C."""
from __future__ import annotations

import os
import time

from ._core import Error, ServerDied, Simulator, TimedOut, path, shown

lowest_id, highest_id = 5000, 9999  # those below are for people and their scripts
_next = [os.getpid() * 7]
_pipes: set[int] = set()  # write ends; a forked child must not keep them open


def _forget_pipes() -> None:
    for pipe in list(_pipes):
        try:
            os.close(pipe)
        except OSError:
            pass
    _pipes.clear()


os.register_at_fork(after_in_child=_forget_pipes)


def program(name: str) -> str:
    """A program of rtm-sim: in the folder RTMSIM_BIN_DIR, else beside this module, else one of PATH."""
    import shutil
    folder = os.environ.get("RTMSIM_BIN_DIR")
    if folder:
        return os.path.join(folder, name)
    here = os.path.dirname(os.path.abspath(__file__))
    for up in ("../../bin", "../../../../bin"):  # of a build tree, of an installation
        beside = os.path.normpath(os.path.join(here, up, name))
        if os.access(beside, os.X_OK):
            return beside
    found = shutil.which(name)
    if found is None:
        raise Error(f"program {name} not found; expected it in PATH, or its folder in RTMSIM_BIN_DIR")
    return found


def listed(what: str, given) -> list:
    """A list of what was given, unless that is a text or no list."""
    if not isinstance(given, (str, bytes)):
        try:
            return list(given)
        except TypeError:
            pass
    raise Error(f"{what}: expected a list, got {shown(given)}")


def files(what: str, given) -> list[str]:
    """Of one file, or of a list of them."""
    many = [given] if isinstance(given, (str, bytes, os.PathLike)) else listed(what, given)
    return [path(what, one) for one in many]


def words(what: str, given) -> list[str]:
    """Words of a command line."""
    return [str(one) for one in listed(what, given)]


class OwnServer:
    """Starts a simulator and waits until it answers, at most `timeout` seconds of real time."""

    def __init__(self, world: str, seed: int, resource_path, options, timeout: float):
        import subprocess
        import tempfile
        self._folder = tempfile.TemporaryDirectory(prefix="rtmsim-")
        self._owner = os.getpid()
        self._process = None
        self._pipe = -1
        self._log = os.path.join(self._folder.name, "sim-server.log")
        if "<" in world:
            file = os.path.join(self._folder.name, "world.sdf")
            with open(file, "w", encoding="utf-8") as out:
                out.write(world)
            world = file
        line = ["--paused", "--rtf", "0", "--seed", str(seed), "--ends-with-input"]
        for folder in resource_path:
            line += ["--resource-path", folder]
        line += options
        deadline = time.monotonic() + timeout
        try:
            for _ in range(50):
                self.server_id = lowest_id + _next[0] % (highest_id - lowest_id + 1)
                _next[0] += 1
                if os.path.exists(f"/dev/shm/rtmsim-{os.getuid()}-{self.server_id}.simulation.world"):
                    continue
                if self._start(subprocess, world, line, deadline, timeout):
                    return
            raise Error("no simulator ID is free")
        except BaseException:
            self.close()
            raise

    def _start(self, subprocess, world, words, deadline, timeout) -> bool:
        read_end, self._pipe = os.pipe()
        _pipes.add(self._pipe)
        try:
            with open(self._log, "wb") as log:
                # A session of its own: Ctrl-C in a terminal is for this program alone.
                self._process = subprocess.Popen([program("sim-server"), world, "--server-id", str(self.server_id), *words],
                                                 stdin=read_end, stdout=log, stderr=log, start_new_session=True)
        finally:
            os.close(read_end)
        while True:
            if self._process.poll() is not None:
                if "is already running" in self.last_line() or "in use" in self.last_line():
                    self._end()
                    return False  # another program was faster
                raise Error(self.how_it_ended())
            try:
                self.simulator = Simulator(self.server_id)
                if self.simulator.pid == self._process.pid:
                    self.simulator.on_death(self.how_it_ended)
                    return True
                self.simulator.close()
            except Error:
                pass  # not yet, or it ended
            if time.monotonic() > deadline:
                raise TimedOut(f"sim-server did not answer within {timeout:g} s: {self.last_line()}")
            time.sleep(0.002)

    def last_line(self) -> str:
        try:
            with open(self._log, encoding="utf-8", errors="replace") as log:
                lines = [line.strip() for line in log if line.strip()]
        except OSError:
            lines = []
        return lines[-1] if lines else "it printed nothing"

    def how_it_ended(self) -> str:
        """One line; waits shortly for the exit code."""
        try:
            code = self._process.wait(1)
        except Exception:  # it still runs, or belongs to a parent process
            return f"simulator {self.server_id} no longer answers"
        if code < 0:
            import signal
            return f"simulator {self.server_id} was killed by signal {-code} ({signal.strsignal(-code)})"
        return f"simulator {self.server_id} ended with exit code {code}: {self.last_line()}"

    def _end(self) -> None:
        if self._pipe >= 0 and self._pipe in _pipes:
            _pipes.discard(self._pipe)
            os.close(self._pipe)
        self._pipe = -1
        process, self._process = self._process, None
        if process is None:
            return
        import subprocess
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            self._remove_segments()

    def _remove_segments(self) -> None:
        prefix = f"rtmsim-{os.getuid()}-{self.server_id}."
        for name in os.listdir("/dev/shm"):
            if name.startswith(prefix):
                try:
                    os.remove(os.path.join("/dev/shm", name))
                except OSError:
                    pass

    def close(self) -> None:
        """Ends the simulator and waits for it. In a forked child: nothing."""
        if os.getpid() != self._owner:
            self._folder._finalizer.detach()
            return
        killed = self._process is not None and (self._process.poll() or 0) < 0
        self._end()
        if killed:
            self._remove_segments()
        self._folder.cleanup()
