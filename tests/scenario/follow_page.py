# Follows a page on how to add something (docs/develop/new-*.md) in a copy of the sources: follow_page.py MODE PAGE SOURCE_DIR BUILD_DIR
#   list   every step fits, the list of files is complete, and what they touch compiles
#   build  new-device alone: builds simulator and tests of the copy, runs both, and looks at the new device with simctl
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

mode, name_of_page, source, build = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
page = (source / f"docs/develop/{name_of_page}.md").read_text()


# (file, "after" | "before" | "instead of" | None, anchor, text) of each block that names a file.
def steps():
    for words, text in re.findall(r"^```\w+ ([^\n]*/[^\n]*)\n(.*?)^```$", page, re.M | re.S):
        found = re.fullmatch(r"(\S+)(?: (after|before|instead of) `(.*)`)?", words)
        assert found, f"a block says {words!r}"
        yield *found.groups(), text


def apply(root):
    touched = []
    for name, how, anchor, text in steps():
        file = root / name
        touched.append(name)
        if how is None:
            assert not file.exists(), f"{name} exists already"
            file.write_text(text)
            continue
        before = file.read_text()
        assert before.count(anchor) == 1, f"{name}: {anchor!r} stands there {before.count(anchor)} times, once is expected"
        at = before.index(anchor)
        if how == "instead of":
            after = before[:at] + text.rstrip("\n") + before[at + len(anchor):]
        else:
            line = before.index("\n", at) + 1 if how == "after" else before.rindex("\n", 0, at) + 1
            after = before[:line] + text + before[line:]
        file.write_text(after)
    listed = re.findall(r"^\| `([^`]+)` \|", page, re.M)
    assert sorted(set(touched)) == sorted(listed), f"the list of files and the steps differ: {sorted(set(touched) ^ set(listed))}"
    return listed


def copy_to(root):
    names = subprocess.run(["git", "-C", source, "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, names):
        if not (source / name).is_file():
            continue
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source / name, root / name)


# The sources of a command: several of a folder in a build from nothing.
def sources_of(command):
    file = pathlib.Path(command["file"])
    if not file.name.startswith("unity_"):
        return [file]
    return [file.parent / line.split('"')[1] for line in file.read_text().splitlines() if line.startswith("#include")]


# With the compiler's own command for it, or for a neighbour when it is new.
def compiles(root, name):
    commands = json.loads((build / "compile_commands.json").read_text())
    own = [one for one in commands if source / name in sources_of(one)]
    beside = own or [one for one in commands if (source / name).parent in [file.parent for file in sources_of(one)] and (name.split("/")[0] != "tests" or "/sim-server" in one["command"])]
    assert beside, f"{name}: nothing beside it is compiled"
    command = beside[0]["command"]
    for folder in ("base", "shm", "sim-server", "tests", "tools", "gateways", "clients", "iface-components", "rtm-core", "python"):
        command = command.replace(str(source / folder), str(root / folder))
    words = shlex.split(command)
    words = [f"-I{root}" if word == f"-I{source}" else word for word in words if "ccache" not in word]
    output = words.index("-o")
    words = words[:output] + words[output + 2:]
    words = [str(root / name) if word == beside[0]["file"] or word == str(root / pathlib.Path(beside[0]["file"]).relative_to(source)) else word for word in words]
    done = subprocess.run([*words, "-O0", "-fsyntax-only", "-Werror", "-Wno-invalid-pch"], cwd=beside[0]["directory"], capture_output=True, text=True)
    assert done.returncode == 0, f"{name}: {done.stderr}"


def write_page(root):
    subprocess.run([sys.executable, root / "docs/make_shared_memory.py"], check=True)
    made = (root / "docs/shared-memory.md").read_text()
    assert "| 35 | `RTMSIM_THERMOMETER` | `thermometer` | temperature of the air |" in made and "`temperature` [K]" in made


def follow_the_list():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        copy_to(root)
        listed = apply(root)
        sources = [name for name in listed if name.endswith(".cpp")]
        if name_of_page == "new-data-type":
            # The sources need stubs of the new type, which the copy has not: here the IDL alone has to be right.
            subprocess.run(["omniidl", "-bcxx", f"-C{folder}", f"-I{root / 'idl'}", root / "idl/ExtendedDataTypes.idl"], check=True)
            assert "struct TimedTemperature" in (root / "ExtendedDataTypes.hh").read_text()
            sources = []
        if name_of_page == "new-device":
            write_page(root)
            sources += ["shm/iface_json.cpp", "sim-server/devices/make_devices.cpp"]  # which read the table
        for name in sources:
            compiles(root, name)


def build_and_run():
    root = build / "new_device"
    shutil.rmtree(root / "source", ignore_errors=True)
    copy_to(root / "source")
    apply(root / "source")
    write_page(root / "source")
    subprocess.run(["cmake", "-S", root / "source", "-B", root / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", root / "build", "-j2", "--target", "sim-server", "simctl", "devices_test"], check=True)
    programs = root / "build/bin"
    subprocess.run([programs / "devices_test", "--gtest_filter=Device.*:Thermometer.*"], check=True)
    number = str(30000 + os.getpid() % 10000)
    server = subprocess.Popen([programs / "sim-server", root / "source/tests/worlds/every_device.sdf", "-u", "-s", number])

    def simctl(*words):
        return subprocess.run([programs / "simctl", "-s", number, "--json", *words], capture_output=True, text=True, timeout=60)

    try:
        end = time.monotonic() + 60
        while simctl("stats").returncode != 0:
            assert server.poll() is None and time.monotonic() < end
            time.sleep(0.05)
        shown = json.loads(simctl("echo", "rig::warmth", "-n", "1").stdout)
        assert abs(shown["temperature"] - 288.15) < 1, shown
        assert json.loads(simctl("info", "rig::warmth").stdout)["noise"] == 0.1
    finally:
        server.terminate()
        server.wait(20)


{"list": follow_the_list, "build": build_and_run}[mode]()
print("ok")
