#!/usr/bin/env python3
"""A component of another make, in a process of its own: an ORB and contexts that share no line with the product (../ports/giop.py). It
behaves as those of OpenRTM-aist do towards contexts of others, and knows nothing of simulated time.

    foreign_component.py NAME [--names HOST:PORT] [--source] [--journal FILE] [--fault KIND@N] [--context periodic|triggered|logical|lazy|afterwards] [--clock PERIOD]
                         [--late MS@N] [--race clock|thread] [--attach-late MS] [--activate-late MS] [--die attach|activate] [--throw-at N] [--stop-at N]

It is bound as NAME.rtc in the root of the naming service. InPort `in` and OutPort `out` carry RTC::TimedLong: with --source it counts its
calls, else it sends on what came, plus one. --fault: in its Nth on_execute it sleeps so many ms ("300@5"; "300@*" in each), or does what the
word says: fail, throw, raise (with a traceback), stop (by SIGSTOP), die, hang, or meet: it waits until as many components have done so as the files of that name tell ("meet/PATH@5"). The
journal gets a line "callback handle value" for each call, and "tick seconds value" for each tick of its own context, when that is one that is
ticked; `afterwards`: one that is ticked, and calls the component on a thread of its own. --late: it answers so many ms after it
has got its Nth sample; --attach-late, --activate-late: so many after it was asked to join a context, or to
be active; --die: when it is asked. --throw-at, --stop-at: it throws, or is stopped by SIGSTOP, when it
gets its Nth sample. --race: what it sends depends on the clock of the machine, or it sends on a thread
of its own, some time later. --clock: it subscribes that to the ClockGenerator, with its period in seconds, and unsubscribes at the end.
"""
import argparse
import os
import signal
import struct
import sys
import threading
import time
import traceback

source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, f"{source}/tests/ports")
from foreign_test import ForeignPort, PORT_OK  # noqa: E402
from giop import Ior, Orb, SystemException  # noqa: E402
from idl_client import Idl, Remote, Servant  # noqa: E402

first_other_handle = 1000  # of contexts of others


def strings(idl, **properties):
    return [idl.struct("SDOPackage::NameValue", name=key.replace("__", "."), value=value) for key, value in properties.items()]


class Port(ForeignPort):
    def __init__(self, idl, orb, side, name, owner):
        super().__init__(orb, side)
        self.idl, self.name, self.owner, self.count = idl, name, owner, 0

    def profile(self):
        kind = "DataInPort" if self.side == "in" else "DataOutPort"
        return self.idl.struct("RTC::PortProfile", name=f"{self.owner.name}.{self.name}", interfaces=[], port_ref=self.ior, connector_profiles=[], owner=None,
                               properties=strings(self.idl, port__port_type=kind, dataport__data_type="IDL:RTC/TimedLong:1.0", dataport__interface_type="corba_cdr",
                                                  dataport__dataflow_type="push", dataport__subscription_type="flush,new"))

    # A sample.
    def serve(self, operation, data, out):
        super().serve(operation, data, out)
        if self.owner.options.throw_at == self.count + 1:
            self.count += 1
            raise SystemException("UNKNOWN")
        if self.owner.options.stop_at == self.count + 1:
            self.count += 1
            os.kill(os.getpid(), signal.SIGSTOP)
        late, _, at = self.owner.options.late.partition("@")
        self.count += 1
        if at == str(self.count):
            time.sleep(float(late) / 1000)

    def call(self, operation, data, out):
        if operation == "get_port_profile":
            self.idl.write(out, ["name", "RTC::PortProfile"], self.profile())
        else:
            super().call(operation, data, out)

    # To everybody who is connected; where the connection asks for `new` on a thread, some time later.
    def send(self, octets):
        for connector, (target, names) in list(self.targets.items()):
            if self.find(connector).get("dataport.subscription_type") == "new":
                threading.Timer(0.005, self.send_to, [target, names, octets]).start()
            else:
                self.send_to(target, names, octets)

    def send_to(self, target, names, octets):
        assert self.orb.invoke(target, names[2], lambda out: out.octets(octets)).ulong() == PORT_OK


# The component's own context: as each component has one. A thread calls the component while it is active here.
class OwnContext:
    kind = "PeriodicExecutionContext"
    interface = "RTC::ExecutionContextService"

    def __init__(self, idl, orb, component, rate):
        self.idl, self.component, self.rate, self.state = idl, component, rate, "INACTIVE_STATE"
        self.servant = Servant(idl, orb, self.interface, self)
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            time.sleep(1 / self.rate)
            if self.state == "ACTIVE_STATE":
                self.cycle()

    def cycle(self):
        self.component.on_execute(0)
        self.component.on_state_update(0)

    def is_running(self):
        return True

    def get_rate(self):
        return self.rate

    def get_kind(self):
        return "PERIODIC"

    def get_component_state(self, component):
        return self.state

    def activate_component(self, component):
        if self.state != "INACTIVE_STATE":
            return "PRECONDITION_NOT_MET"
        self.component.on_activated(0)
        self.state = "ACTIVE_STATE"
        return "RTC_OK"

    def deactivate_component(self, component):
        if self.state != "ACTIVE_STATE":
            return "PRECONDITION_NOT_MET"
        self.state = "INACTIVE_STATE"
        self.component.on_deactivated(0)
        return "RTC_OK"

    def get_profile(self):
        return self.idl.struct("RTC::ExecutionContextProfile", kind="PERIODIC", rate=self.rate, owner=self.component.servant.ior, participants=[],
                               properties=strings(self.idl, type=self.kind, name="own"))


