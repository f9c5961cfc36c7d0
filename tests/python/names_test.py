# Small helpers of the flat namespace, in the forms of 1.x and 2.x.
import importlib
import io
import subprocess
import sys
import threading

import OpenRTM_aist
import pytest
import RTC


def test_texts_are_changed_in_a_list_of_one_as_in_1_x_and_returned_as_in_2_x():
    for name, before, after in (("eraseBlank", " a b\t", "ab"), ("eraseHeadBlank", " a ", "a "), ("eraseTailBlank", " a ", " a"),
                                ("normalize", " AbC ", "abc"), ("eraseBothEndsBlank", " a ", "a")):
        text = [before]
        getattr(OpenRTM_aist, name)(text)
        assert text == [after]
        assert getattr(OpenRTM_aist, name)(before) == after
    text = ["a-b"]
    OpenRTM_aist.replaceString(text, "-", "+")
    assert text == ["a+b"]


def test_a_word_that_is_neither_yes_nor_no_is_the_default():
    assert OpenRTM_aist.toBool("maybe", "YES", "NO") is True
    assert OpenRTM_aist.toBool("maybe", "YES", "NO", False) is False
    assert OpenRTM_aist.toBool("no", "YES", "NO") is False


def test_times_have_differences():
    first = OpenRTM_aist.Time()
    later = OpenRTM_aist.Time(first.sec + 2, first.usec)
    assert (later - first).getTime().toDouble() == 2
    assert (first - later).getTime().toDouble() == -2


@pytest.mark.parametrize("given, expected", [((1, 2500000), (3, 500000)), ((1, -500000), (0, 500000)), ((-1, 500000), (0, -500000)),
                                             ((0, -2500000), (-2, -500000)), ((-0.5,), (0, -500000)), ((1.75,), (1, 750000)),
                                             ((1, -1000000), (0, 0)), ((None, 1500000), (1, 500000)), ((), (0, 0))])
def test_seconds_and_microseconds_of_a_time_have_one_sign(given, expected):
    made = OpenRTM_aist.TimeValue(*given)
    assert (made.sec(), made.usec()) == expected
    if len(given) == 2:
        made.tv_sec, made.tv_usec = given[0] or 0, given[1]
        made.normalize()
        assert (made.tv_sec, made.tv_usec) == expected
    assert made.sign() == (expected > (0, 0)) - (expected < (0, 0))


def test_a_timer_calls_its_listeners_until_they_are_taken_away():
    called = threading.Semaphore(0)
    timer = OpenRTM_aist.Timer(OpenRTM_aist.TimeValue(0, 1000))
    one = timer.registerListenerFunc(called.release, OpenRTM_aist.TimeValue(0, 1000))
    timer.start()
    for _ in range(3):
        assert called.acquire(timeout=30)
    assert timer.unregisterListener(one)
    assert not timer.unregisterListener(one)
    timer.stop()


def test_a_periodic_task_that_is_suspended_is_called_by_a_signal():
    called = threading.Semaphore(0)
    task = OpenRTM_aist.PeriodicTask()
    task.setTask(called.release)
    task.setPeriod(1000)
    task.suspend()
    task.activate()
    task.signal()
    assert called.acquire(timeout=30)
    task.finalize()


def test_a_periodic_task_measures_its_calls_and_the_time_between_them():
    called = threading.Semaphore(0)
    task = OpenRTM_aist.PeriodicTask()
    task.setTask(called.release)
    task.suspend()
    for stat in (task.getExecStat(), task.getPeriodStat()):
        assert (stat._max_interval, stat._min_interval, stat._mean_interval, stat._std_deviation) == (0, 0, 0, 0)

    def three_calls():
        task.activate()
        for _ in range(3):
            task.signal()
            assert called.acquire(timeout=30)
        task.finalize()

    three_calls()
    for stat in (task.getExecStat(), task.getPeriodStat()):
        assert 0 <= stat._min_interval <= stat._mean_interval <= stat._max_interval > 0
    task.executionMeasure(False)
    task.periodicMeasure(False)
    task.executionMeasureCount(1)
    task.periodicMeasureCount(0)
    three_calls()
    assert task.getExecStat()._max_interval == task.getPeriodStat()._max_interval == 0
    task.executionMeasure(True)
    task.periodicMeasure(True)
    three_calls()
    for stat in (task.getExecStat(), task.getPeriodStat()):
        assert stat._min_interval == stat._max_interval > 0, "one length is kept"


# In a process with a manager: the object is asked, so its adapter must serve.
def manager_script(text, *options):
    script = "import sys, OpenRTM_aist, RTC__POA\nmanager = OpenRTM_aist.Manager.init(sys.argv)\nmanager.activateManager()\n" + text
    return subprocess.run([sys.executable, "-c", script, "-o", "naming.enable:NO", "-o", "manager.instance_name:mine", "-o", "logger.enable:NO", *options],
                          capture_output=True, text=True, timeout=120)


