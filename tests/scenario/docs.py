# The pages are true.  docs.py MODE SOURCE_DIR [BUILD_DIR]
#   pages       links and names of files lead somewhere; the index has every page; the table of layers is that of include_rules_test,
#               those of bundled components are those of their sources
#   layers      writes the table of layers into docs/ARCHITECTURE.md
#   components  writes the tables of bundled components into docs/components.md, all but the words of their last columns
#   promises    each promise of docs/promises.md and docs/security.md names tests that exist, in ctest or, those by hand, as files below tests/
import pathlib
import re
import subprocess
import sys

mode, source = sys.argv[1], pathlib.Path(sys.argv[2])
docs = source / "docs"
pages = [source / "README.md", source / "CONTRIBUTING.md", source / "SECURITY.md", *sorted(docs.glob("**/*.md"))]
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
    folders = "base|clients|cmake|docs|gateways|idl|iface-components|packaging|rtm-core|scripts|shm|sim-server|tests|tools|worlds"
    for name in re.findall(rf"`((?:{folders})/[\w./+-]*\w)`", text_of(page)):
        path = source / name
        if not path.exists() and not list(path.parent.glob(path.name + ".*")) and not list(path.parent.glob(path.name + "_test.cpp")):
            problems.append(f"{page.relative_to(source)}: `{name}`: there is no such file")


# Folders in the order of the test, what they may include, libraries.
def rows_of_layers():
    rules = (source / "tests/rules/include_rules_test.cpp").read_text().split("layers = {", 1)[1].split("\n};", 1)[0]
    rows = re.findall(r'\{"([^"]+)",\s*\{([^}]*)\}(?:,\s*\{([^}]*)\})?(?:,\s*\{[^}]*\})?\}', rules)
    assert len(rows) > 20, rows
    names = lambda words: ", ".join(re.findall(r'"([^"]+)"', words))
    return [f"| `{folder}` | {names(parts)} | {names(libraries)} |" for folder, parts, libraries in rows]


# The table in ARCHITECTURE: where it is in the page, and its rows.
def table_of_layers(text):
    table = re.search(r"(?<=^\| folder \| may include \| libraries \|\n\| --- \| --- \| --- \|\n)(?:\|.*\|\n)+", text, re.M)
    return table.span(), table[0].splitlines()


def check_layers():
    for row in sorted(set(rows_of_layers()) ^ set(table_of_layers((docs / "ARCHITECTURE.md").read_text())[1])):
        problems.append(f"docs/ARCHITECTURE.md: layers are not those of tests/rules/include_rules_test.cpp (docs.py layers . writes them): {row}")


def write_layers():
    text = (docs / "ARCHITECTURE.md").read_text()
    (start, end), _ = table_of_layers(text)
    (docs / "ARCHITECTURE.md").write_text(text[:start] + "\n".join(rows_of_layers()) + "\n" + text[end:])


# The table and the cells of each row that are in the sources; those of drives and rangers are in common files. Of the words no cell: None.
def facts_of_components():
    sources = [*sorted((source / "iface-components").glob("rtc_*.cpp")), source / "clients/obstacle-avoidance/laser_obstacle_avoid.cpp",
               source / "clients/box-stacker/box_stacker.cpp", source / "clients/pilot/waypoint_pilot.cpp", source / "clients/way-points/way_points.cpp", source / "clients/warehouse/porter.cpp", source / "clients/video-player/video_player.cpp"]
    drive, ranger = ((source / f"iface-components/{name}_component.cpp").read_text() for name in ("drive", "ranger"))
    for file in sources:
        text, header = file.read_text(), file.with_suffix(".h").read_text()
        name = re.search(r'type_name(?: = |", )"(\w+)"', text)[1]
        phase = {"sensor_phase": "0", "command_phase": "2"}.get((re.search(r"\.phase = iface::(\w+)", text) or ["", ""])[1]) or re.search(r'sim_time\.phase", "(\d+)"', text)[1]
        device = re.search(r'\.device = "([^"]*)"', text)
        yield "Components", [f"`{name}`", None, phase, f"`{device[1]}`" if device else ""]
        for way, port, member in re.findall(r'add(In|Out)Port\("(\w+)", (\w+)\)', text):
            type = re.search(rf"Port<([\w:]+)> {member};", header)[1]
            yield "Ports", [f"`{name}`", f"{way.lower()} `{port}`", f"`{type}`", None]
        if velocity := re.search(r"Drive\w*<(RTC::Timed\w+)", header):
            yield "Ports", [f"`{name}`", "in `velocity`", f"`{velocity[1]}`", None]
        texts = text + (ranger if "RangerComponent" in header else "")
        for port, service in re.findall(r'registerProvider\("(\w+)", "([\w:]+)"', texts) + re.findall(r'registerProvider\(value\("(\w+)"\)\.c_str\(\), \(module \+ "(\w+)"', text):
            yield "Ports", [f"`{name}`", f"provides `{port}`", f"`{service}`", None]
        for port, service in re.findall(r'registerConsumer\("(\w+)", "([\w:]+)"', text):
            yield "Ports", [f"`{name}`", f"uses `{port}`", f"`{service}`", None]
        listed = drive if "drive_parameters()" in text else text
        for parameter, default in re.findall(r'\{"(\w+)", "([^"]*)", "(?:int|double|string)"', listed) + re.findall(r'"conf\.default\.(\w+)", "([^"]*)"', text):
            yield "Parameters", [f"`{name}`", f"`{parameter}`", default, None]


