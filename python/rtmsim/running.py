"""run(): a whole system of components in a simulated world, judged. It uses `rtse run`."""
from __future__ import annotations

import json
import os
import shlex
from dataclasses import dataclass, field

from . import _core
from ._core import Error, TimedOut, path
from ._server import listed, program, words as words_of


@dataclass(frozen=True)
class Verdict:
    """Result of one expectation. `problem` is empty if it was met."""

    expectation: str
    problem: str = ""
    details: str = ""

    @property
    def passed(self) -> bool:
        return not self.problem


@dataclass(frozen=True)
class Result:
    """What one run has shown. True in a condition if it passed."""

    seed: int
    passed: bool
    problem: str  # why the run could not be made or ended early; empty: it was made
    verdicts: list[Verdict]
    state_hash: str  # of the world at the end
    run_hash: str  # of the hash log; empty without one
    simulated: float  # [s]
    wall: float  # real time [s]
    path: float  # of the model that went farthest [m]
    notes: list[str] = field(default_factory=list)
    logs: str = ""  # last lines of all processes, if there was a problem
    recording: str = ""  # file; empty without one
    command: str = ""  # repeats this run in a shell

    def __bool__(self) -> bool:
        return self.passed

    @property
    def why(self) -> str:
        """The first problem in one line; empty: passed."""
        if self.problem:
            return self.problem
        return next((f"{v.expectation}: {v.problem}" for v in self.verdicts if v.problem), "")

    def check(self) -> Result:
        """Raises AssertionError with the problem and the command that repeats the run, unless it passed."""
        if not self.passed:
            raise AssertionError(f"{self.why}\n{self.logs}\nrepeat: {self.command}".replace("\n\n", "\n"))
        return self


def run(system, world, *, expect=None, seeds=None, seed: int = 1, duration: float = 60.0, record=None, jobs: int = 1,
        options=(), timeout: float | None = None):
    """Runs a saved system (RTSProfile) in a world in lock step and returns a Result, or with `seeds` a list of them.

    `expect`: file of expectations (YAML), its text, or a list of dicts: [{"path_length": {"model": "robot", "min": 5}}].
    `seeds`: whole numbers, each a run; `jobs` of them at a time. `duration`: simulated seconds. `record`: file (MCAP) for all ports, logs
    and the world; with seeds NAME.SEED.mcap. `options`: more words for rtse run. `timeout`: real seconds for each run; None: 60 and ten times the duration. A run that fails is no error: see
    Result.passed. Error: a file cannot be read, or the options do not fit. Ctrl-C ends the run and everything that it started.
    """
    import tempfile
    with tempfile.TemporaryDirectory(prefix="rtmsim-") as folder:
        duration = _core.seconds("duration", duration)
        words = [program("rtse"), "run", path("system", system), "-w", path("world", world), "-d", f"{duration:.17g}",
                 *words_of("options", options)]
        if expect is not None:
            words += ["-x", _expectations(expect, folder)]
        limit = _core.seconds("timeout", timeout) if timeout is not None else 60.0 + 10.0 * duration
        record = path("record", record) if record else ""
        if seeds is None:
            return _run_one(words, _core.seed(seed), record, limit)
        return _run_many(words, [_core.seed(one) for one in listed("seeds", seeds)], record, limit, _core.whole("jobs", jobs, 1))


def _expectations(expect, folder: str) -> str:
    if isinstance(expect, (bytes, os.PathLike)) or (isinstance(expect, str) and "\n" not in expect and not expect.lstrip().startswith("-")):
        return path("expect", expect)
    if not isinstance(expect, str):
        try:
            expect = json.dumps(listed("expect", expect))  # JSON is YAML
        except (TypeError, ValueError) as problem:
            raise Error(f"expect: expected a file, a text or a list of dicts: {problem}") from None
    file = os.path.join(folder, "expect.yaml")
    with open(file, "w", encoding="utf-8") as out:
        out.write(expect)
    return file


def _run_many(words, seeds, record, limit, jobs):
    from concurrent.futures import ThreadPoolExecutor
    stem, ending = os.path.splitext(record)
    with ThreadPoolExecutor(jobs) as pool:
        started = [pool.submit(_run_one, words, seed, f"{stem}.{seed}{ending or '.mcap'}" if record else "", limit) for seed in seeds]
        try:
            return [one.result() for one in started]
        except BaseException:
            for one in started:
                one.cancel()
            raise


def _run_one(words, seed: int, record: str, limit: float) -> Result:
    import subprocess
    words = [*words, "--seed", str(seed), *(["--record", record] if record else [])]
    # A session of its own, and an end of its own: rtse ends what it has started when it is told to end.
    process = subprocess.Popen([words[0], "--json", *words[1:]], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, errors="replace", start_new_session=True)
    try:
        out, err = process.communicate(timeout=limit)
    except BaseException as problem:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if isinstance(problem, subprocess.TimeoutExpired):
            raise TimedOut(f"rtse run did not end within {limit:g} s") from None
        raise
    last = next((line.strip() for line in reversed(err.splitlines()) if line.strip()), "it printed nothing")
    if process.returncode == 2:
        raise Error(last)
    try:
        values = json.loads(out)
    except ValueError:
        raise Error(f"rtse run ended with exit code {process.returncode}: {last}") from None
    if isinstance(values, list):
        values = values[0]
    if values.get("refused"):
        raise Error(values.get("problem") or last)
    return Result(seed=values["seed"], passed=values["passed"], problem=values["problem"],
                  verdicts=[Verdict(v["expectation"], v["problem"], v["details"]) for v in values["expectations"]],
                  state_hash=values["state_hash"], run_hash=values["run_hash"], simulated=values["simulated"], wall=values["wall"],
                  path=values["path"], notes=values["notes"], logs=values["logs"], recording=record,
                  command=shlex.join(["rtse", *words[1:]]))