def test_the_kind_of_a_component_is_asked_by_its_reference():
    ran = manager_script("""from OpenRTM_aist import RTCUtil
kinds = ("DataFlowComponent", "FsmParticipant", "FsmObject", "MultiModeObject")
for kind in kinds:
    servant = type("Servant", (getattr(RTC__POA, kind),), {})()
    asked = [getattr(OpenRTM_aist, "is" + one) for one in kinds]
    assert asked == [getattr(RTCUtil, "is" + one) for one in kinds]
    print(kind, *[one for one, is_kind in zip(kinds, asked) if is_kind(servant._this())], any(is_kind(None) for is_kind in asked))
""")
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines() == ["%s %s False" % (one, one) for one in ("DataFlowComponent", "FsmParticipant", "FsmObject", "MultiModeObject")]


@pytest.mark.parametrize("options, text", [
    ([], "servant = manager.getManagerServant(); profile = servant.get_profile(); print('is', servant.getObjRef()._is_equivalent("
         "manager.getORB().string_to_object(manager.getORB().object_to_string(servant.getObjRef()))), servant.get_components())\n"
         "print([one.value.value() for one in profile.properties if one.name == 'instance_name'])\n"
         "print(servant.create_component('None'), hasattr(servant, 'no_such_operation'))\n"
         "manager.shutdown(); print('after', manager.getManagerServant())"),
    (["-o", "manager.corba_servant:NO"], "print('none', manager.getManagerServant())")], ids=["with", "without"])
def test_the_manager_has_its_own_corba_object(options, text):
    ran = manager_script(text, *options)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout == ("none None\n" if options else "is True []\n['mine']\nNone False\nafter None\n"), ran.stdout + ran.stderr


def test_functions_of_references_are_in_the_flat_namespace_too():
    assert OpenRTM_aist.connect is OpenRTM_aist.CORBA_RTCUtil.connect
    assert OpenRTM_aist.Guard.ScopedLock is OpenRTM_aist.ScopedLock
    assert OpenRTM_aist.toTypename(RTC.TimedLong(RTC.Time(0, 0), 0)) == "IDL:RTC/TimedLong:1.0"


def test_files_of_the_original_are_found_by_their_names():
    from OpenRTM_aist import CorbaConsumer, CorbaNaming, RTObject, SystemLogger  # noqa: F401
    import OpenRTM_aist.RTM_IDL  # noqa: F401
    assert RTObject.RTObject_impl is OpenRTM_aist.RTObject_impl and SystemLogger.Logger is OpenRTM_aist.Logger
    names = {}
    exec("from CorbaNaming import *", names)
    assert names["CorbaNaming"] is CorbaNaming and names["CosNaming"].nobject and names["CORBA"].ORB_init and names["sys"]


def test_lists_of_names_and_values_become_properties():
    properties = OpenRTM_aist.NVUtil.toProperties([OpenRTM_aist.NVUtil.newNV("a.b", "c"), OpenRTM_aist.NVUtil.newNV("n", 3)])
    assert properties.getProperty("a.b") == "c" and properties.getProperty("n") == "3"


def test_a_name_that_is_missing_says_where_the_names_are():
    with pytest.raises(AttributeError, match="OpenRTM_aist.InPortPushConnector is not part of this implementation"):
        OpenRTM_aist.InPortPushConnector


def test_a_star_import_brings_what_is_loaded_later_too():
    names = {}
    exec("from OpenRTM_aist import *", names)
    for name in ("DataFlowComponentBase", "CorbaNaming", "StaticFSM", "CSPInPort", "PeriodicECSharedComposite", "newNV", "get_state", "EventInPort"):
        assert name in names, name


# A stub file is loaded when a name or a type of it is used. Each text runs in a new interpreter.
@pytest.mark.parametrize("text", [
    "RTC.RTC_OK; assert 'ExtendedDataTypes_idl' not in sys.modules; RTC._d_TimedVelocity2D, RTC._tc_TimedPose2D",
    "from RTC import *; TimedLong, TimedPose2D, CameraImage, RTC_OK, ActArrayGeometry",
    "assert 'TimedPose2D' in dir(RTC) and not hasattr(RTC, 'TimedPose4D')",
    "assert omniORB.findType('IDL:RTC/CameraImage:1.0')[3] == 'CameraImage' and omniORB.findType('IDL:RTC/None:1.0') is None",
    "assert omniORB.tcInternal.TypeCode('IDL:RTC/TimedPose2D:1.0').name() == 'TimedPose2D'",
    "import RTC__POA; RTC__POA.DataFlowComponent._omni_op_d['initialize']",
    "import threading; found = []; go = threading.Barrier(8)\n"
    "def use(): go.wait(); found.append(RTC.TimedVelocity2D)\n"
    "threads = [threading.Thread(target=use) for _ in range(8)]\n"
    "for one in threads: one.start()\n"
    "for one in threads: one.join(60)\n"
    "assert len(found) == 8 and len(set(found)) == 1"])
