"""The module PortableServer: servants and the root object adapter."""
import omniORB
from . import CORBA

PERSISTENT, TRANSIENT = "PERSISTENT", "TRANSIENT"


class Servant:
    """Base of all skeletons. _servant is the servant of the ORB; it lives as long as this object or an activation needs it."""
    _omni_op_d = {}

    def _core_servant(self):
        servant = self.__dict__.get("_servant")
        if servant is None:
            import _openrtm_core
            servant = self.__dict__["_servant"] = _openrtm_core.Servant(self, self._all_operations(), self._all_ids())
        return servant

    # Also those of skeletons that omniidl 3 has made, which do not join those of their bases.
    def _all_operations(self):
        operations = {}
        for base in reversed(type(self).__mro__):
            operations.update(vars(base).get("_omni_op_d", {}))
        return operations

    def _all_ids(self):
        ids = []
        for base in type(self).__mro__:
            one = vars(base).get("_NP_RepositoryId")
            if one and one not in ids:
                ids.append(one)
        return ids

    def _this(self):
        return self._core_servant().this()

    def _default_POA(self):
        return root_poa()

    def _add_ref(self):
        pass

    def _remove_ref(self):
        pass

    def _refcount_value(self):
        return 1

    def _non_existent(self):
        return False

    def _is_a(self, repoId):
        return repoId in self._all_ids() or repoId == "IDL:omg.org/CORBA/Object:1.0"


class ServantManager(Servant):
    pass


class POAManager:
    def activate(self):
        import _openrtm_core
        _openrtm_core.poa_activate()

    def deactivate(self, etherealize=True, wait=True):
        pass

    def hold_requests(self, wait=False):
        pass

    def discard_requests(self, wait=False):
        pass


class POA:
    class ServantNotActive(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/ServantNotActive:2.3"

    class ServantAlreadyActive(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/ServantAlreadyActive:2.3"

    class ObjectAlreadyActive(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/ObjectAlreadyActive:2.3"

    class ObjectNotActive(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/ObjectNotActive:2.3"

    class WrongAdapter(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/WrongAdapter:2.3"

    class WrongPolicy(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POA/WrongPolicy:2.3"

    _manager = POAManager()
    the_name = "RootPOA"

    @property
    def the_POAManager(self):
        return self._manager

    def _get_the_POAManager(self):
        return self._manager

    def activate_object(self, servant):
        return servant._core_servant().activate()

    def activate_object_with_id(self, oid, servant):
        servant._core_servant().activate_with_id(bytes(oid, "latin-1") if isinstance(oid, str) else bytes(oid))

    def deactivate_object(self, oid):
        import _openrtm_core
        _openrtm_core.poa_deactivate(bytes(oid))

    def servant_to_id(self, servant):
        return servant._core_servant().activate()

    def servant_to_reference(self, servant):
        return servant._this()

    def id_to_reference(self, oid):
        import _openrtm_core
        return _openrtm_core.poa_id_to_reference(bytes(oid))

    def reference_to_servant(self, reference):
        servant = reference._obj.local_servant()
        if servant is None:
            raise POA.WrongAdapter()
        return servant


class Current:
    pass


_root = POA()


def root_poa():
    import _openrtm_core
    _openrtm_core.orb_init([])
    return _root


def __getattr__(name):
    raise AttributeError("PortableServer.%s is not part of this implementation (docs/python-components.md)" % name)
