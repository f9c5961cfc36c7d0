# Checks that scripts/setup installs the programs and Python modules that tests and scripts use.
#   called_programs.py called SOURCE_DIR BUILD_DIR           reads the sources and finds the package of each program that they call. The package must be one of scripts/setup, a
#                                                            dependency of one, or part of Debian's minimal system. Skipped (77) where apt has no package lists.
#   called_programs.py executed BUILD_DIR [CTEST-OPTION...]  runs the tests and lists the packages of all programs executed meanwhile that scripts/setup does not install.
#                                                            Exit code 1 if there is one; hooks of this machine's apt are listed, too. By hand, as root.
# `called` sees neither names that are made at run time nor programs that programs start, as gpg starts gpg-agent. `executed` sees both.
import ast
import collections
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

FOLDERS = ("/usr/sbin", "/usr/bin", "/sbin", "/bin", "/usr/local/sbin", "/usr/local/bin")
# Programs of other packages. Their callers work without them, or probe first and then are skipped or print what to install.
OPTIONAL = {
    "blhc": "scripts/package does without; tests/package/clean, by hand, says what to install",
    "debootstrap": "tests/package/bare and others by hand say what to install",
    "piuparts": "tests/package/clean, by hand, says what to install",
    "scancel": "Slurm: campaigns.slurm_* are skipped without (scripts/setup --with-slurm)",
    "stage": "tests/bench/fleet_bench, by hand, does without",
    "strace": "tests/bench/sim_bench, by hand, does without",
    "sudo": "scripts/setup says what root has to install",
    "valgrind": "tests/robustness, by hand with --valgrind",
}
# Modules of Python's standard library that Debian's python3 does not install.
SPLIT_OFF = {"distutils", "ensurepip", "idlelib", "lib2to3", "tkinter", "turtle", "venv"}
OTHER_MODULES = {"omniidl": "a back end of omniidl runs inside it", **dict.fromkeys(("Later", "OldShop", "OldShop__POA"), "tests/python/service_test.py makes them"), "gymnasium": "rtmsim uses it where it is installed, and has stand-ins"}
# Modules that packages of their own install.
PACKAGED_MODULES = {"numpy": "python3-numpy", "pytest": "python3-pytest"}
BUILTINS = set(""". : [ [[ alias bg break builtin cd command compgen complete compopt continue declare dirs disown echo enable eval exec exit export false fc fg getopts hash help
history jobs kill let local logout mapfile popd printf pushd pwd read readarray readonly return set shift shopt source suspend test times trap true type typeset ulimit umask unalias unset
wait""".split())
KEYWORDS = set("if then else elif fi do done while until ! { } time coproc in".split())
SHELLS = {"sh", "bash", "dash", "zsh"}
WRAPPERS = {"env", "exec", "nice", "sudo", "xargs", "timeout", "setsid", "command", "nohup", "stdbuf", "eatmydata"}


class Missing(Exception):
    pass


def output(*words):
    return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True, env={**os.environ, "LC_ALL": "C"}).stdout


# The packages of a machine after debootstrap --variant=minbase, apt install git and scripts/setup, without those that only Debian's Node.js needs: scripts/setup accepts another one.
def brought(source):
    system = pathlib.Path("/etc/os-release")
    if not system.exists() or "VERSION_CODENAME=bookworm" not in system.read_text():
        raise Missing("this is not Debian 12")
    listed = output(f"{source}/scripts/setup", "--list").split()
    try:
        stanzas = output("apt-cache", "dumpavail").split("\n\n")
    except (OSError, subprocess.CalledProcessError) as why:
        raise Missing(f"apt-cache: {why}") from why
    minimal = {re.search(r"^Package: (.*)$", stanza, re.M)[1] for stanza in stanzas if re.search(r"^(Essential: yes|Priority: required)$", stanza, re.M)}
    if len(minimal) < 20:
        raise Missing("apt has no package lists (apt-get update)")
    wanted = [package for package in listed if package not in ("nodejs", "npm")]
    with tempfile.NamedTemporaryFile() as nothing_installed:
        done = subprocess.run(["apt-get", "-s", "-o", f"Dir::State::status={nothing_installed.name}", "-o", "Debug::NoLocking=1", "--no-install-recommends", "install",
                               *sorted(minimal), "apt", "git", *wanted], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False, env={**os.environ, "LC_ALL": "C"})
    if done.returncode != 0:
        raise RuntimeError(f"apt-get -s install: {(done.stderr.strip() or done.stdout.strip()).splitlines()[0]}")
    return set(re.findall(r"^Inst (\S+)", done.stdout, re.M)) | set(listed)


