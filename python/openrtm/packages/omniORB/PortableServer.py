"""The module PortableServer: servants and object adapters."""
from . import CORBA, Enum as _Enum, EnumItem as _EnumItem

THREAD_POLICY_ID, LIFESPAN_POLICY_ID, ID_UNIQUENESS_POLICY_ID, ID_ASSIGNMENT_POLICY_ID = range(16, 20)
IMPLICIT_ACTIVATION_POLICY_ID, SERVANT_RETENTION_POLICY_ID, REQUEST_PROCESSING_POLICY_ID = range(20, 23)

# The enumerations of the policies, in the order of their ids.
_POLICIES = {
    "thread": ("ThreadPolicyValue", "ORB_CTRL_MODEL SINGLE_THREAD_MODEL MAIN_THREAD_MODEL"),
    "lifespan": ("LifespanPolicyValue", "TRANSIENT PERSISTENT"),
    "id_uniqueness": ("IdUniquenessPolicyValue", "UNIQUE_ID MULTIPLE_ID"),
    "id_assignment": ("IdAssignmentPolicyValue", "USER_ID SYSTEM_ID"),
    "implicit_activation": ("ImplicitActivationPolicyValue", "IMPLICIT_ACTIVATION NO_IMPLICIT_ACTIVATION"),
    "servant_retention": ("ServantRetentionPolicyValue", "RETAIN NON_RETAIN"),
    "request_processing": ("RequestProcessingPolicyValue", "USE_ACTIVE_OBJECT_MAP_ONLY USE_DEFAULT_SERVANT USE_SERVANT_MANAGER"),
}
for _name, _words in _POLICIES.values():
    _items = tuple(_EnumItem(word, number) for number, word in enumerate(_words.split()))
    globals()[_name] = _Enum("IDL:omg.org/PortableServer/%s:1.0" % _name, _items)
    globals().update({item._n: item for item in _items})
del _name, _words, _items


class Servant:
    """Base of all skeletons. _rtm_servant is the servant of the ORB; it lives as long as this object or an activation needs it."""
    _omni_op_d = {}

    def _core_servant(self):
        servant = self.__dict__.get("_rtm_servant")
        if servant is None:
            import _openrtm_core
            servant = self.__dict__["_rtm_servant"] = _openrtm_core.Servant(self, self._all_operations(), self._all_ids())
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
        return self._default_POA()._adapter.reference_of(self._core_servant())

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


class Policy:
    """A policy of an object adapter, as its create_..._policy makes it."""

    def __init__(self, policy_type, value):
        self._type, self.value = policy_type, value

    def _get_policy_type(self):
        return self._type

    policy_type = property(_get_policy_type)

    def _get_value(self):
        return self.value

    def copy(self):
        return self

    def destroy(self):
        """Nothing to do: a policy is a value."""


class POAManager:
    """Says what the adapters that share it do with calls."""

    State = _Enum("IDL:omg.org/PortableServer/POAManager/State:1.0",
                  tuple(_EnumItem(word, number) for number, word in enumerate("HOLDING ACTIVE DISCARDING INACTIVE".split())))
    HOLDING, ACTIVE, DISCARDING, INACTIVE = State._items

    class AdapterInactive(CORBA.UserException):
        _NP_RepositoryId = "IDL:omg.org/PortableServer/POAManager/AdapterInactive:2.3"

    def __init__(self, adapter):
        self._adapter = adapter

    def activate(self):
        import _openrtm_core
        _openrtm_core.orb_activate()
        self._adapter.change_manager("activate", False, False)

    def deactivate(self, etherealize_objects=True, wait_for_completion=True):
        self._adapter.change_manager("deactivate", etherealize_objects, wait_for_completion)

    def hold_requests(self, wait_for_completion=False):
        self._adapter.change_manager("hold", False, wait_for_completion)

    def discard_requests(self, wait_for_completion=False):
        self._adapter.change_manager("discard", False, wait_for_completion)

    def get_state(self):
        return self.State._item(self._adapter.manager_state())


