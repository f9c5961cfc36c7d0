# The command blocks of README and docs are executed, page by page, in order, as written (see `instead`): docs_commands.py SOURCE_DIR BUILD_DIR [PAGE...]
# Without a page: only whether each page with blocks is in the tables below, and each of those is a test (tests/pages.cmake).
# Each page has a folder that looks like the project's, a simulator number and a naming service of its own. Programs that run until they are ended go on in the
# background, as in "a terminal of its own". Indented lines behind a block are what its last program shows: they are looked for in its output.
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
    "docs/third-party-components.md": "",
    "docs/recordings.md": avoidance,
    "docs/hash-logs.md": "",
    "docs/arms.md": "",
    "docs/jara.md": "",
    "docs/pictures.md": "sim-server worlds/farm.sdf --rtf 5",
    "docs/run-page.md": "",
    "docs/simulator.md": "",
    "docs/worlds.md": "mkdir -p models; cp worlds/obstacle_course.sdf my.world",
    "docs/campaigns.md": "",
    "docs/fleets.md": "",
    "docs/player.md": "",
    "docs/security.md": "",
    "docs/studio.md": "",
}
# Pages that a test of their own executes.
elsewhere = {
    "docs/tutorial-arm.md": "package.tutorial_arm",
    "docs/tutorial-component.md": "package.tutorial",
    "docs/develop/new-component.md": "docs.new-component",
    "docs/develop/new-data-type.md": "docs.new-data-type",
    "docs/develop/new-device.md": "docs.new-device",
    "docs/develop/new-rtse-command.md": "docs.new-rtse-command",
}
# (page, beginning of a line): why that line is not executed.
left_out = {
    ("README.md", "scripts/demo"): "it builds; package.demo runs what it runs then",
    ("README.md", "scripts/test"): "it builds, and runs this test",
    ("docs/ros2.md", ""): "uses the DDS domain that programs of this machine may be in: ros2.* run the same programs in domains of their own",
    ("docs/packages.md", ""): "installs packages: package.installed does so, in a root of its own",
}
# What is to be done before a line, where the text around the block asks for it.
before = {("docs/recordings.md", "rtse recording compare"): "cp run.mcap other.mcap",
          ("docs/player.md", "build/release/bin/sim-server worlds/leader_follower.sdf"): "finish; children=()"}
# Exit codes that are what the page says.
ends_with = {("docs/hash-logs.md", "rtse diff"): 1, ("docs/campaigns.md", "rtse hunt"): 1}  # the second case is a find
# What takes too long for a test, or a port or address that is not the test's: a pattern, and what is executed instead. PORT is one of two free ports in a row.
instead = {
    "docs/recordings.md": [("-t 60", "-t 3")],
    "docs/campaigns.md": [("--budget 2m", "--cases 2")],
    "docs/player.md": [("bin/player-gateway$", r"\g<0> --port PORT"), ("port 6665", "port PORT"), ("port 6666", "port PORT+1")],
    "docs/security.md": [("giop:ssl::2810", "giop:ssl:127.0.0.1:PORT"), (r"endpoints::(?= )", "endpoints:127.0.0.1:"), ("localhost:2810", "127.0.0.1:PORT")],
}
in_background = ("sim-server", "rtcd", "player-gateway", "follow", "rtm-studio", "omniNames")
# What is waited for behind a program in the background: words of its output, or a command that succeeds.
shows = {"player-gateway": "^port ", "rtm-studio": "http://127.0.0.1:", "follow": ""}
answers = {("docs/security.md", "LD_PRELOAD"): "bash -c '</dev/tcp/127.0.0.1/PORT'", ("docs/security.md", "rtcd"): "env RTMSIM_TLS_CERTIFICATE=host.pem RTMSIM_TLS_AUTHORITY=ca.pem bash -c 'build/release/bin/rtse --ns ssliop:127.0.0.1:PORT ls | grep -q host_cxt'"}
limit = 240


# (commands, lines that they show) of each block.
def blocks(page):
    found = []
    for words, text, shown in re.findall(r"^```([^\n]*)\n(.*?)^```$(?:\n\n[^\n`|]+:\n\n((?:    [^\n]+\n)+))?", (source / page).read_text(), re.M | re.S):
        first = text.split(maxsplit=1)[0] if text.split() else ""
        is_command = words in ("sh", "bash") or words == "" and re.fullmatch(r"(\S*/)?(simctl|rtse|rtcd|sim-server|rtm-studio|scripts/\w+|cmake|apt|apt-get|ctest)", first)
        if is_command:
            found.append((text.replace("\\\n", " "), [line.strip() for line in shown.splitlines()]))
    return found


def rule_of(table, page, line):
    return next((value for (name, start), value in table.items() if name == page and line.startswith(start)), None)


