# The pages are true.  docs.py MODE SOURCE_DIR [BUILD_DIR]
#   pages       links and names of files lead somewhere; the index has every page
#   promises    each promise of docs/promises.md names tests that exist, in ctest or, those by hand, as files below tests/
import pathlib
import re
import subprocess
import sys

mode, source = sys.argv[1], pathlib.Path(sys.argv[2])
docs = source / "docs"
pages = [source / "README.md", source / "CONTRIBUTING.md", source / "SECURITY.md", *sorted(docs.glob("*.md"))]
problems = []


def text_of(page):
    return re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)


# As the places where such pages are shown make it.
def anchors_of(page):
    headings = re.findall(r"^#+ (.*)$", text_of(page), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check_links(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            problems.append(f"{page.relative_to(source)}: link {target}: there is no such file")
        elif anchor and anchor not in anchors_of(file):
            problems.append(f"{page.relative_to(source)}: link {target}: there is no such heading")


# `sim-server/world/model_path` and `tests/robustness/fragments.py`: a file or folder, or one with its ending left out.
def check_names(page):
    folders = "cmake|clients|docs|idl|iface-components|packaging|rtm-core|scripts|sim-server|tests|worlds"
    for name in re.findall(rf"`((?:{folders})/[\w./+-]*\w)`", text_of(page)):
        path = source / name
        if not path.exists() and not list(path.parent.glob(path.name + ".*")) and not list(path.parent.glob(path.name + "_test.cpp")):
            problems.append(f"{page.relative_to(source)}: `{name}`: there is no such file")


def check_pages():
    for page in pages:
        check_links(page)
        if not page.name.startswith("new-"):  # these name files that are still to be made
            check_names(page)
    index = (docs / "README.md").read_text()
    for page in sorted(docs.glob("*.md")):
        if page.name != "README.md" and f"({page.name})" not in index:
            problems.append(f"docs/README.md: {page.name} is not in the index")


def check_promises(build):
    shown = subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
    tests = re.findall(r"^ +Test +#\d+: (\S+)", shown, re.M)
    not_built = [name.removesuffix("_NOT_BUILT") for name in tests if name.endswith("_NOT_BUILT")]
    rows = re.findall(r"^\|(.*)\|(.*)\|$", (docs / "promises.md").read_text(), re.M)
    rows = [row for row in rows if row[1].strip() not in ("kept by", "---")]
    assert len(rows) > 20, rows
    for promise, kept_by in rows:
        names = re.findall(r"`([^`]+)`", kept_by)
        if not names:
            problems.append(f"docs/promises.md: {promise.strip()}: no test keeps it")
        for name in names:
            if name.startswith("tests/"):
                if not (source / name).is_file():
                    problems.append(f"docs/promises.md: {promise.strip()}: there is no file {name}")
            elif not any(test.startswith(name) for test in tests) and name.split(".")[0] not in not_built:
                problems.append(f"docs/promises.md: {promise.strip()}: there is no test {name}")


if mode == "pages":
    check_pages()
else:
    check_promises(sys.argv[3])
for problem in problems:
    print(problem)
sys.exit(1 if problems else 0)
