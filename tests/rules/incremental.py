# incremental.py BUILD_DIR: a change is followed by what uses it, and no more: no program or module is linked anew because a shared library of ours was. It finds
# that one when it starts, and what includes a changed header is compiled anyway.
import pathlib
import re
import sys

plan = pathlib.Path(sys.argv[1]) / "build.ninja"
if not plan.exists():
    print("skipped: not built with ninja")
    sys.exit(77)
linked, problems = 0, []
for line in plan.read_text().splitlines():
    if found := re.match(r"build ((?:bin|lib)/\S+)[^:]*: CXX_(?:EXECUTABLE|MODULE_LIBRARY)_LINKER\S* (.*)", line):
        linked += 1
        awaited = found[2].split(" || ")[0]  # behind it: what must be there before, whatever its age
        problems += [f"{found[1]} follows {library}" for library in re.findall(r"\blib/librtmsim_\S+\.so\S*", awaited)]
if problems:
    sys.exit("\n".join(problems[:10]) + f"\n{len(problems)} in all: is CMAKE_LINK_DEPENDS_NO_SHARED set?")
assert linked > 50, f"only {linked} programs and modules are in {plan}"
print(f"{linked} programs and modules follow no shared library")