# Ticked from outside: each cycle runs in the call, as with SynchExtTriggerEC.
class TriggeredContext(OwnContext):
    interface = "OpenRTM::ExtTrigExecutionContextService"

    def run(self):
        pass

    def tick(self, *time_of_day):
        seconds = time_of_day[0] + time_of_day[1] * 1e-6 if time_of_day else -1
        self.component.note("tick", f"{seconds:.6f}")
        if self.state == "ACTIVE_STATE":
            self.cycle()


# As with OpenRTM-aist, a transition is made in a tick; who asks waits half a second for it.
class LazyContext(TriggeredContext):
    wanted = None

    def deactivate_component(self, component):
        if self.state != "ACTIVE_STATE":
            return "PRECONDITION_NOT_MET"
        self.wanted = threading.Event()
        return "RTC_OK" if self.wanted.wait(0.5) else "RTC_ERROR"

    def tick(self):
        if self.wanted:
            super().deactivate_component(None)
            self.wanted.set()
        super().tick()


# As OpenRTM-aist's ExtTrigExecutionContext.
class AfterwardsContext(TriggeredContext):
    kind = "ExtTrigExecutionContext"

    def tick(self):
        threading.Thread(target=super().tick, daemon=True).start()


class LogicalContext(TriggeredContext):
    interface = "OpenRTM::LogicalTimeTriggeredEC"


class Component:
    def __init__(self, idl, orb, options):
        self.idl, self.orb, self.options, self.name = idl, orb, options, options.name
        self.calls, self.value = 0, 0
        self.others = []  # contexts of others
        self.journal = open(options.journal, "a", buffering=1) if options.journal else None
        self.into, self.out = Port(idl, orb, "in", "in", self), Port(idl, orb, "out", "out", self)
        self.servant = Servant(idl, orb, "OpenRTM::DataFlowComponent", self)
        self.own = {"periodic": OwnContext, "triggered": TriggeredContext, "logical": LogicalContext, "lazy": LazyContext, "afterwards": AfterwardsContext}[options.context](idl, orb, self, 20.0)

    def note(self, callback, handle):
        if self.journal:
            self.journal.write(f"{callback} {handle} {self.value}\n")
        return "RTC_OK"

    # What contexts call.
    def on_startup(self, handle):
        return self.note("on_startup", handle)

    def on_shutdown(self, handle):
        return self.note("on_shutdown", handle)

    def on_activated(self, handle):
        if self.options.die == "activate":
            os.kill(os.getpid(), signal.SIGKILL)
        if self.options.activate_late:
            self.note("asked", handle)
            time.sleep(self.options.activate_late / 1000)
        self.calls = self.value = 0
        self.into.received.clear()
        return self.note("on_activated", handle)

    def on_deactivated(self, handle):
        return self.note("on_deactivated", handle)

    def on_aborting(self, handle):
        return self.note("on_aborting", handle)

    def on_error(self, handle):
        return self.note("on_error", handle)

    def on_reset(self, handle):
        return self.note("on_reset", handle)

    def on_rate_changed(self, handle):
        return self.note("on_rate_changed", handle)

    def on_state_update(self, handle):
        return "RTC_OK"

    def on_execute(self, handle):
        self.calls += 1
        kind, _, at = self.options.fault.partition("@")
        if at in (str(self.calls), "*") and not self.misbehave(kind):
            return "RTC_ERROR"
        if self.options.source:
            self.value = self.calls
        elif self.into.received:
            self.value = struct.unpack_from("<IIi", self.into.received[-1])[2] + 1
            self.into.received.clear()
        else:
            return self.note("on_execute", handle)
        now = time.time()
        value = self.value + time.time_ns() % 1000003 if self.options.race == "clock" else self.value
        octets = struct.pack("<IIi", int(now), int(now % 1 * 1e9), value)
        if self.options.race == "thread":
            threading.Timer(0.005 * (os.getpid() % 3) + 0.001, self.out.send, [octets]).start()
        else:
            self.out.send(octets)
        return self.note("on_execute", handle)

    def misbehave(self, kind):
        if kind == "throw":
            raise SystemException("UNKNOWN")
        if kind == "raise":
            try:
                raise ValueError("no scan")
            except ValueError:
                traceback.print_exc()  # as the ORBs of Python do
            raise SystemException("UNKNOWN")
        if kind == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if kind == "stop":
            os.kill(os.getpid(), signal.SIGSTOP)
        if kind == "hang":
            signal.pause() if threading.current_thread() is threading.main_thread() else threading.Event().wait()
        if kind == "fail":
            return False
        if kind.startswith("meet"):
            return meet(kind.partition("/")[2], self.name)
        time.sleep(float(kind) / 1000)
        return True

    # What contexts and tools ask.
    def attach_context(self, context):
        if self.options.die == "attach":
            os.kill(os.getpid(), signal.SIGKILL)
        if self.options.attach_late:
            self.note("asked", 0)
            time.sleep(self.options.attach_late / 1000)
        self.others.append(context)
        return first_other_handle + len(self.others) - 1

    def detach_context(self, handle):
        at = handle - first_other_handle
        if not 0 <= at < len(self.others) or self.others[at] is None:
            return "BAD_PARAMETER"
        self.others[at] = None
        return "RTC_OK"

    def get_context_handle(self, context):
        if context.ior.key() == self.own.servant.ior.key():
            return 0
        keys = [other and other.ior.key() for other in self.others]
        return first_other_handle + keys.index(context.ior.key()) if context.ior.key() in keys else -1

    def get_owned_contexts(self):
        return [self.own.servant.ior]

    def get_participating_contexts(self):
        return [other for other in self.others if other]

    def is_alive(self, context):
        return self.get_context_handle(context) >= 0

    def get_sdo_id(self):
        return self.name

    def get_configuration(self):
        return None

    def get_owned_organizations(self):
        return []

    def get_ports(self):
        return [self.into.ior, self.out.ior]

    def get_component_profile(self):
        return self.idl.struct("RTC::ComponentProfile", instance_name=self.name, type_name="Foreign", description="of another make", version="1.0", vendor="others", category="test",
                               port_profiles=[self.into.profile(), self.out.profile()], parent=None, properties=strings(self.idl, implementation_id="Foreign", language="Python"))