# Debian merges /bin into /usr/bin; packages and links name both.
def without_usr(path):
    return path.removeprefix("/usr") if path.startswith(("/usr/bin/", "/usr/sbin/", "/usr/lib/", "/usr/lib64/")) else path


# The package of each installed file that lies in a folder of programs or libraries.
def owners():
    found = {}
    for file in pathlib.Path("/var/lib/dpkg/info").glob("*.list"):
        for path in file.read_text(errors="replace").splitlines():
            if path.startswith(("/usr/", "/bin/", "/sbin/", "/lib", "/opt/", "/etc/")):
                found.setdefault(without_usr(path), file.name[:-5].split(":")[0])
    return found


def installed(name):
    return next((f"{folder}/{name}" for folder in FOLDERS if os.access(f"{folder}/{name}", os.X_OK)), None)


# --- What the sources call ---


# The commands of a shell script: words in command position, without those that are made at run time.
def shell_commands(text):
    found, position, length = set(), 0, len(text)
    heredocs = []

    def closing(start, opening, closer):
        depth, at, quote = 0, start, ""
        while at < length:
            character = text[at]
            if quote:
                if character == "\\" and quote == '"':
                    at += 1
                elif character == quote:
                    quote = ""
            elif character in "'\"":
                quote = character
            elif character == "\\":
                at += 1
            elif character == opening:
                depth += 1
            elif character == closer:
                depth -= 1
                if depth == 0:
                    return at
            at += 1
        return length

    # One word from here, with a $ for each part that is made at run time; commands in such parts are looked at.
    def word():
        nonlocal position
        start, made = position, ""
        while position < length and text[position] not in " \t\n;&|()<>":
            character = text[position]
            if character == "\\":
                made += text[position + 1:position + 2].strip("\n")
                position += 2
            elif character == "'":
                end = text.find("'", position + 1)
                end = length if end < 0 else end
                made += text[position + 1:end]
                position = end + 1
            elif character == '"':
                position += 1
                while position < length and text[position] != '"':
                    if text[position] == "\\":
                        made += text[position + 1:position + 2]
                        position += 2
                    elif text[position] in "$`":
                        made += "$"
                        expansion()
                    else:
                        made += text[position]
                        position += 1
                position += 1
            elif character in "$`":
                made += "$"
                expansion()
            elif text.startswith("=(", position):  # an array
                position = closing(position + 1, "(", ")") + 1
                made += "="
            else:
                made += character
                position += 1
        if position == start:
            position += 1
        return made

    def expansion():
        nonlocal position
        if text.startswith("$((", position):
            position = closing(position + 1, "(", ")") + 1
        elif text.startswith("$(", position):
            end = closing(position + 1, "(", ")")
            found.update(shell_commands(text[position + 2:end]))
            position = end + 1
        elif text.startswith("${", position):
            position = closing(position + 1, "{", "}") + 1
        elif text[position] == "`":
            end = text.find("`", position + 1)
            end = length if end < 0 else end
            found.update(shell_commands(text[position + 1:end]))
            position = end + 1
        else:
            position = re.compile(r"\$(\w+|[@*#?$!-])?").match(text, position).end()

    is_command, cases, is_pattern, is_loop, is_shell, after_c = True, [], False, False, False, False
    while position < length:
        character = text[position]
        if character in " \t":
            position += 1
        elif text.startswith("\\\n", position):
            position += 2
        elif character == "#" and (position == 0 or text[position - 1] in " \t\n;(|&"):
            end = text.find("\n", position)
            position = length if end < 0 else end
        elif character == "\n":
            position += 1
            for mark in heredocs:
                ended = re.compile(rf"^\t*{re.escape(mark)}$", re.M).search(text, position)
                position = ended.end() if ended else length
            heredocs.clear()
            is_command, is_loop, is_shell, after_c = not is_pattern, False, False, False
        elif text.startswith(";;", position):
            position += 2
            is_command, is_pattern = False, bool(cases)
        elif text.startswith("((", position) and (is_command or is_loop):
            position = closing(position, "(", ")") + 1
        elif character in ";&|(":
            position += 1
            is_command, is_loop, is_shell, after_c = not is_pattern, False, False, False
        elif character == ")":
            position += 1
            is_command, is_pattern = True, False
        elif character in "<>":
            here = re.compile(r"<<-?\s*[\"']?(\w+)[\"']?").match(text, position)
            if here and not text.startswith("<<<", position):
                heredocs.append(here[1])
                position = here.end()
                continue
            if text.startswith(("<(", ">("), position):
                end = closing(position + 1, "(", ")")
                found.update(shell_commands(text[position + 2:end]))
                position = end + 1
                continue
            while position < length and text[position] in "<>&|":
                position += 1
            while position < length and text[position] in " \t":
                position += 1
            word()
        else:
            said = word()
            is_shell = is_shell or said in SHELLS
            if after_c:
                found.update(shell_commands(said))
                after_c = False
            if is_pattern:
                if said == "esac" and cases:
                    cases.pop()
                    is_pattern, is_command = False, False
            elif not is_command:
                if said == "in" and cases and cases[-1] == "head":
                    cases[-1] = "body"
                    is_pattern = True
                after_c = is_shell and re.fullmatch(r"-[a-z]*c", said) is not None
            elif said == "case":
                cases.append("head")
                is_command = False
            elif said == "esac":
                if cases:
                    cases.pop()
                is_command = False
            elif said in ("for", "select", "function"):
                is_command, is_loop = False, True
            elif said in KEYWORDS or re.match(r"\w+(\[[^]]*\])?\+?=", said):
                is_command = True
            elif said == "trap":
                is_command, after_c = False, True
            elif said in WRAPPERS:
                found.add(said)
                while (at := re.compile(r"[ \t]+(-[\w-]+(=\S*)?|\d+\w?|[A-Z]+|[A-Z_]+=\S*)(?=[ \t])").match(text, position)) is not None:
                    position = at.end()
            else:
                is_command = False
                if re.fullmatch(r"\w[\w.+-]*", said) and not re.compile(r"[ \t]*\(\)").match(text, position):
                    found.add(said)
    return {name for name in found if name not in BUILTINS | KEYWORDS and not name.isdigit()}


