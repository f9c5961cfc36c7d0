"""Loading of modules, and the program of a host: what `rtcd X.py` runs.

A module is imported under a name of its own, so that two files X.py of different folders stand beside each other; while it loads it is
also known under its bare name. Its folder comes first in sys.path.
"""
import os
import sys

import _openrtm_core as _core

_loaded = {}  # real path: module


def prepare():
    """What depends on the configuration, once it is read."""
    coding = _core.manager_config().getProperty("manager.modules.Python.text")
    if coding:
        _core.set_text_coding(coding.lower())


def load(file, init_function):
    """Import a module and call its init function. Empty, or the line that says why it failed."""
    import traceback
    try:
        module = _import(file)
    except SyntaxError as problem:
        return syntax_problem(file, problem)
    except BaseException:
        return "cannot be imported: " + traceback.format_exc().rstrip()
    stem = os.path.splitext(os.path.basename(file))[0]
    names = [init_function] if init_function else [stem + "Init", stem[:1].upper() + stem[1:] + "Init", "MyModuleInit"]
    function = next((getattr(module, name) for name in names if callable(getattr(module, name, None))), None)
    if function is None:
        return "has no function " + names[0]
    from .manager import Manager
    try:
        function(Manager.instance())
    except BaseException:
        return "%s raised: %s" % (function.__name__, traceback.format_exc().rstrip())
    return ""


def _import(file):
    import importlib.util
    path = os.path.realpath(file)
    if path in _loaded:
        return _loaded[path]
    folder = os.path.dirname(path)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    stem = os.path.splitext(os.path.basename(path))[0]
    taken = sys.modules.get(stem)
    name = stem if taken is None else "%s (%s)" % (stem, folder)
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    _loaded[path] = module
    return module


def syntax_problem(file, problem):
    """One line; for sources of Python 2 with what to write instead."""
    where = "%s:%s: " % (os.path.basename(problem.filename or file), problem.lineno)
    text = (problem.text or "").strip()
    if isinstance(problem, TabError):
        return where + "mixes tabs and blanks, which Python 3 does not accept: use blanks only"
    if "print" in (problem.msg or "") or text.startswith("print "):
        return where + "is Python 2: write print(...) instead of `%s`" % text
    if text.startswith("except ") and "," in text:
        return where + "is Python 2: write `except Error as name:` instead of `%s`" % text
    if text.startswith("exec "):
        return where + "is Python 2: write exec(...) instead of `%s`" % text
    return where + "%s: `%s`" % (problem.msg, text)


def main(argv):
    """The arguments of rtcd, with its options; modules and types that are left over are loaded and created."""
    from .manager import Manager
    # Nobody types here; what waits for input would wait for ever.
    if not sys.stdin or not sys.stdin.isatty():
        sys.stdin = open(os.devnull)
    words, modules = _split(argv[1:])
    sys.argv = ["rtcd"]
    Manager._start(["rtcd"] + words, True, modules)
    if not _core.manager_activate():
        was_told_to_end = not _core.manager_is_running()
        _core.manager_shutdown()
        if was_told_to_end:
            return 0
        sys.stderr.write("rtcd: not everything on the command line could be created\n")
        return 1
    _core.manager_run(False)
    return 0


# rtcd hands over the options that it has read, then `--`, then the modules.
def _split(words):
    if "--" not in words:
        return words, []
    at = words.index("--")
    return words[:at] + words[at + 1:], words[at + 1:]

