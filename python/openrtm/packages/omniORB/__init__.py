"""The part of omniORBpy that stubs, components and scripts of RT components use, over the ORB of this process.

Types are descriptors: tuples that the stubs of omniidl register here (registerType). The extension module _openrtm_core encodes and
decodes by them. A name that is missing raises AttributeError.
"""
import os as _os
import sys

_Module = type(sys)

__version__ = "4.2.5"
coreVersion = lambda: "4.2.5"



class _Registry(dict):
    """Entries by repository id. A stub file that is loaded later registers its types when one of them is looked up."""

    def __missing__(self, repo_id):
        scope = str(repo_id).partition(":")[2].partition(":")[0].split("/")
        for module in scope[:-1]:
            if module in _later:
                getattr(sys.modules.get(module), scope[-1], None)
        if dict.__contains__(self, repo_id):
            return dict.__getitem__(self, repo_id)
        raise KeyError(repo_id)

    def get(self, repo_id, default=None):
        try:
            return self[repo_id]
        except KeyError:
            return default

    def __contains__(self, repo_id):
        return self.get(repo_id) is not None


typeMapping = _Registry()
typeCodeMapping = _Registry()
objrefMapping = _Registry()
skeletonMapping = _Registry()
valueFactoryMapping = {}
_partial = {}
_anonymous = "Anonymous IDL"

# The folder of this installation: user stubs that shadow one of our packages get our names as well (updateModule).
_home = _os.path.dirname(_os.path.dirname(_os.path.abspath(__file__)))


class StructBase:
    _NP_RepositoryId = None

    def _members(self):
        descriptor = typeMapping.get(self._NP_RepositoryId)
        return descriptor[4::2] if descriptor else tuple(vars(self))

    def _tuple(self):
        return tuple(getattr(self, name) for name in self._members())

    def __repr__(self):
        scope = (self._NP_RepositoryId or "").split(":")
        name = scope[1].replace("/", ".") if len(scope) > 1 else type(self).__name__
        if name.startswith("omg.org."):
            name = name[len("omg.org."):]
        return "%s(%s)" % (name, ", ".join("%s=%r" % (one, getattr(self, one, None)) for one in self._members()))


class Union:
    _def_m = None
    _def_d = None
    _m_to_d = {}
    _d_to_m = {}

    def __init__(self, *args, **kw):
        if len(args) == 2 and not kw:
            self._d, self._v = args
        elif not args and len(kw) == 1:
            (name, value), = kw.items()
            setattr(self, name, value)
        elif args or kw:
            raise TypeError("a union takes discriminator and value, or one member by its name")
        else:
            self._d = self._v = None

    def __getattr__(self, name):
        if name.startswith("__") or name in ("_d", "_v"):
            raise AttributeError(name)
        if name in self._m_to_d or name == self._def_m:
            if self._d_to_m.get(self._d, self._def_m) == name:
                return self._v
            raise CORBA.BAD_PARAM(0, CORBA.COMPLETED_NO)
        raise AttributeError(name)

    def __setattr__(self, name, value):
        if name in self._m_to_d:
            self.__dict__.update(_d=self._m_to_d[name], _v=value)
        elif name == self._def_m and name is not None:
            self.__dict__.update(_d=self._def_d, _v=value)
        else:
            self.__dict__[name] = value

    def __repr__(self):
        return "%s(%r, %r)" % (type(self).__name__, self._d, self._v)


class EnumItem:
    def __init__(self, name, value):
        self._n = name
        self._v = value
        self._parent_id = None

    def __str__(self):
        return self._n

    __repr__ = __str__

    def _same(self, other):
        return isinstance(other, EnumItem) and other._parent_id == self._parent_id

    def __eq__(self, other):
        return self is other or (self._same(other) and self._v == other._v)

    def __ne__(self, other):
        return not self == other

    def __lt__(self, other):
        return self._v < other._v if self._same(other) else NotImplemented

    def __le__(self, other):
        return self._v <= other._v if self._same(other) else NotImplemented

    def __gt__(self, other):
        return self._v > other._v if self._same(other) else NotImplemented

    def __ge__(self, other):
        return self._v >= other._v if self._same(other) else NotImplemented

    def __hash__(self):
        return hash((self._parent_id, self._v))


