# The command blocks of README and docs are executed, page by page, in order, as written (see `shorter`): docs_commands.py SOURCE_DIR BUILD_DIR [PAGE...]
# --known instead of a page: only whether each page with blocks is in the tables below.
# Each page has a folder that looks like the project's, a simulator number and a naming service of its own. Programs that run until they are ended go on in the
# background, as in "a terminal of its own".
import os
import pathlib
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

import server_ids

source, build = (pathlib.Path(word).resolve() for word in sys.argv[1:3])

avoidance = """sim-server worlds/obstacle_course.sdf --rtf 10
rtcd --with-naming -o manager.modules.load_path:build/release/lib RTCLaser RTCPosition2d LaserObstacleAvoid
rtse load worlds/systems/obstacle_avoidance.xml
rtse start worlds/systems/obstacle_avoidance.xml"""
# Pages that are executed here, with what is there already when the reader begins.
executed = {
    "README.md": "",
    "docs/tutorial-first-system.md": "",
    "docs/testing-a-robot-system.md": "",
    "docs/recordings.md": avoidance,
    "docs/hash-logs.md": "",
    "docs/pictures.md": "sim-server worlds/farm.sdf --rtf 5",
}
# The same, but they take minutes: only when they are named.
slow = {"docs/campaigns.md": ""}
# Pages that a test of their own executes.
elsewhere = {
    "docs/tutorial-component.md": "package.tutorial",
    "docs/new-component.md": "docs.new-component",
    "docs/new-data-type.md": "docs.new-data-type",
    "docs/new-device.md": "docs.new-device",
    "docs/new-rtse-command.md": "docs.new-rtse-command",
}
# (page, beginning of a line): why that line is not executed.
left_out = {
    ("README.md", "scripts/demo"): "it builds; package.demo runs what it runs then",
    ("README.md", "scripts/test"): "it builds, and runs this test",
    ("docs/studio.md", ""): "takes the port that a browser is told; the tests of the studio take ports of their own",
    ("docs/security.md", ""): "makes keys and runs until it is ended: the test tls does the same",
    ("docs/packages.md", ""): "installs packages: tests/package/installed does so, by hand",
    ("docs/player.md", ""): "takes the well-known ports of Player; follow.leader and player.drive do the same on ports of their own",
}
# What is to be done before a line, where the text around the block asks for it.
before = {("docs/recordings.md", "rtse recording compare"): "cp run.mcap other.mcap"}
# Exit codes that are what the page says.
ends_with = {("docs/hash-logs.md", "rtse diff"): 1}
# What would take too long for a test: the words, and what stands there instead.
shorter = {"docs/recordings.md": ("-t 60", "-t 3")}
in_background = ("sim-server", "rtcd", "player-gateway", "follow", "rtm-studio")
limit = 120


def blocks(page):
    found = []
    for words, text in re.findall(r"^```([^\n]*)\n(.*?)^```$", (source / page).read_text(), re.M | re.S):
        first = text.split(maxsplit=1)[0] if text.split() else ""
        is_command = words in ("sh", "bash") or words == "" and re.fullmatch(r"(\S*/)?(simctl|rtse|rtcd|sim-server|rtm-studio|scripts/\w+|cmake|apt|apt-get|ctest)", first)
        if is_command:
            found.append(text.replace("\\\n", " "))
    return found


def rule_of(table, page, line):
    return next((value for (name, start), value in table.items() if name == page and line.startswith(start)), None)