# Waits, but not for ever, until both have come.
def meet(folder, name):
    open(f"/{folder}/{name}.here", "w").close()
    end = time.monotonic() + 20
    while time.monotonic() < end:
        if sum(file.endswith(".here") for file in os.listdir(f"/{folder}")) > 1:
            return True
        time.sleep(0.001)
    return False


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    parser.add_argument("--names", default=os.environ.get("RTCTREE_NAMESERVERS", "127.0.0.1:2809"))
    parser.add_argument("--source", action="store_true")
    parser.add_argument("--journal", default="")
    parser.add_argument("--fault", default="")
    parser.add_argument("--late", default="")
    parser.add_argument("--attach-late", type=float, default=0)
    parser.add_argument("--die", default="", choices=["", "attach", "activate"])
    parser.add_argument("--activate-late", type=float, default=0)
    parser.add_argument("--throw-at", type=int, default=0)
    parser.add_argument("--stop-at", type=int, default=0)
    parser.add_argument("--race", default="", choices=["", "clock", "thread"])
    parser.add_argument("--context", default="periodic", choices=["periodic", "triggered", "logical", "lazy", "afterwards"])
    parser.add_argument("--clock", type=float, default=0)
    parser.add_argument("--active", action="store_true")
    options = parser.parse_args()
    idl = Idl(f"{source}/idl", "OpenRTM.idl", "LogicalTimeTriggeredEC.idl", f"{source}/tests/ports/naming.idl", "ClockGenerator.idl")
    orb = Orb(2, "<")
    orb.kept = threading.local()
    component = Component(idl, orb, options)
    host, port = options.names.split(":")
    root = Remote(idl, orb, Ior.make("IDL:omg.org/CosNaming/NamingContext:1.0", host, int(port), b"NameService", 2), "CosNaming::NamingContext")
    root.rebind([idl.struct("CosNaming::NameComponent", id=options.name, kind="rtc")], component.servant.ior)
    clock = options.clock and await_clock(idl, root)
    if clock:
        clock.subscribe(component.own.servant.ior, options.clock)
    if options.active:
        component.own.activate_component(None)
    print("ready", flush=True)
    signal.sigwait([signal.SIGTERM, signal.SIGINT])
    if clock:
        clock.unsubscribe(component.own.servant.ior)
    root.unbind([idl.struct("CosNaming::NameComponent", id=options.name, kind="rtc")])


# The simulator of those who subscribe binds it some time.
def await_clock(idl, root):
    end = time.monotonic() + 20
    while True:
        try:
            return root.resolve([idl.struct("CosNaming::NameComponent", id="ClockGenerator", kind="")]).narrow("OpenHRP::ClockGenerator")
        except SystemException:
            if time.monotonic() > end:
                raise
            time.sleep(0.02)


if __name__ == "__main__":
    main()
