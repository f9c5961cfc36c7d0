# The worlds and models in the tree are what their scripts write: generated_worlds.py SOURCE_DIR
import filecmp
import pathlib
import shutil
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1]) / "worlds"
with tempfile.TemporaryDirectory() as folder:
    copy = pathlib.Path(folder) / "worlds"
    shutil.copytree(source, copy)
    for script in sorted(copy.glob("make_*.py")):
        words = ["100", str(copy / "hundred.sdf")] if script.name == "make_arena.py" else []
        subprocess.run([sys.executable, str(script), *words], cwd=copy, check=True, timeout=100)
    files = [path.relative_to(source) for path in source.rglob("*") if path.is_file()]
    different = [str(path) for path in files if not filecmp.cmp(source / path, copy / path, shallow=False)]
    more = [str(path.relative_to(copy)) for path in copy.rglob("*")
            if path.is_file() and not (source / path.relative_to(copy)).exists() and "__pycache__" not in str(path)]
assert not different and not more, f"not what the scripts write: {different}; not in the tree: {more}"
print("ok")
