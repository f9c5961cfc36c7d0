# SDO services of components in Python, and listeners to the manager.
import sys

from component_test import program, python, says, seen, sources, system, written  # noqa: F401: system is a fixture
from system import await_

provider = """
class Mine(OpenRTM_aist.SdoServiceProviderBase, RTC__POA.ExtendedFsmService):
    def get_current_state(self):
        return "of the component"
    def get_fsm_structure(self):
        return RTC.RTC_OK, RTC.FsmStructure("top", "", [], [])
    def finalize(self):
        print("provider ended", flush=True)

class Theirs(OpenRTM_aist.SdoServiceConsumerBase):
    def init(self, rtobj, profile):
        print("consumer of", rtobj.getInstanceName(), profile.id, type(rtobj).__name__, flush=True)
        self._profile = profile
        self._service = OpenRTM_aist.CorbaConsumer(interfaceType=RTC.ExtendedFsmService)
        if not self._service.setObject(profile.service):
            return False
        rtobj.addPostComponentActionListener(OpenRTM_aist.PostComponentActionListenerType.POST_ON_ACTIVATED, self.activated)
        return True
    def activated(self, ec_id, ret):
        print("the tool is in state", self._service._ptr().get_current_state(), flush=True)
    def reinit(self, profile):
        print("the same again", flush=True)
        return True
    def finalize(self):
        print("consumer ended", flush=True)
"""