class Enum:
    def __init__(self, repoId, items):
        self._NP_RepositoryId = repoId
        self._items = items
        for item in items:
            item._parent_id = repoId

    def _item(self, number):
        return self._items[number]


def newEmptyClass():
    class Empty:
        pass
    return Empty


def registerType(repoId, descriptor, typecode):
    typeMapping[repoId] = descriptor
    typeCodeMapping[repoId] = typecode


def registerObjref(repoId, objref):
    objrefMapping[repoId] = objref


def registerSkeleton(repoId, skeleton):
    skeletonMapping[repoId] = skeleton


def registerValueFactory(repoId, factory):
    old = valueFactoryMapping.get(repoId)
    valueFactoryMapping[repoId] = factory
    return old


def unregisterValueFactory(repoId):
    valueFactoryMapping.pop(repoId, None)


def findType(repoId):
    return typeMapping.get(repoId)


def findTypeCode(repoId):
    return typeCodeMapping.get(repoId)


def _import(name):
    __import__(name)
    return sys.modules[name]


# --- modules of stubs: while only the stub file is loaded, its modules are partial; their package takes over what is in them.

def newModule(name):
    module = _Module(name)
    _partial[name] = module
    return module


def openModule(name, file=None):
    module = sys.modules.get(name) or _partial.get(name)
    if module is None:
        module = newModule(name)
    above, _, last = name.rpartition(".")
    if above:
        setattr(openModule(above), last, module)
    return module


def updateModule(name):
    module = sys.modules[name]
    partial = _partial.pop(name, None)
    if partial is not None:
        for key, value in vars(partial).items():
            if key not in ("__name__", "__file__", "__path__", "__loader__", "__spec__", "__package__", "__doc__"):
                setattr(module, key, value)
    _add_ours(name, module)


_later = {}  # by the name of the module: {stub file: the names that it adds}


def importLater(name, stub, names=""):
    """Load a stub file of the module when one of its names is used: most programs use few types and interfaces."""
    _later.setdefault(name, {})[stub] = names.split()
    vars(sys.modules[name]).setdefault("__getattr__", lambda attribute: _load_later(name, attribute))
    vars(sys.modules[name]).setdefault("__dir__", lambda: [*_load_later(name, "__all__"), *vars(sys.modules[name])])


# A stub file leaves the list when it is loaded, so a second thread waits for the first one.
def _load_later(name, attribute):
    found, waiting = vars(sys.modules[name]), _later[name]
    if attribute.startswith("__") and attribute != "__all__":
        raise AttributeError("module %r has no attribute %r" % (name, attribute))
    plain = attribute.split("_", 2)[-1] if attribute.startswith("_") else attribute  # _d_X and _tc_X are from the file of X
    for stub in sorted(list(waiting), key=lambda one: plain not in waiting.get(one, ())):
        if attribute in found:
            break
        _import(stub)
        waiting.pop(stub, None)
    if attribute == "__all__":
        return [one for one in found if not one.startswith("_")]
    if attribute in found:
        return found[attribute]
    raise AttributeError("module %r has no attribute %r" % (name, attribute))


# A user's stubs of an IDL module that we have as well (RTC, OpenRTM) come first in sys.path and hold a part of it only.
def _add_ours(name, module):
    file = _os.path.abspath(getattr(module, "__file__", None) or "")
    ours = _os.path.join(_home, *name.split("."), "__init__.py")
    if not file or file == ours or not _os.path.exists(ours):
        return
    with open(ours) as text:
        for line in text:
            if line.startswith("import ") and line.strip().endswith("_idl"):
                _import(line.split()[1])
            elif line.startswith("omniORB.importLater("):
                importLater(name, *line.split('"')[1::2])