class POA:
    """An object adapter. Servants are Python objects derived from a skeleton; a component is one, too, that is active already."""

    def __init__(self, adapter, parent=None):
        self._adapter, self._parent = adapter, parent
        self._the_manager = POAManager(adapter)

    def _get_the_name(self):
        return self._adapter.name()

    the_name = property(_get_the_name)

    def _get_the_parent(self):
        return self._parent

    the_parent = property(_get_the_parent)

    def _get_the_POAManager(self):
        return self._the_manager

    the_POAManager = property(_get_the_POAManager)

    def create_POA(self, adapter_name, manager, policies):
        """A child. With None for the manager it gets one of its own, which waits until it is activated."""
        if manager is not None and not isinstance(manager, POAManager):
            raise CORBA.BAD_PARAM(info="create_POA: expected a POAManager or None, got %r" % (manager,))
        chosen = {}
        for index, one in enumerate(policies or ()):
            # The same one twice is no contradiction.
            if not isinstance(one, Policy) or chosen.setdefault(one._type, one.value) != one.value:
                raise POA.InvalidPolicy(index)
        pairs = [(number, value._v) for number, value in chosen.items()]
        return POA(self._adapter.create(str(adapter_name), manager and manager._adapter, pairs), self)

    def find_POA(self, adapter_name, activate_it):
        return POA(self._adapter.find(adapter_name), self)

    def destroy(self, etherealize_objects, wait_for_completion):
        self._adapter.destroy(etherealize_objects, wait_for_completion)

    def activate_object(self, servant):
        return self._adapter.activate(servant._core_servant())

    def activate_object_with_id(self, oid, servant):
        self._adapter.activate_with_id(_octets(oid), servant._core_servant())

    def deactivate_object(self, oid):
        self._adapter.deactivate(_octets(oid))

    def set_servant(self, servant):
        """The servant of all objects that are not active, of an adapter with USE_DEFAULT_SERVANT."""
        self._adapter.set_servant(servant._core_servant())

    def servant_to_id(self, servant):
        if hasattr(servant, "_core_servant"):
            return self._adapter.servant_to_id(servant._core_servant())
        return self.reference_to_id(servant.getObjRef())

    def servant_to_reference(self, servant):
        return self._adapter.reference_of(servant._core_servant()) if hasattr(servant, "_core_servant") else servant.getObjRef()

    def reference_to_id(self, reference):
        return self._adapter.reference_to_id(reference._obj)

    def id_to_reference(self, oid):
        return self._adapter.id_to_reference(_octets(oid))

    def id_to_servant(self, oid):
        return self.reference_to_servant(self.id_to_reference(oid))

    def create_reference_with_id(self, oid, intf):
        return self._adapter.create_reference_with_id(_octets(oid), intf)

    def reference_to_servant(self, reference):
        servant = reference._obj.local_servant()
        if servant is None:
            raise POA.WrongAdapter()
        return servant


for _name in ("AdapterAlreadyExists AdapterNonExistent InvalidPolicy NoServant ObjectAlreadyActive ObjectNotActive ServantAlreadyActive "
              "ServantNotActive WrongAdapter WrongPolicy").split():
    setattr(POA, _name, type(_name, (CORBA.UserException,), {
        "_NP_RepositoryId": "IDL:omg.org/PortableServer/POA/%s:2.3" % _name, "__module__": "PortableServer"}))


# create_POA's answer to a policy that is none, or contradicts another one; `index` is its place in the list.
def _invalid(self, index=0):
    CORBA.UserException.__init__(self, index)
    self.index = index


POA.InvalidPolicy.__init__ = _invalid


def _policy_maker(number, enum):
    def create(self, value):
        if value not in enum._items:
            raise CORBA.BAD_PARAM(info="expected one of %s, got %r" % (", ".join(item._n for item in enum._items), value))
        return Policy(number, value)
    return create


for _number, _name in enumerate(_POLICIES, THREAD_POLICY_ID):
    setattr(POA, "create_%s_policy" % _name, _policy_maker(_number, globals()[_POLICIES[_name][0]]))
del _name, _number


def _octets(oid):
    return oid.encode("latin-1") if isinstance(oid, str) else bytes(oid)


class Current:
    pass


_root = None


def root_poa():
    import _openrtm_core
    global _root
    if _root is None:
        _openrtm_core.orb_init([])
        _root = POA(_openrtm_core.root_adapter())
    return _root


def __getattr__(name):
    raise AttributeError("PortableServer.%s is not part of this implementation (docs/python-components.md)" % name)
