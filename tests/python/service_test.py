# Stubs by our back end of omniidl, calls and servants in one process and between two, and service ports.
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent / "scenario"))
from system import System, await_  # noqa: E402

python = "/usr/bin/python3"
build = pathlib.Path(os.environ["PYTHONPATH"].split(os.pathsep)[0])


def omniidl(folder, *words):
    path = os.pathsep.join([str(build / "omniidl_backend"), os.environ["PYTHONPATH"]])
    subprocess.run(["omniidl", "-bpython", *words], cwd=folder, env={**os.environ, "PYTHONPATH": path}, check=True, timeout=60)


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shop")
    for file in (here / "services").iterdir():
        if file.is_file():
            shutil.copy(file, folder)
    omniidl(folder, "Shop.idl")
    sys.path.insert(0, str(folder))
    return folder


@pytest.fixture(scope="module")
def counters(shop):
    from omniORB import CORBA
    orb = CORBA.ORB_init(["test"])
    poa = orb.resolve_initial_references("RootPOA")
    from counter import Counter_i
    import Shop
    servant = Counter_i()
    poa.activate_object(servant)
    poa._get_the_POAManager().activate()
    process = subprocess.Popen([python, "-B", str(shop / "serve.py")], stdout=subprocess.PIPE, text=True)
    remote = orb.string_to_object(process.stdout.readline().strip())
    yield {"here": servant._this()._narrow(Shop.Counter), "there": remote._narrow(Shop.Counter)}
    process.kill()
    process.wait()


@pytest.fixture(params=["here", "there"])
def counter(counters, request):
    return counters[request.param]


def test_results_and_out_arguments_come_as_a_tuple(counter):
    item, left, last = counter.buy("x", 5)
    assert (item.name, item.price, item.paint._n, item.sizes, left, last) == ("x", 1.5, "green", [1, 2, 3], 4, True)
    assert [one.name for one in counter.list()] == ["apple"] * 3


def test_an_exception_of_the_idl_reaches_the_caller(counter):
    import Shop
    with pytest.raises(Shop.Sold) as sold:
        counter.buy("gone", 1)
    assert (sold.value.what, sold.value.left) == ("gone", 3)


@pytest.mark.parametrize("name", ["broken", "nothing"])
def test_any_other_failure_of_a_servant_is_unknown(counter, name):
    from omniORB import CORBA
    with pytest.raises(CORBA.UNKNOWN):
        counter.buy(name, 1)


def test_an_argument_that_does_not_fit_is_named(counter):
    from omniORB import CORBA
    with pytest.raises(CORBA.BAD_PARAM, match="buy: value 2: expected long, got str 'x'"):
        counter.buy("a", "x")


def test_attributes_unions_anys_references_and_wide_text_travel(counter):
    import Shop
    from omniORB import any as any_
    counter.sign = "closed"
    assert counter._get_sign() == "closed"
    assert counter.value(Shop.Price(amount=2.5)).text == "much"
    assert counter.value(Shop.Price(7, True))._v is True
    assert any_.from_any(counter.echo(any_.to_any([1, 2]))) == [1, 2]
    assert counter.wide("w") == "w\u65e5\u672c"
    assert counter.itself()._is_equivalent(counter)
    assert counter.other() is None
    assert counter._is_a("IDL:Shop/Counter:1.0") and not counter._non_existent()


def test_a_dead_process_is_a_system_exception(shop):
    from omniORB import CORBA
    import Shop
    process = subprocess.Popen([python, "-B", str(shop / "serve.py")], stdout=subprocess.PIPE, text=True)
    remote = CORBA.ORB_init().string_to_object(process.stdout.readline().strip())._narrow(Shop.Counter)
    process.kill()
    process.wait()
    with pytest.raises((CORBA.TRANSIENT, CORBA.COMM_FAILURE)):
        remote.list()