def promotePartialModule(name):
    module = _partial.pop(name, None)
    if module is not None:
        sys.modules[name] = module


def promotePartialModules():
    for name in list(_partial):
        if not name.startswith("_"):
            promotePartialModule(name)


def static_is_a(skeleton, repoId):
    return any(getattr(base, "_NP_RepositoryId", None) == repoId for base in skeleton.__mro__)


# --- IDL at run time

def _run_omniidl(words, text=None):
    import subprocess
    environment = dict(_os.environ)
    backend = _os.path.join(_home, "omniidl_backend")
    if _os.path.isdir(backend):
        environment["PYTHONPATH"] = _os.pathsep.join([backend] + environment.get("PYTHONPATH", "").split(_os.pathsep)).strip(_os.pathsep)
    command = ["omniidl", "-bpython", "-Wbstdout", "-Wbinline"] + words
    try:
        done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=60, env=environment)
    except FileNotFoundError:
        raise ImportError("IDL cannot be compiled: the program omniidl is missing; install the package omniidl") from None
    if done.returncode:
        raise ImportError("IDL cannot be compiled: " + done.stderr.strip())
    return done.stdout


def importIDL(file, args=None, inline=1):
    """Compile an IDL file and load its stubs. Returns the names of its modules."""
    return _load(_run_omniidl(list(args or []) + [file]), file)


def importIDLString(text, args=None, inline=1):
    """Compile IDL text and load its stubs. Returns the names of its modules."""
    import tempfile
    with tempfile.NamedTemporaryFile("w", suffix=".idl") as file:
        file.write(text)
        file.flush()
        return _load(_run_omniidl(list(args or []) + [file.name]), "<string>")


def _load(code, file):
    name = _os.path.splitext(_os.path.basename(file))[0].replace("-", "_") + "_idl"
    module = _Module(name)
    module.__dict__["__file__"] = file
    exec(compile(code, file, "exec"), module.__dict__)
    names = tuple(module.__dict__.get("_exported_modules", ()))
    for one in names:
        for each in (one, ".".join([one.split(".")[0] + "__POA"] + one.split(".")[1:])):
            if each not in sys.modules:
                promotePartialModule(each)
    return names


from . import tcInternal  # noqa: E402
from . import CORBA  # noqa: E402
from . import PortableServer  # noqa: E402

# The functions of its libraries are looked up when they are called first.
_flags = sys.getdlopenflags()
sys.setdlopenflags(_flags & ~_os.RTLD_NOW | _os.RTLD_LAZY)
try:
    import _openrtm_core as _core  # noqa: E402
finally:
    sys.setdlopenflags(_flags)

sys.modules.setdefault("CORBA", CORBA)
sys.modules.setdefault("PortableServer", PortableServer)


def cdrMarshal(type_, value, endian=None):
    """The octets of a value. With endian (True: little) raw CDR, without it an encapsulation."""
    return _core.cdr_marshal(tcInternal.descriptor(type_), value, endian)


def cdrUnmarshal(type_, octets, endian=None):
    return _core.cdr_unmarshal(tcInternal.descriptor(type_), octets, endian)


def setClientCallTimeout(*args):
    """Milliseconds that calls of this process may take; with an object, calls of that reference."""
    if len(args) == 2:
        args[0]._obj.set_timeout(int(args[1]))
    else:
        _core.set_call_timeout(int(args[0]))


def setClientConnectTimeout(milliseconds):
    _core.set_connect_timeout(int(milliseconds))


def traceLevel(level=None):
    """How much the ORB logs, 0 to 40. Without an argument the present value."""
    return _core.trace_level(level)


def __getattr__(name):
    if name in ("any", "URI", "minorCodes"):
        return _import("omniORB." + name)
    codes = vars(_import("omniORB.minorCodes"))
    if name in codes and "_" in name.strip("_"):
        return codes[name]
    raise AttributeError("omniORB.%s is not part of this implementation (docs/python-components.md)" % name)