def two_free_ports():
    for port in range(12000 + os.getpid() * 2 % 8000, 32000, 2):
        try:
            with socket.socket() as one, socket.socket() as other:
                one.bind(("127.0.0.1", port))
                other.bind(("127.0.0.1", port + 1))
                return port
        except OSError:
            continue
    sys.exit("no two ports in a row are free")


# The page as a script of bash.
def script_of(page):
    port = two_free_ports()

    def own(text):
        for pattern, words in instead.get(page, []):
            assert re.search(pattern, (source / page).read_text(), re.M), f"{page}: there is no {pattern!r} any more"
            text = re.sub(pattern, words, text, flags=re.M)
        return text.replace("PORT+1", str(port + 1)).replace("PORT", str(port))

    out = ["set -uo pipefail", 'tell() { echo "line: $*" >&2; }', "children=()",
           "finish() { for ((i = ${#children[@]} - 1; i >= 0; --i)); do kill ${children[$i]} 2>/dev/null; wait ${children[$i]} 2>/dev/null; done; }", "trap finish EXIT",
           'await() { for _ in $(seq 300); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done; echo "$* is never so" >&2; cat ./*.log >&2; exit 1; }']
    lines = [(line, []) for line in executed[page].splitlines()]
    for block, shown in blocks(page):
        lines += [(line, []) for line in own(block).splitlines()]
        if shown:
            lines[-1] = (lines[-1][0], [own(line) for line in shown])
    for number, (line, shown) in enumerate(lines):
        line, _, comment = line.partition("  # ") if "  # " in line else (line, "", "")
        line = line.strip().removesuffix("&").strip()
        if not line or line.startswith("#") or rule_of(left_out, page, line) is not None:
            continue
        program = os.path.basename(next(word for word in line.split() if not re.match(r"[A-Z_]+=", word)))
        log = "command.log"
        out.append(f"tell {shlex.quote(line)}")
        if prepared := rule_of(before, page, line):
            out.append(prepared)
        if "Ctrl-C" in comment:
            out.append(f"timeout --signal INT --kill-after 30 3 {line} >command.log 2>&1; code=$?; [ $code = 124 ] || [ $code = 130 ] || [ $code = 0 ] || "
                       f"{{ cat command.log >&2; echo \"exit code $code\" >&2; exit 1; }}")
        elif program in in_background and not ends_by_itself(line):
            log = f"{program}{number}.log"
            out.append(f"{line} >{log} 2>&1 & children+=($!)")
            if answer := rule_of(answers, page, line):
                out.append(f"await {own(answer)}")
            elif program in shows:
                out.append(f"await grep -q {shlex.quote(shows[program])} {log}")
            elif program == "sim-server":
                out.append("await build/release/bin/simctl stats")
            elif program == "rtcd":
                names = " ".join(f"{word}0" for word in line.split() if re.fullmatch(r"[A-Z]\w+", word))
                out.append(f"await build/release/bin/rtse wait {names} --state any --timeout 1" if names else "await build/release/bin/rtse ls")
            out.append(f"kill -0 ${{children[-1]}} || {{ cat {log} >&2; exit 1; }}")
        elif line.startswith(("export ", "cd ")):
            out.append(line)
        else:
            wanted = rule_of(ends_with, page, line) or 0
            out.append(f"{{ {line}; }} >command.log 2>&1; code=$?; [ $code = {wanted} ] || {{ cat command.log >&2; echo \"exit code $code\" >&2; exit 1; }}")
        out += [f"await grep -qxF -- {shlex.quote(words)} {log}" for words in shown]
    return "\n".join(out) + "\n"


def ends_by_itself(line):
    return re.search(r" --(check|duration)\b", line) is not None


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


# Whatever needs the number of the simulator that this page has gets it from RTMSIM_SERVER_ID; saved systems name none.
def prepare(folder, number):
    shutil.copytree(source / "worlds", folder / "worlds")
    (folder / "build").mkdir()
    (folder / "build/release").symlink_to(build)
    (folder / "tests").symlink_to(source / "tests")
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
    for path in [source / "README.md", source / "CONTRIBUTING.md", *sorted((source / "docs").glob("**/*.md"))]:
        page = str(path.relative_to(source))
        if blocks(page) and page not in executed and page not in elsewhere and rule_of(left_out, page, "") is None:
            yield page


if pages := sys.argv[3:]:
    for page in pages:
        execute(page)
else:
    tests = (source / "tests/pages.cmake").read_text()
    problems = [f"{page}: command blocks that nothing executes: name the page in tests/scenario/docs_commands.py, or say why not" for page in unknown_pages()]
    problems += [f"tests/pages.cmake does not name {page}" for page in executed if not re.search(rf"[ (]{re.escape(page)}[ )\n]", tests)]
    if problems:
        sys.exit("\n".join(problems))