# As omniidl 3 wrote them: calls by _omnipy.invoke, lists of methods.
OLD_STUB = '''
import omniORB, _omnipy
from omniORB import CORBA, PortableServer
_0_CORBA = CORBA

_omnipy.checkVersion(3,0, __file__)

__name__ = "OldShop"
_0_OldShop = omniORB.openModule("OldShop", r"OldShop.idl")
_0_OldShop__POA = omniORB.openModule("OldShop__POA", r"OldShop.idl")

_0_OldShop._d_Bell = (omniORB.tcInternal.tv_objref, "IDL:OldShop/Bell:1.0", "Bell")
omniORB.typeMapping["IDL:OldShop/Bell:1.0"] = _0_OldShop._d_Bell
_0_OldShop.Bell = omniORB.newEmptyClass()
class Bell :
    _NP_RepositoryId = _0_OldShop._d_Bell[1]
    def __init__(self, *args, **kw):
        raise RuntimeError("Cannot construct objects of this type.")
    _nil = CORBA.Object._nil
_0_OldShop.Bell = Bell
_0_OldShop._tc_Bell = omniORB.tcInternal.createTypeCode(_0_OldShop._d_Bell)
omniORB.registerType(Bell._NP_RepositoryId, _0_OldShop._d_Bell, _0_OldShop._tc_Bell)
Bell._d_ring = ((omniORB.tcInternal.tv_long, ), (omniORB.tcInternal.tv_long, ), None)

class _objref_Bell (CORBA.Object):
    _NP_RepositoryId = Bell._NP_RepositoryId
    def __init__(self):
        CORBA.Object.__init__(self)
    def ring(self, *args):
        return _omnipy.invoke(self, "ring", _0_OldShop.Bell._d_ring, args)
    __methods__ = ["ring"] + CORBA.Object.__methods__
omniORB.registerObjref(Bell._NP_RepositoryId, _objref_Bell)
_0_OldShop._objref_Bell = _objref_Bell
del Bell, _objref_Bell

__name__ = "OldShop__POA"
class Bell (PortableServer.Servant):
    _NP_RepositoryId = _0_OldShop.Bell._NP_RepositoryId
    _omni_op_d = {"ring": _0_OldShop.Bell._d_ring}
Bell._omni_skeleton = Bell
_0_OldShop__POA.Bell = Bell
del Bell
__name__ = "OldShop_idl"
_exported_modules = ( "OldShop", )
'''


def test_committed_stubs_of_omniidl_3_work(shop):
    (shop / "OldShop_idl.py").write_text(OLD_STUB)
    for name in ("OldShop", "OldShop__POA"):
        (shop / name).mkdir()
        (shop / name / "__init__.py").write_text(f'import omniORB\nomniORB.updateModule("{name}")\nimport OldShop_idl\n')
    import OldShop
    import OldShop__POA
    from omniORB import CORBA

    class Bell_i(OldShop__POA.Bell):
        def ring(self, times):
            return 2 * times

    bell = Bell_i()
    reference = bell._this()
    CORBA.ORB_init().resolve_initial_references("RootPOA").the_POAManager.activate()
    assert reference._narrow(OldShop.Bell).ring(4) == 8


def test_the_example_of_a_servant_imports_and_names_what_to_return(shop):
    omniidl(shop, "-Wbexample", "Shop.idl")
    import Shop_idl_example
    from omniORB import CORBA
    with pytest.raises(CORBA.NO_IMPLEMENT):
        Shop_idl_example.Counter_i().buy("a", 1)
    assert "Must return: result, count, last" in (shop / "Shop_idl_example.py").read_text()


def test_idl_text_is_compiled_at_run_time():
    import omniORB
    assert omniORB.importIDLString("module Later { struct Pair { long a; double b; }; };") == ("Later",)
    import Later
    assert omniORB.cdrMarshal(Later._tc_Pair, Later.Pair(1, 0.0), True) == b"\1" + 15 * b"\0"


def test_a_consumer_of_one_program_calls_the_provider_of_another(shop):
    with System(os.environ["RTMSIM_BIN_DIR"], os.environ["RTMSIM_LIB_DIR"]) as system:
        system.naming()
        options = ["-o", f"corba.nameservers:{system.names}", "-o", "naming.formats:%n.rtc", "-o", "manager.shutdown_auto:NO"]
        system.start(python, "-B", str(shop / "Seller.py"), *options)
        buyer = system.start(python, "-B", str(shop / "Buyer.py"), *options)
        await_("both", lambda: "Seller0" in system.rtse("ls") and "Buyer0" in system.rtse("ls"))
        system.rtse("con", "Buyer0:counter", "Seller0:counter")
        system.rtse("act", "Seller0")
        system.rtse("act", "Buyer0")
        await_("sold out", lambda: "sold out gone 3" in system.log(buyer))
        assert "bought Shop.Item(name='apple', price=1.5, paint=green, sizes=[1, 2, 3]) 4 True" in system.log(buyer)


