# Functions that headers of the inside declare and nobody calls: dead_code.py SOURCE_DIR. By their names: who shares a name with a living one is not found.
import collections
import pathlib
import re
import subprocess
import sys

source = pathlib.Path(sys.argv[1])
names = subprocess.run(["git", "-C", str(source), "ls-files", "--cached", "--others", "--exclude-standard", "*.h", "*.cpp", "*.c", "*.in", "*.py"],
                       capture_output=True, text=True, check=True).stdout.split()
texts = {name: re.sub(r"//[^\n]*", "", (source / name).read_text(errors="replace")) for name in names if (source / name).exists()}
counts = collections.Counter(word for text in texts.values() for word in re.findall(r"[A-Za-z_]\w*", text))
definitions = {word for name, text in texts.items() if name.endswith(".cpp") for word in re.findall(r"^\S.*::(\w+)\(", text, re.M)}

dead = []
for name, text in texts.items():
    if not name.endswith(".h") or "/include/" in name or name.startswith("tests/"):
        continue
    for line in re.findall(r"^[ \w:<>,&*~\[\]]*?\b[a-z_]\w*\(.*$", text, re.M):
        word = re.search(r"\b([a-z_]\w*)\(", line).group(1)
        if "override" not in line and (counts[word] == 1 or counts[word] == 2 and word in definitions):
            dead.append(f"{name}: nobody calls {word}()")
print("\n".join(dead), end="\n" if dead else "")
sys.exit(1 if dead else 0)
