"""The module CORBA of the language mapping, as far as components and scripts use it."""
import sys

import omniORB
from . import tcInternal
from .tcInternal import TCKind, TypeCode
from . import Enum as _Enum, EnumItem as _EnumItem, StructBase as _StructBase

ORB_ID = "omniORB4"
TRUE, FALSE = True, False

for _kind in tcInternal.kinds:
    globals()[_kind._n] = _kind
del _kind

COMPLETED_YES = _EnumItem("COMPLETED_YES", 0)
COMPLETED_NO = _EnumItem("COMPLETED_NO", 1)
COMPLETED_MAYBE = _EnumItem("COMPLETED_MAYBE", 2)
completion_status = _Enum("IDL:omg.org/CORBA/completion_status:1.0", (COMPLETED_YES, COMPLETED_NO, COMPLETED_MAYBE))


class Exception(Exception):  # noqa: A001: the name of the mapping
    pass


class UserException(Exception):
    _NP_RepositoryId = None

    def __init__(self, *args):
        super().__init__(*args)

    def __str__(self):
        return repr(self)

    def __repr__(self):
        descriptor = omniORB.typeMapping.get(self._NP_RepositoryId)
        names = descriptor[4::2] if descriptor else ()
        return "%s(%s)" % (type(self).__name__, ", ".join("%s=%r" % (name, getattr(self, name, None)) for name in names))


class SystemException(Exception):
    def __init__(self, minor=0, completed=COMPLETED_NO, info=None):
        super().__init__(minor, completed)
        self.minor = minor
        self.completed = completed
        self.info = info

    def __str__(self):
        return repr(self)

    def __repr__(self):
        why = self.info or ("0x%x" % self.minor if self.minor > 255 else str(self.minor))
        return "CORBA.%s(%s, CORBA.%s)" % (type(self).__name__, why, self.completed)


_SYSTEM = ("UNKNOWN BAD_PARAM NO_MEMORY IMP_LIMIT COMM_FAILURE INV_OBJREF OBJECT_NOT_EXIST NO_PERMISSION INTERNAL MARSHAL INITIALIZE "
           "NO_IMPLEMENT BAD_TYPECODE BAD_OPERATION NO_RESOURCES NO_RESPONSE PERSIST_STORE BAD_INV_ORDER TRANSIENT FREE_MEM INV_IDENT "
           "INV_FLAG INTF_REPOS BAD_CONTEXT OBJ_ADAPTER DATA_CONVERSION INV_POLICY REBIND TIMEOUT TRANSACTION_UNAVAILABLE "
           "TRANSACTION_MODE TRANSACTION_REQUIRED TRANSACTION_ROLLEDBACK INVALID_TRANSACTION CODESET_INCOMPATIBLE BAD_QOS "
           "INVALID_ACTIVITY ACTIVITY_COMPLETED ACTIVITY_REQUIRED").split()
for _name in _SYSTEM:
    globals()[_name] = type(_name, (SystemException,), {"_NP_RepositoryId": "IDL:omg.org/CORBA/%s:1.0" % _name, "__module__": "CORBA"})
del _name


def id(obj):  # noqa: A001: the name of the mapping
    """The repository id of a class of stubs or of a value or exception of one."""
    repository_id = getattr(obj, "_NP_RepositoryId", None)
    if not repository_id:
        raise BAD_PARAM()  # noqa: F821: made above
    return repository_id


class _BadKind(UserException):
    _NP_RepositoryId = "IDL:omg.org/CORBA/TypeCode/BadKind:1.0"


class _Bounds(UserException):
    _NP_RepositoryId = "IDL:omg.org/CORBA/TypeCode/Bounds:1.0"


TypeCode.BadKind = _BadKind
TypeCode.Bounds = _Bounds


