# Every program that packages install answers --help and --man, and the help says what to do; every other one of the build answers --help.
# help.py BUILD_DIR SOURCE_DIR
# Help lines of options and verbs begin with a verb or a noun, never with What, Who, So or Of.
# The verbs of rtse and simctl are in groups.
import os
import pathlib
import re
import subprocess
import sys
import tempfile

build, source = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
problems = []
# Interfaces of OpenRTM-aist, which has neither.
# Compiled unmodified from sources of others, which have a main() of their own; the last one only has to compile.
fixed_sources = {"FilterComp", "NumberInComp", "WatcherComp", "test_headers"}
without_manual = {"rtm-config", "rtm2-config"}


def run(*words):
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run([str(build / "bin" / words[0]), *words[1:]], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)


def installed():
    for file in sorted((source / "packaging").glob("*.install")):
        for line in file.read_text().splitlines():
            if match := re.match(r"usr/bin/(\S+)", line):
                pattern = match[1].removesuffix(".rtm-sim")
                found = [path.name for path in sorted((build / "bin").glob(pattern))]
                if not found:
                    print(f"{pattern}: not built, left out")
                yield from found


# (name of an option or verb, its description): what stands behind two blanks or more, with the lines that go on below it.
def lines_of(text):
    rows = []
    for line in text.splitlines():
        if match := re.match(r"  ?(?: {4})?(\S.*?)(?:  +(\S.*))?$", line):
            rows.append([match[1], match[2] or ""])
        elif rows and (match := re.match(r" {20,}(\S.*)$", line)):
            rows[-1][1] += " " + match[1]
    return [(name, re.sub(r"^(?:(?:[A-Z]+|\[[^]]*\]|\.\.\.|REQUIRED|x \d+|Excludes: \S+|Needs: \S+|\(Env:\S+\)) )*(?=[A-Z][a-z])", "", words.strip())) for name, words in rows]


def check_help(words, text):
    name = " ".join(words)
    for option, description in lines_of(text):
        if re.match(r"(what|who|so|of)\b", description, re.I):
            problems.append(f"{name} --help: {option}: begins with a word that says nothing: {description}")
    if re.search(r"^Subcommands:", text, re.M) and words in (["rtse"], ["simctl"]):
        problems.append(f"{name} --help: a verb is in no group")


# What --help prints; "" when there is a problem.
def check(words):
    done = run(*words, "--help")
    if "cannot be started; expected it beside rtse" in done.stderr:
        print(f"{' '.join(words)}: not built, left out")
        return ""
    if done.returncode != 0 or not re.search("usage", done.stdout, re.I):
        problems.append(f"{' '.join(words)} --help: exit code {done.returncode}: {(done.stdout + done.stderr)[:300]}")
        return ""
    check_help(words, done.stdout)
    return done.stdout


def check_manual(words):
    done = run(*words, "--man")
    if done.returncode != 0 or not done.stdout.startswith(".TH ") or ".SH NAME" not in done.stdout:
        problems.append(f"{' '.join(words)} --man: exit code {done.returncode}: {(done.stdout + done.stderr)[:300]}")


def verbs_of(program):
    return [line.split("\t")[0] for line in run(program, "--complete", "").stdout.splitlines() if re.match(r"[a-z][\w-]*\t", line)]


sample = "Options:\n  -h,--help                   Print this\n  -n,--count INT:INT in [1 - 5]\n                              So many\n"
assert lines_of(sample)[-1][1] == "So many", lines_of(sample)
programs = [name for name in dict.fromkeys(installed()) if name not in without_manual]
assert {"rtse", "simctl", "sim-server", "rtcd"} <= set(programs), programs
for program in programs:
    check([program])
    check_manual([program])
# What tests and benchmarks start is not installed, but somebody will try it by hand: it must not begin minutes of work, or wait for nothing.
others = [path.name for path in sorted((build / "bin").iterdir()) if path.is_file() and os.access(path, os.X_OK) and path.suffix != ".so"]
others = [name for name in others if name not in programs and name not in without_manual and name not in fixed_sources]
for program in others:
    try:
        done = run(program, "--help")
    except subprocess.TimeoutExpired:
        problems.append(f"{program} --help: does not end")
        continue
    if done.returncode != 0 or not re.search("usage|Google Test", done.stdout, re.I):
        problems.append(f"{program} --help: exit code {done.returncode}: {(done.stdout + done.stderr)[:300]}")
number = 0
for program in ("rtse", "simctl"):
    verbs = verbs_of(program)
    assert len(verbs) > 15, (program, verbs)
    for verb in verbs:
        number += 1
        check([program, verb])
check_manual(["rtse", "demo"])
for sub in ("info", "ls", "cat", "export", "compare", "repair"):
    check(["rtse", "recording", sub])
print("\n".join(problems) if problems else f"{len(programs)} programs, {number} verbs, {len(others)} programs of tests")
sys.exit(1 if problems else 0)
