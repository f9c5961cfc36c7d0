# The calls of the tools of the OpenRTM world (rtshell, RTSystemEditor), from an ORB and in both byte orders of their languages, against rtcd and the example
# components: classic_tools.py BIN_DIR LIB_DIR SOURCE_DIR [unittest arguments]. What must come back stands in the tests of the same names of calls in C++; here it is
# what a tool looks at on its way.
import os
import re
import socket
import struct
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ports"))
from foreign_test import ForeignPort  # noqa: E402
from giop import Ior, Orb, SystemException  # noqa: E402
from idl_client import Idl, Remote  # noqa: E402
from system import System, await_  # noqa: E402

if __name__ == "__main__":
    bin_dir, lib_dir, source = sys.argv[1:4]
    del sys.argv[1:4]
    idl = Idl(f"{source}/idl", "OpenRTM.idl", "Manager.idl", "ComponentObserver.idl", "Logger.idl", "DataPort_OpenRTM.idl", f"{source}/clients/examples/Echo.idl", f"{source}/tests/ports/naming.idl")


def texts(nvlist):
    return {nv.name: nv.value for nv in nvlist if isinstance(nv.value, str)}


def nvlist(**properties):
    return [idl.struct("SDOPackage::NameValue", name=key, value=value) for key, value in properties.items()]


# Without a simulator, so without a server id.
class Hosts(System):
    def __init__(self):
        self.bin_dir, self.lib_dir, self.server_id, self.servers, self.running = bin_dir, lib_dir, "", set(), []
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.names = f"127.0.0.1:{probe.getsockname()[1]}"
        self.folder = tempfile.TemporaryDirectory()
        self.work = self.folder.name


class Tool(unittest.TestCase):
    order = "<"

    def setUp(self):
        self.system = Hosts()
        self.orb = Orb(2, self.order)
        self.addCleanup(self.system.__exit__, None, None, None)
        self.addCleanup(self.orb.stop)
        self.system.naming()

    # With a port for its manager.
    def host(self, *components, options=()):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        # Its ORB is reached by tcp alone here.
        self.process = self.system.rtcd("-p", str(self.port), *options, *components, cwd=self.system.work)
        for component in components:
            self.find(component.split("?")[0] + "0")
        return self.process

    def at(self, interface, key, port):
        return Remote(idl, self.orb, Ior.make(idl.interface(interface)["id"], "127.0.0.1", int(port), key, 2), interface)

    # rtls: the naming contexts from the root, path -> reference.
    def tree(self):
        found = {}

        def walk(context, path):
            bindings, iterator = context.list(1)
            if iterator:
                more = True
                while more:
                    more, further = iterator.next_n(2)
                    bindings += further
                iterator.destroy()
            for binding in bindings:
                name = binding.binding_name[0]
                place = f"{path}/{name.id}.{name.kind}"
                try:
                    child = context.resolve([name])
                    if binding.binding_type == "ncontext":
                        walk(child.narrow("CosNaming::NamingContext"), place)
                    else:
                        found[place] = child
                except SystemException as problem:
                    if not re.search("NotFound|OBJECT_NOT_EXIST", str(problem)):  # it has gone meanwhile
                        raise

        walk(self.at("CosNaming::NamingContext", b"NameService", self.system.names.split(":")[1]), "")
        return found

    def find(self, name):
        def look():
            for path, reference in self.tree().items():
                if path.endswith(f"/{name}.rtc"):
                    return reference.narrow("RTC::RTObject")
            return None

        return await_(name, look)

    def manager(self):
        return self.at("RTM::Manager", b"manager", self.port)

    def ports(self, component):
        return {port.get_port_profile().name.split(".")[-1]: port for port in component.get_ports()}

    def context(self, component):
        return component.get_owned_contexts()[0].narrow("RTC::ExecutionContextService")

    # rtcon.
    def connect(self, *ports, name="wire", connector_id="", **properties):
        asked = {"dataflow_type": "push", "interface_type": "corba_cdr", "subscription_type": "flush", **properties}
        profile = idl.struct("RTC::ConnectorProfile", name=name, connector_id=connector_id, ports=list(ports),
                             properties=nvlist(**{"dataport." + key.replace("__", "."): value for key, value in asked.items()}))
        return ports[0].connect(profile)

    def raises(self, name, call, *arguments):
        with self.assertRaises(SystemException) as caught:
            call(*arguments)
        self.assertEqual(str(caught.exception), f"IDL:org.omg/SDOPackage/{name}:1.0")