class Object:
    """A reference. Stubs derive from it; _obj is the reference of the ORB."""
    _NP_RepositoryId = "IDL:omg.org/CORBA/Object:1.0"
    _nil = None
    __methods__ = []  # of the stubs of omniidl 3

    def __init__(self, obj=None):
        if obj is not None:
            self._obj = obj

    def _is_a(self, repoId):
        return self._obj.is_a(repoId)

    def _non_existent(self):
        return self._obj.non_existent()

    def _is_equivalent(self, other):
        return other is not None and self._obj.is_equivalent(other._obj)

    def _hash(self, maximum):
        return self._obj.hash(maximum)

    def _duplicate(self, other=None):
        return other if other is not None else self

    def _release(self):
        pass

    def _repository_id(self):
        return self._obj.repository_id()

    def _narrow(self, dest):
        """The reference as one of that interface; None if the object has another one."""
        stub = omniORB.objrefMapping.get(dest._NP_RepositoryId)
        if stub is None:
            raise TypeError("%r is no interface" % dest)
        if isinstance(self, stub):
            return self
        return self._as(stub) if self._obj.is_a(dest._NP_RepositoryId) else None

    def _unchecked_narrow(self, dest):
        return self._as(omniORB.objrefMapping[dest._NP_RepositoryId])

    # The stubs of omniidl 3 take no argument.
    def _as(self, stub):
        made = stub.__new__(stub)
        made._obj = self._obj
        return made

    def __eq__(self, other):
        return isinstance(other, Object) and self._obj.is_equivalent(other._obj)

    def __hash__(self):
        return self._obj.hash(0x7fffffff)

    def __repr__(self):
        return "<reference of %s>" % self._obj.repository_id()


_d_Object = (tcInternal.tv_objref, "IDL:omg.org/CORBA/Object:1.0", "Object")
omniORB.typeMapping["IDL:omg.org/CORBA/Object:1.0"] = _d_Object
omniORB.objrefMapping["IDL:omg.org/CORBA/Object:1.0"] = Object
omniORB.objrefMapping[""] = Object
_tc_Object = TC_Object = TypeCode(_d_Object)


class Any:
    def __init__(self, typecode, value):
        self._t = typecode if isinstance(typecode, TypeCode) else TypeCode(typecode)
        self._v = value

    def typecode(self):
        return self._t

    def value(self, coerce=None):
        return self._v

    def __repr__(self):
        return "CORBA.Any(%r, %r)" % (self._t, self._v)


for _name in ("null void short long ushort ulong float double boolean char octet any TypeCode longlong ulonglong longdouble wchar").split():
    globals()["TC_" + _name] = globals()["_tc_" + _name] = TypeCode(getattr(tcInternal, "tv_" + _name))
TC_string = _tc_string = TypeCode((tcInternal.tv_string, 0))
TC_wstring = _tc_wstring = TypeCode((tcInternal.tv_wstring, 0))
del _name


def is_nil(object_):
    if object_ is None:
        return True
    if isinstance(object_, Object):
        return False
    raise BAD_PARAM(0, COMPLETED_NO)  # noqa: F821: made above


class ORB:
    """The ORB of the process: that of the manager, or one that ORB_init has made."""

    class InvalidName(UserException):
        _NP_RepositoryId = "IDL:omg.org/CORBA/ORB/InvalidName:1.0"

    def string_to_object(self, text):
        import _openrtm_core
        return _openrtm_core.string_to_object(text)

    def object_to_string(self, object_):
        import _openrtm_core
        return _openrtm_core.object_to_string(None if object_ is None else object_._obj)

    def resolve_initial_references(self, name):
        import _openrtm_core
        if name in ("RootPOA", "omniINSPOA"):
            from . import PortableServer
            return PortableServer.root_poa()
        if name == "POACurrent":
            from . import PortableServer
            return PortableServer.Current()
        return _openrtm_core.resolve_initial_references(name)

    def list_initial_services(self):
        return ["RootPOA", "NameService"]

    def register_initial_reference(self, name, object_):
        raise NO_IMPLEMENT(0, COMPLETED_NO)  # noqa: F821

    def run(self):
        import _openrtm_core
        _openrtm_core.orb_run()

    def shutdown(self, wait_for_completion=True):
        import _openrtm_core
        _openrtm_core.orb_shutdown()

    def destroy(self):
        self.shutdown()

    def work_pending(self):
        return False

    def perform_work(self):
        pass

    def create_policy(self, type_, value):
        from . import PortableServer
        return PortableServer.Policy(type_, value)

    def create_sequence_tc(self, bound, element):
        return TypeCode((tcInternal.tv_sequence, element._d, bound))

    def create_string_tc(self, bound):
        return TypeCode((tcInternal.tv_string, bound))


_orb = ORB()


def ORB_init(argv=None, orb_id=None, **keywords):
    """The ORB of this process; the -ORB options are taken out of argv."""
    import _openrtm_core
    if argv is None:
        argv = []
    argv[:] = _openrtm_core.orb_init([str(word) for word in argv])
    return _orb


def __getattr__(name):
    raise AttributeError("CORBA.%s is not part of this implementation (docs/python-components.md)" % name)