# Types and services of the interface guidelines: the table has each, and says of those that no component has that they have no device.
def check_guideline():
    shown = (docs / "components.md").read_text().split("\n## Types of the interface guidelines")[1].split("\n## ")[0]
    named = {name for row in re.findall(r"^\| (`.*?) \|", shown, re.M) for name in re.findall(r"`(\w+)`", row)}
    idl = (source / "idl/InterfaceDataTypes.idl").read_text()
    types = set(re.findall(r"^  (?:struct|enum) (\w+)", idl, re.M)) | {name for name in re.findall(r"^  typedef sequence<.*> (\w+);", idl, re.M) if not name.endswith("List")}
    offered = {service for file in (source / "iface-components").glob("*.cpp") for service in re.findall(r'"RTC::(\w+)"', file.read_text())}
    services = {name for file in sorted((source / "idl/ext").glob("*.idl")) for name in re.findall(r"^module RTC \{.*?^\};", file.read_text(), re.M | re.S) for name in re.findall(r"^  interface (\w+)", name, re.M)}
    for name in sorted(named ^ (types | (services - offered))):
        problems.append(f"docs/components.md: types of the interface guidelines: {name}: {'is no type, or a service that a component has' if name in named else 'is missing'}")


to_be_written = "(to be written)"


def key_of(cells):
    return cells[0], "" if cells[1] is None else cells[1]


# A table with the cells of the sources: its words and the order of its rows stay, new rows come after those of their component.
def made_table(rows, facts):
    is_list = facts[0][1] is None
    words = {(row[0], "" if is_list else row[1]): row for row in rows}
    keys = [key for key in words if any(key_of(row) == key for row in facts)]
    for row in facts:
        if (key := key_of(row)) not in keys:
            keys.insert(max((i + 1 for i, known in enumerate(keys) if known[0] == key[0]), default=len(keys)), key)
    lines = []
    for key in keys:
        fresh = next(row for row in facts if key_of(row) == key)
        cells = [(words[key][i] if key in words else to_be_written) if cell is None else cell for i, cell in enumerate(fresh)]
        lines.append("|" + "".join(f" {cell} |" if cell else " |" for cell in cells) + "\n")
    return "".join(lines)


def made_components():
    facts, text = {}, (docs / "components.md").read_text()
    for table, row in facts_of_components():
        facts.setdefault(table, []).append(row)
    for table, rows in facts.items():
        start = text.index(f"\n## {table}\n")
        shown = re.compile(r"^(?:\| `\w+` \|.*\n)+", re.M).search(text, start)
        shown_rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line[1:-1])] for line in shown[0].splitlines()]
        text = text[:shown.start()] + made_table(shown_rows, rows) + text[shown.end():]
    return text


def check_components():
    shown, made = (docs / "components.md").read_text().splitlines(), made_components().splitlines()
    for row in sorted(set(shown) ^ set(made)):
        problems.append(f"docs/components.md: {row}: {'not as in the sources' if row in shown else 'is missing'} (docs.py components . writes it)")
    problems.extend(f"docs/components.md: {row}: expected words instead of {to_be_written}" for row in shown if to_be_written in row)


def check_pages():
    check_layers()
    check_guideline()
    check_components()
    for page in pages:
        check_links(page)
        if not page.name.startswith("new-"):  # these name files that are still to be made
            check_names(page)
    index = (docs / "README.md").read_text()
    for page in sorted(docs.glob("**/*.md")):
        name = page.relative_to(docs)
        if page.name != "README.md" and f"({name})" not in index:
            problems.append(f"docs/README.md: {name} is not in the index")


# Rows of the tables of a page whose last column has this heading: the first cell, and the names in the last.
def rows_with_tests(page, heading):
    is_one = False
    for line in page.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        is_one = bool(cells) and (is_one or cells[-1] == heading)
        if is_one and cells[-1] not in (heading, "---"):
            yield cells[0], re.findall(r"`([^`]+)`", cells[-1])


def check_promises(build):
    shown = subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout
    tests = re.findall(r"^ +Test +#\d+: (\S+)", shown, re.M)
    not_built = [name.removesuffix("_NOT_BUILT") for name in tests if name.endswith("_NOT_BUILT")]
    for page, heading in (("promises.md", "kept by"), ("security.md", "tested by")):
        rows = list(rows_with_tests(docs / page, heading))
        assert len(rows) > 20, rows
        for promise, names in rows:
            if not names:
                problems.append(f"docs/{page}: {promise}: no test keeps it")
            for name in names:
                if name.startswith("tests/"):
                    if not (source / name).is_file():
                        problems.append(f"docs/{page}: {promise}: there is no file {name}")
                elif not any(test.startswith(name) for test in tests) and name.split(".")[0] not in not_built:
                    problems.append(f"docs/{page}: {promise}: there is no test {name}")


if mode == "layers":
    write_layers()
elif mode == "components":
    (docs / "components.md").write_text(made_components())
elif mode == "pages":
    check_pages()
else:
    check_promises(sys.argv[3])
for problem in problems:
    print(problem)
sys.exit(1 if problems else 0)