def test_types_are_there_when_they_are_used(text):
    done = subprocess.run([sys.executable, "-c", "import sys, omniORB, OpenRTM_aist, RTC\n"
                           "assert not [one for one in sys.modules if one.endswith('_idl')]\n" + text],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_an_attribute_of_an_author_hides_none_of_the_base():
    class Odd(OpenRTM_aist.Task):
        def __init__(self):
            self._thread = self._running = self._run = self._function = 7
            self.called = threading.Semaphore(0)

        def svc(self):
            self.called.release()
            return 0

    task = Odd()
    task.activate()
    assert task.called.acquire(timeout=30)
    task.wait()
    own = {name for name in vars(OpenRTM_aist.DataFlowComponentBase) if name.startswith("_") and not name.startswith("__")}
    known = {"_configsets", "_this", "_SdoConfigImpl", "_profile", "_properties", "_objref", "_orb", "_poa", "_default_POA"}
    assert {name for name in own if not name.startswith("_rtm_")} == known


def test_the_names_of_minor_codes_are_those_of_the_orb():
    import omniORB
    from omniORB.minorCodes import TRANSIENT_ConnectFailed
    assert TRANSIENT_ConnectFailed == omniORB.TRANSIENT_ConnectFailed == 0x41540002
    with pytest.raises(AttributeError):
        omniORB.TRANSIENT_NoSuchCode


def test_corba_id_is_the_repository_id_of_a_class_or_a_value():
    from omniORB import CORBA
    for one in (RTC.TimedLong, RTC.TimedLong(RTC.Time(0, 0), 0)):
        assert CORBA.TypeCode(CORBA.id(one)).name() == "TimedLong"
    assert CORBA.id(RTC.RTObject) == "IDL:omg.org/RTC/RTObject:1.0" and CORBA.id(CORBA.TRANSIENT()) == "IDL:omg.org/CORBA/TRANSIENT:1.0"
    for wrong in (3, "text", object):
        with pytest.raises(CORBA.BAD_PARAM):
            CORBA.id(wrong)


@pytest.mark.parametrize("name", ["select", "_wait"])
def test_no_wait_of_a_manager_of_csp_ports_is_without_end(name):
    with pytest.raises(TypeError):
        getattr(OpenRTM_aist.CSPManager(), name)(None)


def test_properties_have_the_attributes_and_the_forms_of_the_original():
    text = io.StringIO("a.b: 1\n# c\n\nlong : x, \\\n  y\n! d\nc.d = 2")
    properties = OpenRTM_aist.Properties()
    properties.load(text)
    properties.setDefault("e", "3")
    assert [properties.getProperty(one) for one in ("a.b", "long", "c.d", "e")] == ["1", "x, y", "2", "3"]
    node = properties.getNode("a").leaf[0]
    assert (node.name, node.value, node.default_value, node.root.name, properties.root) == ("b", "1", "", "a", None)
    assert node.getRoot().getName() == "a" and properties.getRoot() is None
    properties.setProperty("e")
    assert properties.getNode("e").value == "3", "the default has become the value"
    shown = io.StringIO()
    properties.list(shown)
    assert shown.getvalue() == str(properties)


def test_parameters_of_a_url_come_after_its_question_mark():
    for text in ("X?a=1&b=2&c", "a=1&b=2&c"):
        assert OpenRTM_aist.urlparam2map(text) == {"a": "1", "b": "2", "c": ""}


def test_a_time_stamp_that_is_none_is_made():
    datum = RTC.TimedLong(*[None] * int((len(RTC._d_TimedLong) - 4) / 2))
    OpenRTM_aist.setTimestamp(datum)
    assert datum.tm.sec > 0


def test_files_of_the_original_are_imported_by_their_names():
    code = """
import OpenRTM_aist.Manager, OpenRTM_aist.NVUtil
from OpenRTM_aist.CorbaNaming import *
from OpenRTM_aist.DataFlowComponentBase import DataFlowComponentBase as Base
import CosNaming as same
assert CosNaming is same and CosNaming.nobject and CORBA.ORB_init
assert Base is OpenRTM_aist.DataFlowComponentBase and isinstance(OpenRTM_aist.Manager, type)
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
    for name in ("OpenRTM_aist.NoSuchFile", "OpenRTM_aist.RTC.X"):
        with pytest.raises(ImportError):
            importlib.import_module(name)
