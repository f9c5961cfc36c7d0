"""Loading of modules, and the program of a host: what `rtcd X.py` runs.

A module is imported under a name of its own, so that two files X.py of different folders stand beside each other; while it loads it is
also known under its bare name. Its folder comes first in sys.path.
"""
import os
import sys
from _thread import get_ident

import _openrtm_core as _core

_loaded = {}  # real path: module
_loading = []  # for each module that is being imported: [thread, the function that its main() gives to setModuleInitProc]


def prepare():
    """What depends on the configuration, once it is read."""
    coding = _core.manager_config().getProperty("manager.modules.Python.text")
    if coding:
        _core.set_text_coding(coding.lower())


def is_loading():
    """Whether a module is being imported now, on this thread."""
    return bool(_loading) and _loading[-1][0] == get_ident()


def set_init_function(function):
    _loading[-1][1] = function


def _told():
    """The exception that is being handled: what was raised, then its traceback."""
    import traceback
    text = traceback.format_exc().rstrip()
    return text.rsplit("\n", 1)[-1] + "\n" + text


def load(file, init_function):
    """Import a module and call its init function. Empty, or the line that says why it failed."""
    _loading.append([get_ident(), None])
    try:
        module = _import(file)
    except SyntaxError as problem:
        return syntax_problem(file, problem)
    except ValueError as problem:
        return "is no source of Python: it has null bytes" if "null bytes" in str(problem) else "cannot be imported: " + _told()
    except BaseException as problem:
        return old_name(problem) or "cannot be imported: " + _told()
    finally:
        named = _loading.pop()[1]
    stem = os.path.splitext(os.path.basename(file))[0]
    names = [init_function] if init_function else [stem + "Init", stem[:1].upper() + stem[1:] + "Init", "MyModuleInit"]
    function = next((getattr(module, name) for name in names if callable(getattr(module, name, None))), named)
    if function is None:
        return "has no function " + names[0]
    from .manager import Manager
    try:
        function(Manager.instance())
    except BaseException as problem:
        return old_name(problem) or "%s raised: %s" % (function.__name__, _told())
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


# What Python 2 wrote so: a pattern of the line, and what to write instead.
_OLD_SYNTAX = (
    (r"print\b", "print(...) instead of `%s`"), (r"except\s.*,", "`except Error as name:` instead of `%s`"), (r"exec\s", "exec(...) instead of `%s`"),
    (r"raise\s+[\w.]+\s*,", "`raise Error(...)` instead of `%s`"), (r".*<>", "`!=` instead of `<>` in `%s`"), (r".*`", "repr(...) instead of backquotes in `%s`"),
    (r".*\b\d+[lL]\b", "integers without L in `%s`"), (r".*\b[uU][rR]['\"]", "r'...' instead of ur'...' in `%s`"),
)
_OLD_MODULES = {
    "Tkinter": "tkinter", "tkMessageBox": "tkinter.messagebox", "tkFileDialog": "tkinter.filedialog", "Tix": "tkinter.tix", "ttk": "tkinter.ttk",
    "Queue": "queue", "ConfigParser": "configparser", "StringIO": "io", "cStringIO": "io", "cPickle": "pickle", "thread": "_thread",
    "commands": "subprocess", "urllib2": "urllib.request", "urlparse": "urllib.parse", "httplib": "http.client", "SocketServer": "socketserver",
    "BaseHTTPServer": "http.server", "SimpleHTTPServer": "http.server", "xmlrpclib": "xmlrpc.client", "SimpleXMLRPCServer": "xmlrpc.server",
    "__builtin__": "builtins", "HTMLParser": "html.parser", "copy_reg": "copyreg", "sets": "the builtin set", "exceptions": "builtins",
}
_OLD_NAMES = {"unicode": "str", "xrange": "range", "raw_input": "input", "long": "int", "basestring": "str", "unichr": "chr",
              "reduce": "functools.reduce", "file": "open", "execfile": "exec(open(...).read())", "cmp": "(a > b) - (a < b)"}


def syntax_problem(file, problem):
    """One line; for sources of Python 2 with what to write instead."""
    import re
    where = "%s:%s: " % (os.path.basename(problem.filename or file), problem.lineno)
    text = (problem.text or "").strip()
    if isinstance(problem, TabError):
        return where + "mixes tabs and blanks, which Python 3 does not accept: use blanks only"
    if "leading zeros" in (problem.msg or ""):
        octal = re.search(r"\b0(\d+)", text)
        return where + "is Python 2: write 0o%s in `%s`" % (octal.group(1) if octal else "...", text)
    for pattern, instead in _OLD_SYNTAX:
        if re.match(pattern, text):
            return where + "is Python 2: write " + instead % text
    return where + "%s: `%s`" % (problem.msg, text)


def old_name(problem):
    """One line for an exception that a source of Python 2 raises; empty for others."""
    instead = ""
    if isinstance(problem, ModuleNotFoundError) and problem.name in _OLD_MODULES:
        instead = "the module %s is %s now" % (problem.name, _OLD_MODULES[problem.name])
    elif isinstance(problem, NameError) and getattr(problem, "name", None) in _OLD_NAMES:
        instead = "the name %s is %s now" % (problem.name, _OLD_NAMES[problem.name])
    elif isinstance(problem, AttributeError) and getattr(problem, "name", None) in ("has_key", "iteritems", "itervalues", "iterkeys"):
        instead = "write `key in dictionary` instead of has_key" if problem.name == "has_key" else "write %s()" % problem.name[4:]
    elif isinstance(problem, TypeError) and "non-int of type 'float'" in str(problem):
        instead = "write // instead of /, which gives a float"
    if not instead:
        return ""
    import traceback
    last = traceback.extract_tb(problem.__traceback__)[-1]
    return "%s:%s: is Python 2: %s" % (os.path.basename(last.filename), last.lineno, instead)


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