def shell_functions(text):
    return set(re.findall(r"(?:^|[;{&|])\s*(?:function\s+)?([\w-]+)\s*\(\)", text, re.M))


# The text of a string, with a mark for each part that is made at run time.
def text_of(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "$x" for part in node.values)
    return None


def modules(text):
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(node.module.split(".")[0])
    return found


RUNNERS = {"run", "Popen", "check_output", "check_call", "call", "getoutput", "system", "popen", "execvp", "execlp", "which", "start", "spawn"}


# The commands of a Python source: those that are certain, and words that look like one.
def python_commands(text):
    sure, likely = set(), set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.List, ast.Tuple)) and node.elts and (first := text_of(node.elts[0])):
            words = [text_of(element) for element in node.elts[1:]]
            if any(isinstance(element, (ast.Starred, ast.JoinedStr)) for element in node.elts[1:]) or any(one and one.startswith("-") for one in words):
                likely.add(first)
            for option, script in zip(words, words[1:]):
                if option in ("-c", "-ec", "-lc") and (first in SHELLS or SHELLS.intersection(words)) and "python3" not in words:
                    sure |= shell_commands(script or "")
        if isinstance(node, ast.Call) and node.args:
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name not in RUNNERS:
                continue
            is_subprocess = isinstance(node.func, ast.Attribute) and getattr(node.func.value, "id", "") in ("subprocess", "shutil", "os")
            arguments = [argument for argument in node.args if not isinstance(argument, ast.Starred)]
            if not arguments:
                continue
            first = arguments[0]
            if isinstance(first, (ast.List, ast.Tuple)) and first.elts:
                first = first.elts[0]
            if (said := text_of(first)) is None:
                continue
            if is_subprocess and name in ("system", "popen", "getoutput") or any(key.arg == "shell" for key in node.keywords):
                sure |= shell_commands(said)
            else:
                (sure if is_subprocess else likely).add(said)
    return {name for name in sure if re.fullmatch(r"\w[\w.+-]*", name)}, {name for name in likely if re.fullmatch(r"\w[\w.+-]*", name)}