def test_tools_find_the_sdo_services_of_a_component_and_attach_theirs(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Served", """
    def onInitialize(self):
        factory = OpenRTM_aist.SdoServiceConsumerFactory.instance()
        print("factory", factory.addFactory(RTC.ExtendedFsmService._NP_RepositoryId, Theirs, OpenRTM_aist.Delete),
              factory.addFactory(RTC.ExtendedFsmService._NP_RepositoryId, Theirs, OpenRTM_aist.Delete),
              factory.hasFactory(RTC.ExtendedFsmService._NP_RepositoryId))
        self._mine = Mine()
        profile = SDOPackage.ServiceProfile("mine", RTC.ExtendedFsmService._NP_RepositoryId, [], self._mine._this())
        print("added", self.addSdoServiceProvider(profile, self._mine), self.addSdoServiceProvider(profile, self._mine), flush=True)
        try:
            self.addSdoServiceProvider(SDOPackage.ServiceProfile(7, "", [], None), self._mine)
        except TypeError as problem:
            print("TypeError:", problem)
        return RTC.RTC_OK
""", extra="import RTC__POA\nimport SDOPackage\n" + provider)
    process = program(system, file, folder=tmp_path)
    seen(system, "Served0")
    said = system.call(python, "-B", str(sources / "sdo_client.py"), system.names, "Served0")
    assert "profile mine IDL:omg.org/RTC/ExtendedFsmService:1.0" in said
    assert "state of the component" in said and "same True" in said and "no service of that id" in said
    assert "observer True" in said and "consumer True" in said and "again True" in said and "unknown False" in said
    assert "heard True asked True" in said and "removed True True" in said
    log = says(system, process, "consumer ended")
    assert "factory 0 2 True" in log and "added True False" in log and "TypeError: id: expected string, got int 7" in log
    assert "consumer of Served0 tool Served" in log and "the tool is in state of the tool" in log and "the same again" in log
    process.terminate()
    assert process.wait(60) == 0
    assert "provider ended" in system.log(process)


def test_a_service_that_raises_is_refused_and_the_log_says_why(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Refuser", """
    def onInitialize(self):
        class Bad(OpenRTM_aist.SdoServiceConsumerBase):
            def init(self, rtobj, profile):
                raise ValueError("not mine")
        OpenRTM_aist.SdoServiceConsumerFactory.instance().addFactory("IDL:bad:1.0", Bad, OpenRTM_aist.Delete)
        profile = SDOPackage.ServiceProfile("bad", "IDL:bad:1.0", [], self.getObjRef()._narrow(SDOPackage.SDOService))
        print("bad", self.addSdoServiceConsumer(profile))
        profile.service = Mine()._this()
        print("bad", self.addSdoServiceConsumer(profile), flush=True)
        return RTC.RTC_OK
""", extra="import RTC__POA\nimport SDOPackage\n" + provider)
    process = program(system, file, folder=tmp_path)
    await_("both", lambda: system.log(process).count("bad False") == 2)
    assert "ValueError: not mine" in says(system, process, "init of an SDO service raised")


def test_a_state_machine_shows_its_state_and_tells_its_listeners(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Lamp", """
    def onInitialize(self):
        for name in ("INIT", "ENTRY", "DO", "EXIT", "STATE_CHANGE"):
            for side in ("Pre", "Post"):
                type_ = getattr(getattr(OpenRTM_aist, side + "FsmActionListenerType"), side.upper() + "_ON_" + name)
                getattr(self, "add" + side + "FsmActionListener")(type_, lambda *args, text=side + name: print(text, *args, flush=True))
        self.addFsmProfileListener(OpenRTM_aist.FsmProfileListenerType.BIND_FSM_EVENT, lambda profile: print("bound", profile.name, profile.data_type))
        self.addFsmStructureListener(OpenRTM_aist.FsmStructureListenerType.GET_FSM_STRUCTURE, lambda one: print("asked for", one.name, flush=True))
        self._machine = StaticFSM.Machine(Top, self)
        self._events = OpenRTM_aist.EventPort.EventInPort("event", self._machine)
        self._events.bindEvent1("press", Top.press, RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addInPort("event", self._events)
        return RTC.RTC_OK

    def onActivated(self, ec_id):
        print("--- press", flush=True)
        self._machine.dispatch(StaticFSM.Event(Top.press, 1))
        return RTC.RTC_OK
""", extra="""
from OpenRTM_aist import StaticFSM

@StaticFSM.FSM_TOPSTATE
class Top(StaticFSM.Link):
    def onInit(self):
        self.set_state(StaticFSM.State(Dark))
    def press(self, count):
        pass

@StaticFSM.FSM_SUBSTATE(Top)
class Dark(StaticFSM.Link):
    def press(self, count):
        self.set_state(StaticFSM.State(Bright))

@StaticFSM.FSM_SUBSTATE(Top)
class Bright(StaticFSM.Link):
    def onEntry(self):
        return RTC.RTC_ERROR
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Lamp0")
    ask = ("import sys, OpenRTM_aist, RTC\nfrom omniORB import CORBA\n"
           "rtc = OpenRTM_aist.CorbaNaming(CORBA.ORB_init(), sys.argv[1]).resolve('Lamp0.rtc')._narrow(RTC.RTObject)\n"
           "service = rtc.get_sdo_service(RTC.ExtendedFsmService._NP_RepositoryId)._narrow(RTC.ExtendedFsmService)\n"
           "print(service.get_current_state(), service.get_fsm_structure()[1].event_profiles[0].name)")
    assert system.call(python, "-B", "-c", ask, system.names) == "Dark press\n"
    system.rtse("act", "Lamp0")
    await_("Bright", lambda: system.call(python, "-B", "-c", ask, system.names) == "Bright press\n")
    log = says(system, process, "asked for Top")
    assert "bound press IDL:RTC/TimedLong:1.0" in log
    told = log.split("--- press\n")[1].splitlines()[:11]
    assert told == ["PreDO Dark", "PostDO Dark RTC_OK", "PreSTATE_CHANGE Dark", "PreEXIT Dark", "PostEXIT Dark RTC_OK", "PreENTRY Bright",
                    "PostENTRY Bright RTC_ERROR", "PreINIT Bright", "PostINIT Bright RTC_OK", "PostSTATE_CHANGE Bright RTC_OK", "asked for Top"]


def test_listeners_to_the_manager_hear_modules_components_names_and_the_end(system, tmp_path):  # noqa: F811
    file = written(tmp_path, "Heard", "    pass\n", extra="""
class All:
    def __getattr__(self, event):
        if event.startswith("_") or event == "preReinit":
            raise AttributeError(event)
        return lambda *args: print("event", event, *[getattr(one, "getInstanceName", lambda: one if isinstance(one, (str, list)) else "...")() for one in args], flush=True)

class Bad(OpenRTM_aist.ManagerActionListener):
    def preShutdown(self):
        raise ValueError("not yet")
""")
    text = (tmp_path / file).read_text().replace("    mgr.activateManager()", """    for kind in ("Manager", "Module", "RtcLifecycle", "Naming"):
        getattr(mgr, "add" + kind + "ActionListener")(All())
    gone = All()
    mgr.addManagerActionListener(gone, True)
    mgr.removeManagerActionListener(gone)
    mgr.addManagerActionListener(Bad())
    mgr.activateManager()""")
    (tmp_path / file).write_text(text)
    process = program(system, file, folder=tmp_path)
    seen(system, "Heard0")
    process.terminate()
    assert process.wait(60) == 0
    log = system.log(process)
    events = [line.split()[1:] for line in log.splitlines() if line.startswith("event ")]
    names = [one[0] for one in events]
    assert names.count("preShutdown") == 1
    for name in ("preCreate", "preConfigure", "postConfigure", "preInitialize", "postInitialize", "postCreate", "preBind", "preShutdown"):
        assert name in names, log
    assert ["preCreate", "Heard"] in events and ["postCreate", "Heard0"] in events
    assert "a listener to preShutdown raised" in log and "ValueError: not yet" in log