class AsPython(Tool):
    def test_rtls_and_rtcat_find_and_describe_everything(self):
        self.host("SourceAll", "SinkAll")
        tree = self.tree()
        host = os.uname().nodename
        self.assertEqual(sorted(tree), [f"/{host}.host_cxt/SinkAll0.rtc", f"/{host}.host_cxt/SourceAll0.rtc", f"/{host}.host_cxt/manager.mgr"])
        source = tree[f"/{host}.host_cxt/SourceAll0.rtc"]
        self.assertEqual(source.ior.type_id, "IDL:openrtm.aist.go.jp/OpenRTM/DataFlowComponent:1.0")
        for repository_id in idl.all_ids("OpenRTM::DataFlowComponent") | {"IDL:omg.org/CORBA/Object:1.0"}:
            self.assertTrue(source.is_a(repository_id), repository_id)
        self.assertFalse(source.is_a("IDL:omg.org/RTC/PortService:1.0"))
        self.assertFalse(source.is_gone())
        source = source.narrow("RTC::RTObject")

        profile = source.get_component_profile()
        self.assertEqual((profile.instance_name, profile.type_name, profile.vendor, profile.category, profile.version, profile.parent),
                         ("SourceAll0", "SourceAll", "rtm-sim", "example", "1.0.0", None))
        properties = texts(profile.properties)
        for key, value in {"implementation_id": "SourceAll", "language": "C++", "conf.default.start": "1", "conf.__widget__.start": "spin",
                           "instance_name": "SourceAll0", "naming.names": f"{host}.host_cxt/SourceAll0.rtc", "manager.instance_name": "manager",
                           "exec_cxt.periodic.rate": "10", "naming.formats": "%h.host_cxt/%n.rtc", "openrtm.version": properties.get("openrtm.version")}.items():
            self.assertEqual(properties.get(key), value, key)
        self.assertEqual([nv.name for nv in profile.properties][:3], ["implementation_id", "type_name", "description"])
        self.assertEqual([nv.value for nv in profile.properties if not isinstance(nv.value, str)], [])
        self.assertEqual((source.get_sdo_id(), source.get_sdo_type()), ("SourceAll0", profile.description))
        self.assertEqual((source.get_status_list(), source.get_organizations(), source.get_owned_organizations(), source.get_service_profiles()), ([], [], [], []))
        self.raises("InterfaceNotImplemented", source.get_monitoring)
        self.raises("InvalidParameter", source.get_status, "none")
        self.raises("InvalidParameter", source.get_sdo_service, "none")

        # By its key, without a naming service.
        by_key = self.at("RTC::RTObject", b"example.SourceAll0", self.port)
        self.assertEqual(by_key.get_component_profile().instance_name, "SourceAll0")

        self.assertEqual(len(profile.port_profiles), 24)
        self.assertEqual([port.name for port in profile.port_profiles], [port.get_port_profile().name for port in source.get_ports()])
        shown = next(port for port in profile.port_profiles if port.name == "SourceAll0.long")
        self.assertEqual((shown.interfaces, shown.connector_profiles), ([], []))
        self.assertEqual(shown.owner.ior.key(), source.ior.key())
        self.assertEqual(shown.port_ref.get_port_profile().name, "SourceAll0.long")
        # Where the module of ROS 2 is installed, ports offer its transports too.
        transports = ["corba_cdr", "data_service", "direct", "shared_memory"]
        if "ros2" in texts(shown.properties)["dataport.interface_type"].split(","):
            transports += ["cyclone-dds", "fast-rtps", "ros2"]
        options = {"dataport.interface_option." + name: "" for name in transports}
        both = {"dataport.data_type": "IDL:RTC/TimedLong:1.0", "data_type": "IDL:RTC/TimedLong:1.0", "dataport.dataflow_type": "push,pull",
                "dataport.interface_type": ",".join(transports), "dataport.marshaling_types": "cdr", **options}
        kinds = "block,flush,new,nonblock,periodic"
        self.assertEqual(texts(shown.properties), {**both, "port.port_type": "DataOutPort", "dataport.subscription_type": kinds, "dataport.io_mode": kinds})
        inport = self.ports(self.find("SinkAll0"))["long"].get_port_profile()
        self.assertEqual(texts(inport.properties), {**both, "port.port_type": "DataInPort", "dataport.subscription_type": "Any"})

    def test_rtact_rtdeact_and_rtreset_get_the_codes_of_the_table(self):
        self.host("FailOnRequest")
        component = self.find("FailOnRequest0")
        context = self.context(component)
        profile = context.get_profile()
        self.assertEqual((profile.kind, profile.rate, profile.participants), ("PERIODIC", 100.0, []))
        self.assertEqual(profile.owner.ior.key(), component.ior.key())
        self.assertLessEqual({"type": "PeriodicExecutionContext", "rate": "100", "sync_transition": "YES"}.items(), texts(profile.properties).items())
        self.assertEqual((context.get_kind(), context.get_rate(), context.is_running()), ("PERIODIC", 100.0, True))
        self.assertEqual(component.get_participating_contexts(), [])
        self.assertEqual(component.get_context_handle(context), 0)
        self.assertEqual(component.get_context(0).ior.key(), context.ior.key())
        self.assertIsNone(component.get_context(77))
        self.assertTrue(component.is_alive(context))

        self.assertEqual(context.get_component_state(component), "INACTIVE_STATE")
        self.assertEqual(context.deactivate_component(component), "PRECONDITION_NOT_MET")
        self.assertEqual(context.reset_component(component), "PRECONDITION_NOT_MET")
        self.assertEqual(context.activate_component(component), "RTC_OK")
        self.assertEqual(context.get_component_state(component), "ACTIVE_STATE")
        self.assertEqual(context.activate_component(component), "PRECONDITION_NOT_MET")
        self.assertEqual(context.deactivate_component(component), "RTC_OK")
        for call in (context.activate_component, context.deactivate_component, context.reset_component, context.remove_component):
            self.assertEqual(call(None), "BAD_PARAMETER")
        self.assertEqual(context.get_component_state(None), "CREATED_STATE")
        self.assertEqual(context.set_rate(0.0), "BAD_PARAMETER")
        self.assertEqual(context.set_rate(50.0), "RTC_OK")
        self.assertEqual(context.get_profile().rate, 50.0)
        self.assertEqual(context.start(), "PRECONDITION_NOT_MET")
        self.assertEqual(context.stop(), "RTC_OK")
        self.assertEqual(context.stop(), "PRECONDITION_NOT_MET")
        self.assertEqual(context.start(), "RTC_OK")
        self.assertEqual(component.finalize(), "PRECONDITION_NOT_MET")
        self.assertEqual(component.initialize(), "PRECONDITION_NOT_MET")
        self.assertEqual(component.detach_context(0), "BAD_PARAMETER")

        self.configure(component, "default", fail_in="onExecute")
        self.assertIn(context.activate_component(component), ("RTC_OK", "PRECONDITION_NOT_MET"))  # it may have failed before the answer
        await_("the error state", lambda: context.get_component_state(component) == "ERROR_STATE")
        self.assertEqual(context.activate_component(component), "PRECONDITION_NOT_MET")
        self.assertEqual(context.reset_component(component), "RTC_OK")
        self.assertEqual(context.get_component_state(component), "INACTIVE_STATE")

        # rtexit.
        self.assertEqual(component.exit(), "RTC_OK")
        await_("an empty tree", lambda: not any("FailOnRequest0" in path for path in self.tree()))

    # rtconf set: the whole set with the new value, then active.
    def configure(self, component, set_id, **values):
        configuration = component.get_configuration()
        changed = configuration.get_configuration_set(set_id)
        for nv in changed.configuration_data:
            nv.value = values.get(nv.name, nv.value)
        self.assertTrue(configuration.set_configuration_set_values(changed))
        self.assertTrue(configuration.activate_configuration_set(set_id))

    # A member of another context while its own stands: what ls shows is what act and reset mean.
    def test_our_editor_means_the_context_that_it_shows(self):
        self.host("FailOnRequest?exec_cxt.periodic.rate=1000", "SourceAll?exec_cxt.periodic.rate=10")
        member, context = self.find("FailOnRequest0"), self.context(self.find("SourceAll0"))
        self.assertEqual(self.context(member).stop(), "RTC_OK")
        self.assertEqual(context.add_component(member), "RTC_OK")

        def shown():
            return next(line.split() for line in self.system.rtse("ls", "-l", "-R").splitlines() if "FailOnRequest0" in line)

        self.assertEqual(shown()[:3], ["Inactive", "10", "Hz"])
        self.system.rtse("act", "FailOnRequest0")
        self.system.rtse("conf", "FailOnRequest0", "set", "fail_in", "onExecute")
        await_("the error", lambda: shown()[0] == "Error")
        self.system.rtse("reset", "FailOnRequest0")
        self.assertEqual(shown()[0], "Inactive")
        self.assertEqual(context.get_component_state(member), "INACTIVE_STATE")

    def test_rtconf_lists_sets_and_activates(self):
        self.host("ConfigDemo")
        component = self.find("ConfigDemo0")
        configuration = component.get_configuration()
        sets = {one.id: texts(one.configuration_data) for one in configuration.get_configuration_sets()}
        self.assertEqual(list(sets), ["default", "fast", "off", "__widget__", "__constraints__", "__type__"])
        self.assertEqual(sets["fast"], {"count": "10", "gain": "2.0", "mode": "lead", "enabled": "1", "weights": "4,5"})
        self.assertEqual(configuration.get_active_configuration_set().id, "default")
        self.configure(component, "fast", count="11")
        self.assertEqual(configuration.get_active_configuration_set().id, "fast")
        self.assertEqual(texts(configuration.get_configuration_set("fast").configuration_data)["count"], "11")
        self.assertTrue(configuration.set_configuration_set_values(configuration.get_configuration_set("off")))
        self.raises("NotAvailable", configuration.get_active_configuration_set)
        self.assertTrue(configuration.activate_configuration_set("default"))
        self.raises("InvalidParameter", configuration.activate_configuration_set, "none")
        self.raises("InternalError", configuration.get_configuration_set, "none")
        self.assertEqual((configuration.get_configuration_parameters(), configuration.get_configuration_parameter_values()), ([], []))
        self.assertIsNone(configuration.get_configuration_parameter_value("count"))
        self.assertTrue(configuration.set_configuration_parameter("count", "3"))
        mine = idl.struct("SDOPackage::ConfigurationSet", id="mine", description="of a tool", configuration_data=nvlist(count="3"))
        self.assertTrue(configuration.add_configuration_set(mine))
        self.assertEqual(configuration.get_configuration_set("mine").description, "of a tool")
        self.assertTrue(configuration.remove_configuration_set("mine"))
        for kept in ("default", "fast"):
            self.assertFalse(configuration.remove_configuration_set(kept))
        self.assertEqual(len(configuration.get_configuration_sets()), 6)

    def test_rtcon_and_rtdis_leave_the_profiles_that_tools_save(self):
        self.host("SourceAll", "SinkAll")
        source, sink = self.ports(self.find("SourceAll0")), self.ports(self.find("SinkAll0"))
        code, profile = self.connect(source["long"], sink["long"])
        self.assertEqual(code, "RTC_OK")
        self.assertEqual(len(profile.connector_id), 36)
        self.assertEqual([port.ior.key() for port in profile.ports], [source["long"].ior.key(), sink["long"].ior.key()])
        for port in (source["long"], sink["long"]):
            stored, = port.get_connector_profiles()
            self.assertEqual((stored.name, stored.connector_id), ("wire", profile.connector_id))
            values = texts(stored.properties)
            self.assertEqual(values["dataport.serializer.cdr.endian"], "little,big")
            reference = {nv.name: nv.value for nv in stored.properties}["dataport.corba_cdr.inport_ref"]
            self.assertEqual(reference.type_id, "IDL:OpenRTM/InPortCdr:1.0")
            self.assertEqual(Ior.parse(values["dataport.corba_cdr.inport_ior"]).key(), reference.key())
        self.assertEqual(self.connect(source["long"], sink["long"])[0], "PRECONDITION_NOT_MET")
        self.assertEqual(self.connect(source["short"], sink["short"], dataflow_type="")[0], "BAD_PARAMETER")
        self.assertEqual(self.connect(source["short"], sink["short"], interface_type="none")[0], "BAD_PARAMETER")
        self.assertEqual(self.connect(source["short"], sink["short"], marshaling_type="none")[0], "RTC_ERROR")
        self.assertEqual(self.connect(source["short"], sink["short"], serializer__cdr__endian="middle")[0], "UNSUPPORTED")
        self.assertEqual(self.connect(source["short"], sink["short"], subscription_type="periodic")[0], "BAD_PARAMETER")
        self.assertEqual(source["long"].disconnect("none"), "BAD_PARAMETER")
        # rtdis asks any of the two.
        self.assertEqual(sink["long"].disconnect(profile.connector_id), "RTC_OK")
        self.assertEqual((source["long"].get_connector_profiles(), sink["long"].get_connector_profiles()), ([], []))
        self.assertEqual(source["long"].get_connector_profile(profile.connector_id).connector_id, "")

    def test_rtprint_rtinject_and_rtlog_are_ports_of_another_make(self):
        host = self.host("SourceAll", "SinkAll")
        source, sink = self.find("SourceAll0"), self.find("SinkAll0")
        reader, writer = ForeignPort(self.orb, "in"), ForeignPort(self.orb, "out")
        printing = Remote(idl, self.orb, reader.ior, "RTC::PortService")
        injecting = Remote(idl, self.orb, writer.ior, "RTC::PortService")
        self.assertEqual(self.connect(self.ports(source)["long"], printing, subscription_type="new")[0], "RTC_OK")
        self.assertEqual(self.connect(injecting, self.ports(sink)["short"])[0], "RTC_OK")
        for component in (source, sink):
            self.assertEqual(self.context(component).activate_component(component), "RTC_OK")
        await_("three values", lambda: len(reader.received) >= 3)
        self.assertEqual([struct.unpack("<i", octets[8:])[0] for octets in reader.received[:3]], [1, 2, 3])
        self.assertTrue(all(len(octets) == 12 for octets in reader.received))
        self.assertEqual(writer.write(struct.pack("<IIh", 1, 2, -77)), 0)
        await_("the injected value", lambda: "short: -77" in self.system.log(host))
        # The tool is gone without a word; the component goes on and forgets it.
        self.orb.stop()
        self.orb = Orb(2, self.order)
        source, sink = self.find("SourceAll0"), self.find("SinkAll0")
        await_("a component that is rid of them",
               lambda: not self.ports(source)["long"].get_connector_profiles() and not self.ports(sink)["short"].get_connector_profiles())
        self.assertEqual(self.context(source).get_component_state(source), "ACTIVE_STATE")

    def test_rtteardown_and_rtresurrect_bring_back_what_rtcryo_saw(self):
        host = self.host("SourceAll", "SinkAll")
        source, sink = self.find("SourceAll0"), self.find("SinkAll0")
        ends = self.ports(source), self.ports(sink)
        self.assertEqual(self.connect(ends[0]["long"], ends[1]["long"], name="first", connector_id="by hand", subscription_type="new", buffer__length="3")[0], "RTC_OK")
        self.assertEqual(self.connect(ends[0]["double"], ends[1]["double"], name="second", dataflow_type="pull")[0], "RTC_OK")
        self.configure(source, "default", start="100")
        # rtcryo: what is saved is what the profiles say, references included.
        saved = [port.get_connector_profiles()[0] for port in (ends[0]["long"], ends[0]["double"])]
        for port in (*ends[0].values(), *ends[1].values()):
            self.assertEqual(port.disconnect_all(), "RTC_OK")
        self.assertEqual([port.get_connector_profiles() for ports in ends for port in ports.values()], [[]] * 48)
        for _ in range(2):
            for profile in saved:
                code, made = profile.ports[0].connect(profile)
                self.assertEqual(made.connector_id, profile.connector_id)
            self.assertIn(code, ("RTC_OK", "PRECONDITION_NOT_MET"))  # the second time it is there
        self.assertEqual(code, "PRECONDITION_NOT_MET")
        again = ends[1]["long"].get_connector_profiles()[0]
        self.assertEqual((again.name, again.connector_id, texts(again.properties)["dataport.buffer.length"]), ("first", "by hand", "3"))
        # rtstart.
        for component in (sink, source):
            self.assertEqual(self.context(component).activate_component(component), "RTC_OK")
        await_("values on both", lambda: "long: 101" in self.system.log(host) and "double: 10" in self.system.log(host))

    def test_rtmgr_loads_makes_and_deletes(self):
        self.host(options=("-o", "manager.shutdown_on_nortcs:NO"))
        manager = await_("the manager", self.find_manager)
        self.assertIn(manager.ior.key(), [reference.ior.key() for path, reference in self.tree().items() if path.endswith("/manager.mgr")] + [b"manager"])
        self.assertEqual(manager.load_module("ConfigDemo.so", "ConfigDemoInit"), "RTC_OK")
        self.assertEqual([texts(profile.properties)["file_path"].split("/")[-1] for profile in manager.get_loaded_modules()], ["ConfigDemo.so"])
        self.assertIn("ConfigDemo", [texts(profile.properties)["implementation_id"] for profile in manager.get_factory_profiles()])
        self.assertIn("SinkAll", [texts(profile.properties)["implementation_id"] for profile in manager.get_loadable_modules()])
        made = manager.create_component("ConfigDemo?instance_name=Made&conf.default.count=7&exec_cxt.periodic.rate=20")
        self.assertEqual(made.get_component_profile().instance_name, "Made")
        self.assertEqual(self.context(made).get_rate(), 20.0)
        self.assertEqual(texts(made.get_configuration().get_configuration_set("default").configuration_data)["count"], "7")
        self.assertIsNone(manager.create_component("NoSuchType"))
        self.assertEqual([one.instance_name for one in manager.get_component_profiles()], ["Made"])
        for name in ("Made", "example/Made", "*/Made"):
            self.assertEqual([one.ior.key() for one in manager.get_components_by_name(name)], [made.ior.key()])
        self.assertEqual(manager.delete_component("Nobody"), "BAD_PARAMETER")
        self.assertEqual(manager.delete_component("Made"), "RTC_OK")
        await_("no components", lambda: manager.get_components() == [])
        self.assertEqual(texts(manager.get_profile().properties)["instance_name"], "manager")
        self.assertEqual(manager.set_configuration("my.key", "value"), "RTC_OK")
        self.assertEqual(texts(manager.get_configuration())["my.key"], "value")
        self.assertEqual((manager.is_master(), manager.get_slave_managers(), manager.get_service("none")), (False, [], None))
        self.assertEqual((manager.fork(), manager.shutdown()), ("RTC_OK", "RTC_OK"))
        self.assertEqual(self.process.wait(60), 0)
        self.assertEqual(self.tree(), {})

    def find_manager(self):
        try:
            return self.manager().narrow("RTM::Manager")
        except (OSError, SystemException):
            return None

    def test_an_editor_observes_and_logs(self):
        self.host("ConfigDemo")
        component = self.find("ConfigDemo0")
        heard, published = [], []

        def observe(operation, data, _):
            self.assertEqual(operation, "update_status")
            heard.append((idl.read(data, ["name", "OpenRTM::StatusKind"]), data.string()))

        def log(operation, data, _):
            self.assertEqual(operation, "publish")
            published.append(idl.read(data, ["name", "OpenRTM::LogRecord"]))

        configuration = component.get_configuration()

        def add(name, interface, call, **properties):
            service = self.orb.add(interface, call)
            return configuration.add_service_profile(idl.struct("SDOPackage::ServiceProfile", id=name, interface_type=interface, service=service,
                                                                properties=nvlist(**{key.replace("__", "."): value for key, value in properties.items()})))

        self.assertTrue(add("editor", "IDL:OpenRTM/ComponentObserver:1.0", observe, observed_status="ALL", heartbeat__enable="YES", heartbeat__interval="0.1"))
        self.assertTrue(add("log", "IDL:OpenRTM/Logger:1.0", log, logger__log_level="PARANOID"))
        self.assertFalse(add("no", "IDL:omg.org/RTC/PortService:1.0", observe))
        self.assertEqual(self.context(component).activate_component(component), "RTC_OK")
        self.configure(component, "fast")
        wanted = [("HEARTBEAT", ""), ("RTC_STATUS", "ACTIVE:0"), ("CONFIGURATION", "SET_CONFIG_SET: fast"), ("CONFIGURATION", "ACTIVATE_CONFIG_SET: fast")]
        for one in wanted:
            await_(f"{one} among {heard}", lambda: one in heard)
        self.assertEqual(self.context(component).deactivate_component(component), "RTC_OK")
        await_("the end", lambda: ("RTC_STATUS", "INACTIVE:0") in heard)
        self.assertTrue(all(record.loggername and record.time.sec > 0 for record in published))
        self.assertTrue(configuration.remove_service_profile("editor"))
        self.assertFalse(configuration.remove_service_profile("editor"))

    # Both forms of the keys; the object is there while the component is active.
    def test_rtcon_of_service_ports_tells_where_the_service_is(self):
        self.host("EchoProvider", "EchoConsumer")
        provider, consumer = self.find("EchoProvider0"), self.find("EchoConsumer0")
        ends = self.ports(provider)["Echo"], self.ports(consumer)["Echo"]
        described = [(one.instance_name, one.type_name, one.polarity) for end in ends for one in end.get_port_profile().interfaces]
        self.assertEqual(described, [("echo0", "Example::EchoService", "PROVIDED"), ("echo0", "Example::EchoService", "REQUIRED")])
        self.assertEqual(texts(ends[0].get_port_profile().properties), {"port.port_type": "CorbaPort"})
        asked = idl.struct("RTC::ConnectorProfile", name="talk", connector_id="", ports=list(ends), properties=nvlist(**{"port.port_type": "CorbaPort"}))
        code, profile = ends[0].connect(asked)
        self.assertEqual(code, "RTC_OK")
        values = texts(profile.properties)
        keys = ["EchoProvider0.port.Echo.provided.Example::EchoService.echo0", "port.Example::EchoService.echo0"]
        self.assertEqual(sorted(key for key in values if "EchoService" in key), keys)
        self.assertEqual(values[keys[0]], values[keys[1]])
        service = Remote(idl, self.orb, Ior.parse(values[keys[0]]), "Example::EchoService")
        with self.assertRaises(SystemException) as caught:
            service.echo("too early")
        self.assertEqual(str(caught.exception), "IDL:omg.org/CORBA/OBJECT_NOT_EXIST:1.0")
        for component in (provider, consumer):
            self.assertEqual(self.context(component).activate_component(component), "RTC_OK")
        self.assertEqual(service.echo("from a tool"), "from a tool")
        self.assertIn("from a tool", service.history())
        self.assertEqual(ends[1].disconnect(profile.connector_id), "RTC_OK")
        self.assertEqual(ends[0].get_connector_profiles(), [])

    # rtcomp: a composite of two, with ports of theirs.
    def test_rtcomp_makes_and_changes_a_composite(self):
        self.host("SourceAll", "SinkAll")
        whole = self.manager().create_component("PeriodicECSharedComposite?instance_name=Whole&conf.default.members=SourceAll0&exported_ports=SourceAll0.long")
        self.assertEqual(texts(whole.get_component_profile().properties)["category"], "composite.PeriodicECShared")
        organization, = whole.get_owned_organizations()
        self.assertEqual([member.get_sdo_id() for member in organization.get_members()], ["SourceAll0"])
        self.assertEqual(list(self.ports(whole)), ["long"])
        source = self.find("SourceAll0")
        self.assertEqual([one.get_organization_id() for one in source.get_organizations()], [organization.get_organization_id()])
        self.assertEqual(source.get_owned_contexts()[0].is_running(), False)
        self.assertEqual(len(source.get_participating_contexts()), 1)
        self.assertTrue(organization.add_members([self.find("SinkAll0")]))
        self.assertEqual(len(organization.get_members()), 2)
        self.assertTrue(organization.remove_member("SinkAll0"))
        self.assertEqual(self.context(whole).activate_component(whole), "RTC_OK")
        await_("a member that is active", lambda: source.get_participating_contexts()[0].get_component_state(source) == "ACTIVE_STATE")
        self.assertEqual(whole.exit(), "RTC_OK")
        await_("a member with its own context", lambda: source.get_organizations() == [] and source.get_owned_contexts()[0].is_running())


class AsJava(AsPython):
    order = ">"


if __name__ == "__main__":
    unittest.main()