# The page as a script of bash.
def script_of(page):
    lines = {**executed, **slow}[page].splitlines()
    for block in blocks(page):
        lines += block.replace(*shorter.get(page, ("\0", ""))).splitlines()
    out = ["set -uo pipefail", 'tell() { echo "line: $*" >&2; }', "children=()",
           "finish() { for ((i = ${#children[@]} - 1; i >= 0; --i)); do kill ${children[$i]} 2>/dev/null; wait ${children[$i]} 2>/dev/null; done; }", "trap finish EXIT",
           'await() { for _ in $(seq 300); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done; echo "$* is never so" >&2; cat ./*.log >&2; exit 1; }']
    for line in lines:
        line, _, comment = line.partition("  # ") if "  # " in line else (line, "", "")
        line = line.strip().removesuffix("&").strip()
        if not line or line.startswith("#") or rule_of(left_out, page, line) is not None:
            continue
        program = os.path.basename(line.split()[0])
        out.append(f"tell {shlex.quote(line)}")
        if prepared := rule_of(before, page, line):
            out.append(prepared)
        if program in in_background:
            out.append(f"{line} >>{program}.log 2>&1 & children+=($!)")
            if program == "sim-server":
                out.append("await build/release/bin/simctl stats")
            if program == "rtcd":
                names = " ".join(f"{word}0" for word in line.split() if re.fullmatch(r"[A-Z]\w+", word))
                out.append(f"await build/release/bin/rtse wait {names} --state any --timeout 1" if names else "await build/release/bin/rtse ls")
        elif "Ctrl-C" in comment:
            out.append(f"timeout --signal INT --kill-after 30 3 {line} >command.log 2>&1; code=$?; [ $code = 124 ] || [ $code = 130 ] || [ $code = 0 ] || "
                       f"{{ cat command.log >&2; echo \"exit code $code\" >&2; exit 1; }}")
        elif line.startswith(("export ", "cd ")):
            out.append(line)
        else:
            wanted = rule_of(ends_with, page, line) or 0
            out.append(f"{line} >command.log 2>&1; code=$?; [ $code = {wanted} ] || {{ cat command.log >&2; echo \"exit code $code\" >&2; exit 1; }}")
    return "\n".join(out) + "\n"


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


# Whatever needs the number of the simulator that this page has gets it from RTMSIM_SERVER_ID; saved systems name none.
def prepare(folder, number):
    shutil.copytree(source / "worlds", folder / "worlds")
    (folder / "build").mkdir()
    (folder / "build/release").symlink_to(build)
    port = free_port()
    (folder / "rtc.conf").write_text(f"corba.nameservers: 127.0.0.1:{port}\nlogger.file_name: stderr\n")
    (folder / "tmp").mkdir()
    return {**os.environ, "RTMSIM_SERVER_ID": str(number), "RTC_MANAGER_CONFIG": str(folder / "rtc.conf"), "RTCTREE_NAMESERVERS": f"127.0.0.1:{port}",
            "TMPDIR": str(folder / "tmp"), "PATH": f"{build}/bin:{os.environ['PATH']}"}  # as the installed programs are


def execute(page):
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        environment = prepare(folder, server_ids.claim())
        (folder / "page.sh").write_text(script_of(page))
        child = subprocess.Popen(["bash", "page.sh"], cwd=folder, env=environment, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, start_new_session=True)
        try:
            told = child.communicate(timeout=limit)[1]
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGTERM)
            sys.exit(f"{page}: not at its end after {limit} s: {child.communicate()[1]}")
        if child.returncode != 0:
            sys.exit(f"{page}: {told}")
        print(f"{page}: {told.count('line: ')} commands")


def unknown_pages():
    for path in [source / "README.md", source / "CONTRIBUTING.md", *sorted((source / "docs").glob("*.md"))]:
        page = str(path.relative_to(source))
        if blocks(page) and page not in executed and page not in slow and page not in elsewhere and rule_of(left_out, page, "") is None:
            yield page


pages = sys.argv[3:]
if not pages or pages == ["--known"]:
    pages = [] if pages else list(executed)
    if unknown := list(unknown_pages()):
        sys.exit(f"command blocks that nothing executes, in {', '.join(unknown)}: name the page in tests/scenario/docs_commands.py, or say why not")
for page in pages:
    execute(page)