# {program: files that call it}, the same of words that are programs only if one of that name is installed, and of modules of Python that are neither Python's nor ours.
def called(source):
    sure, likely, functions = collections.defaultdict(set), collections.defaultdict(set), set()
    imported, ours = collections.defaultdict(set), set()
    paths = []
    for place, below, names in os.walk(source):
        below[:] = [name for name in below if name not in (".git", "build", "node_modules")]
        paths += [pathlib.Path(place, name) for name in names]
    for path in paths:
        if not path.is_file() or path.stat().st_size > 1_000_000:
            continue
        octets = path.read_bytes()
        if b"\0" in octets[:1000]:
            continue
        text, file = octets.decode(errors="replace"), str(path.relative_to(source))
        first = text.split("\n", 1)[0]
        if path.suffix == ".py" or first.startswith("#!") and "python" in first:
            ours.add(path.parent.name if path.stem == "__init__" else path.stem)
            for name in modules(text):
                imported[name].add(file)
            certain, others = python_commands(text)
            for name in certain:
                sure[name].add(file)
            for name in others:
                likely[name].add(file)
        elif path.suffix == ".sh" or first.startswith("#!") and re.search(r"\b(ba|z)?sh$", first):
            functions |= shell_functions(text)
            for words in re.findall(r"\bfor program in ([^;\n]+);", text):
                for name in re.findall(r"(?<!\S)\w[\w.+-]*(?!\S)", words):
                    sure[name].add(file)
            for name in shell_commands(text):
                sure[name].add(file)
        elif path.suffix == ".md":
            for block in re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S):
                for name in shell_commands(block):
                    likely[name].add(file)
        elif path.suffix == ".cmake" or path.name == "CMakeLists.txt":
            text = re.sub(r"#[^\n]*", "", text)
            for name in re.findall(r"\bCOMMAND\s+([\w.+-]+)", text) + re.findall(r"find_program\(\s*\w+\s+(?:NAMES\s+)?([\w.+-]+)", text):
                likely[name].add(file)
        elif path.suffix in (".mjs", ".ts"):
            for name in re.findall(r"\b(?:spawn|spawnSync|execFile|execFileSync|exec|execSync)\)?\(\s*['\"`]([\w.+-]+)", text):
                likely[name].add(file)
        elif path.suffix == ".idl":  # a stub has the modules of its interfaces
            ours |= {f"{name}{kind}" for name in re.findall(r"^\s*module (\w+)", text, re.M) for kind in ("", "__POA")} | {f"{path.stem}_idl", f"{path.stem}_idl_example"}
        elif path.suffix in (".cpp", ".h", ".c"):
            ours |= set(re.findall(r"\bPYBIND11_MODULE\((\w+)", text))
            for name in re.findall(r"\b(?:system|popen|execlp|execvp|posix_spawnp?)\((?:&?\w+, )?\"([\w.+-]+)", text) + re.findall(r"command = \"([\w.+-]+) ", text):
                sure[name].add(file)
    for name in functions:
        sure.pop(name, None)
        likely.pop(name, None)
    own = (sys.stdlib_module_names - SPLIT_OFF) | ours | set(OTHER_MODULES)
    return sure, likely, {name: files for name, files in imported.items() if name not in own}