def test_an_object_adapter_with_policies_has_objects_with_ids_of_the_author(shop):
    from omniORB import CORBA, PortableServer
    import Shop
    from counter import Counter_i
    root = CORBA.ORB_init().resolve_initial_references("RootPOA")
    policies = [root.create_lifespan_policy(PortableServer.PERSISTENT), root.create_id_assignment_policy(PortableServer.USER_ID),
                root.create_implicit_activation_policy(PortableServer.NO_IMPLICIT_ACTIVATION)]
    child = root.create_POA("child", root._get_the_POAManager(), policies)
    child._get_the_POAManager().activate()
    servant = Counter_i()
    child.activate_object_with_id("bell", servant)
    reference = child.id_to_reference("bell")
    assert [item.name for item in reference._narrow(Shop.Counter).list()] == ["apple"] * 3
    assert servant._this()._is_equivalent(reference)
    assert child.reference_to_servant(reference) is servant and child.servant_to_id(servant) == b"bell"
    assert child.the_name == "child" and child._get_the_parent() is root
    poa = PortableServer.POA
    for failing, problem in ((lambda: root.create_POA("child", None, []), poa.AdapterAlreadyExists),
                             (lambda: root.find_POA("nobody", False), poa.AdapterNonExistent),
                             (lambda: child.activate_object(Counter_i()), poa.WrongPolicy),
                             (lambda: child.deactivate_object("nobody"), poa.ObjectNotActive),
                             (lambda: child.activate_object_with_id("bell", Counter_i()), poa.ObjectAlreadyActive)):
        with pytest.raises(problem):
            failing()
    child.destroy(True, True)


def test_policies_that_are_none_or_contradict_are_refused_with_their_place(shop):
    from omniORB import CORBA, PortableServer
    root = CORBA.ORB_init().resolve_initial_references("RootPOA")
    lasting, passing = root.create_lifespan_policy(PortableServer.PERSISTENT), root.create_lifespan_policy(PortableServer.TRANSIENT)
    for policies, place in (([lasting, passing], 1), ([3], 0), ([lasting, None], 1), ([PortableServer.PERSISTENT], 0)):
        with pytest.raises(PortableServer.POA.InvalidPolicy) as caught:
            root.create_POA("odd", None, policies)
        assert caught.value.index == place
    with pytest.raises(CORBA.BAD_PARAM, match="expected one of TRANSIENT, PERSISTENT, got RETAIN"):
        root.create_lifespan_policy(PortableServer.RETAIN)
    with pytest.raises(CORBA.BAD_PARAM, match="expected a POAManager or None, got 7"):
        root.create_POA("odd", 7, [])
    twice = root.create_POA("twice", None, [lasting, root.create_lifespan_policy(PortableServer.PERSISTENT)])
    assert root.find_POA("twice", False).the_name == "twice"
    twice.destroy(True, True)


def test_the_manager_of_an_object_adapter_holds_and_lets_go(shop):
    from omniORB import CORBA, PortableServer
    from counter import Counter_i
    import Shop
    root = CORBA.ORB_init().resolve_initial_references("RootPOA")
    own = root.create_POA("own", None, [])
    servant = Counter_i()
    own.activate_object(servant)
    manager = own.the_POAManager
    assert manager.get_state() == PortableServer.POAManager.HOLDING
    manager.activate()
    assert manager.get_state() == manager.ACTIVE
    assert len(servant._this()._narrow(Shop.Counter).list()) == 3
    manager.discard_requests()
    assert manager.get_state() == manager.DISCARDING
    manager.deactivate()
    assert manager.get_state() == manager.INACTIVE
    own.destroy(True, True)


# The manager of the root POA is not active in this process.
HELD = """
import sys
import Shop, RTC
from omniORB import CORBA
from counter import Counter_i
orb = CORBA.ORB_init(sys.argv)
reference = orb.string_to_object(orb.object_to_string(Counter_i()._this()))
print(reference._narrow(RTC.RTObject), reference._is_a("IDL:Shop/Counter:1.0"), reference._non_existent(), flush=True)
try:
    reference._narrow(Shop.Counter).list()
except CORBA.TIMEOUT as problem:
    print(problem)
"""


def test_calls_of_a_local_servant_wait_for_its_poa_manager_with_a_limit(shop):
    done = subprocess.run([python, "-B", "-c", HELD, "-ORBpoaHoldRequestTimeout", "200"], cwd=shop, timeout=60, capture_output=True, text=True)
    assert done.stdout.splitlines()[0] == "None True False", done
    assert "its POAManager is not active; call its activate()" in done.stdout
    # Without the option the timeout is that of calls to other processes.
    done = subprocess.run([python, "-B", "-c", HELD], cwd=shop, timeout=60, capture_output=True, text=True)
    assert "its POAManager is not active; call its activate()" in done.stdout
