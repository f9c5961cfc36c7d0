"""The packages of IDL modules: they import the stub files that add to a module, and hold the types of these."""
import os
import re


def make_folder(folder):
    if folder:
        os.makedirs(folder, exist_ok=True)


_PACKAGE = """\
# Python package of the IDL module {name}. omniidl rewrites this file: it adds the stub files that it has made.
import omniORB
omniORB.updateModule("{name}")

# ** 1. Stub files contributing to this module
{stubs}

# ** 2. Sub-modules
{subs}

# ** 3. End
"""


def write_package(options, name, stub, is_poa):
    parts = name.split(".")
    full = ".".join([parts[0] + "__POA"] + parts[1:]) if is_poa else name
    folder = os.path.join(options.modules.replace(".", "/"), *full.split("."))
    make_folder(folder)
    file = os.path.join(folder, "__init__.py")
    stubs, subs = [], []
    if os.path.exists(file):
        with open(file) as old:
            section = 0
            for line in old:
                line = line.strip()
                if line.startswith("# ** "):
                    section = int(line[5])
                elif section == 1 and line.startswith(("import ", "omniORB.importLater(")):
                    stubs.append(line)
                elif section == 2 and line.startswith("from . import "):
                    subs.append(line)
    name_of_stub = options.stubs + stub.module
    line = "import " + name_of_stub
    if options.later:
        names = re.findall(r"(?m)^_0_%s\.([A-Za-z]\w*) = " % re.escape(full), "\n".join(stub.lines))
        line = 'omniORB.importLater(__name__, "%s", "%s")' % (name_of_stub, " ".join(names))
    if line not in stubs:
        stubs.append(line)
    for other in stub.modules_seen:
        if other.rpartition(".")[0] == name:
            line = "from . import " + other.rpartition(".")[2]
            if line not in subs:
                subs.append(line)
    # Names are made when the module is imported: type checkers read them here.
    _write_types(file + "i", options, stub, [] if is_poa else stub.types.lines.get(name, []), is_poa)
    if options.closed:
        open(os.path.join(folder, "py.typed"), "w").close()
    with open(file, "w") as out:
        out.write(_PACKAGE.format(name=options.modules + full, stubs="\n".join(stubs), subs="\n".join(subs)))


_TYPES = """\
# Types of an IDL module. omniidl rewrites this file: it adds those of the stub files that it has made.
from typing import Any, List, Tuple
from omniORB.CORBA import Object
"""


def _write_types(file, options, stub, lines, is_open):
    sections = {}
    if os.path.exists(file):
        with open(file) as old:
            name = None
            for line in old:
                if line.startswith("# ** "):
                    name = line[5:].strip()
                    sections[name] = []
                elif name is not None:
                    sections[name].append(line.rstrip("\n"))
    sections.pop("others", None)
    if lines:
        sections[stub.module] = lines
    if is_open or not options.closed:
        sections["others"] = ["def __getattr__(name: str) -> Any: ..."]
    with open(file, "w") as out:
        out.write(_TYPES)
        for name, text in sections.items():
            out.write("\n".join(["# ** " + name] + text) + "\n")