# A line for each program that is neither ours (`made`) nor of one of these packages. place(NAME) is the path of an installed program, or None.
def problems(sure, likely, packages, made, owner, place=installed):
    found = []
    for name in sorted(set(sure) | set(likely)):
        if name.removesuffix(".rtm-sim") in made or name in OPTIONAL:
            continue
        files = ", ".join(sorted(sure.get(name, set()) | likely.get(name, set()))[:4])
        path = place(name)
        if path is None:
            if name in sure:
                found.append(f"{name}: not installed here; called by {files}")
            continue
        package = owner.get(without_usr(os.path.realpath(path))) or owner.get(without_usr(path))
        if package not in packages and not (package is None and name in ("node", "npm")):
            found.append(f"{name}: of package {package}, which scripts/setup does not install; called by {files}")
    return found + [f"{name}: called by nothing; take it out of OPTIONAL" for name in OPTIONAL if name not in sure and name not in likely]


def check_called(source, build):
    packages = brought(source)
    made = {path.name for path in (build / "package").iterdir()} | set(re.findall(r"\bbin/([\w.+-]+)", (build / "build.ninja").read_text()))
    sure, likely, imported = called(source)
    found = problems(sure, likely, packages, made, owners())
    found += [f"module {name} of Python: not of Debian's python3, and of no package that scripts/setup installs; imported by {', '.join(sorted(files))}"
              for name, files in sorted(imported.items()) if PACKAGED_MODULES.get(name) not in packages]
    print("\n".join(found) or f"{len(sure)} programs; {len(packages)} packages")
    return 1 if found else 0


# --- What is executed ---

EXECUTED = 0x1000  # FAN_OPEN_EXEC
OF_MOUNT = 0x11  # FAN_MARK_ADD | FAN_MARK_MOUNT


# Runs a command and returns its exit code and the paths of all files that processes of this mount namespace executed meanwhile, from fanotify. No process waits for this one.
def executed_by(command, folder):
    import ctypes  # only for this mode
    import select
    libc = ctypes.CDLL(None, use_errno=True)
    events = libc.fanotify_init(0x10, os.O_RDONLY | os.O_CLOEXEC)  # FAN_UNLIMITED_QUEUE
    if events < 0:
        raise OSError(ctypes.get_errno(), "fanotify_init")
    with open("/proc/self/mountinfo", encoding="utf-8") as mounts:
        for line in mounts:
            place = line.split()[4]
            if not place.startswith(("/proc", "/sys", "/dev")):
                libc.fanotify_mark(events, ctypes.c_uint(OF_MOUNT), ctypes.c_uint64(EXECUTED), -100, place.encode())
    process = subprocess.Popen(command, cwd=folder)
    counts = collections.Counter()
    while True:
        ready, _, _ = select.select([events], [], [], 0.5)
        if not ready:
            if process.poll() is not None:
                return process.returncode, counts
            continue
        octets = os.read(events, 1 << 16)
        at = 0
        while at < len(octets):
            size, _, _, _, _, descriptor, _ = struct.unpack_from("=IBBHQii", octets, at)
            if descriptor >= 0:
                counts[os.readlink(f"/proc/self/fd/{descriptor}")] += 1
                os.close(descriptor)
            at += size


def check_executed(build, options):
    source = pathlib.Path(__file__).resolve().parents[2]
    packages, owner = brought(source), owners()
    code, counts = executed_by(["ctest", "--output-on-failure", *options], build)
    beside, alone = collections.defaultdict(set), set()
    for path in counts:
        package = owner.get(without_usr(path))
        if package is None:
            if path.startswith(tuple(f"{folder}/" for folder in FOLDERS)):
                alone.add(path)
        elif package not in packages:
            beside[package].add(path)
    print(f"{len(counts)} programs were executed; ctest: exit code {code}")
    for path in sorted(alone):
        print(f"of no package: {path}")
    for package, paths in sorted(beside.items()):
        print(f"package {package}, which scripts/setup does not install: {' '.join(sorted(paths))}")
    return 1 if beside or code else 0


if __name__ == "__main__":
    try:
        if sys.argv[1] == "called":
            sys.exit(check_called(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])))
        if os.environ.get("RTMSIM_APART") is None:
            os.environ["RTMSIM_APART"] = "yes"
            os.execvp("unshare", ["unshare", "--mount", sys.executable, "-B", *sys.argv])
        sys.exit(check_executed(sys.argv[2], sys.argv[3:]))
    except Missing as why:
        print(f"skipped: {why}")
        sys.exit(77)
