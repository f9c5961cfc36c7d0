# Kinds of components that OpenRTM-aist-Python ships as examples, written anew: the same calls in the same order.
import os
import pathlib
import subprocess
import sys

import pytest

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent / "scenario"))
from system import System, await_  # noqa: E402

bin_dir, lib_dir = os.environ["RTMSIM_BIN_DIR"], os.environ["RTMSIM_LIB_DIR"]
sources = here / "classic"
python = "/usr/bin/python3"
channel = ["-p", "interface_type=csp_channel", "-p", "dataflow_type=duplex"]


@pytest.fixture
def system():
    with System(bin_dir, lib_dir) as one:
        one.naming()
        yield one


def program(system, file, *options, folder=sources, **more):
    process = system.start(python, "-B", str(folder / file), "-o", f"corba.nameservers:{system.names}", "-o", "naming.formats:%n.rtc",
                           "-o", "manager.shutdown_auto:NO", *options, **more)
    name = pathlib.Path(file).stem + "0"
    await_(name, lambda: name in system.rtse("ls"))
    return process


def says(system, process, *texts):
    for text in texts:
        await_(text, lambda: text in system.log(process))
    return system.log(process)


def types(process, *lines):
    for line in lines:
        process.stdin.write((line + "\n").encode())
    process.stdin.flush()


@pytest.mark.parametrize("oven, interface, words", [("Oven", "corba_cdr", ()), ("ChannelOven", "csp_channel", ("channels",))])
def test_events_of_ports_change_the_state_of_a_machine(system, oven, interface, words):
    receiver = program(system, f"{oven}.py")
    sender = program(system, "Buttons.py", *words, input=subprocess.PIPE)
    for name in ("heat", "door", "tick"):
        more = channel if words else []
        system.rtse("con", f"Buttons0:{name}", f"{oven}0:event", "-p", f"fsm_event_name={name}", *more)
    system.rtse("act", f"{oven}0", "Buttons0")
    types(sender, "tick", "heat 2", "tick", "heat x", "tick", "door", "heat 3", "tick", "door")
    log = says(system, receiver, "opened")
    await_("cold again", lambda: system.log(receiver).count("cold") == 3)
    log = [line for line in system.log(receiver).splitlines() if line.split(" ")[0] in ("cold", "hot", "off", "left", "opened")]
    assert log == ["cold", "hot", "left 2", "left 1", "left 0", "off", "cold", "opened", "cold"]
    assert "heat needs a number" in system.log(sender)


# Connection property, what ShortSource sends, what DoubleSink prints.
@pytest.mark.parametrize("properties, preloads", [(["inport.marshaling_type=cdr:RTC/TimedShort:RTC/TimedDouble"], "in"),
                                                  (["outport.marshaling_type=cdr:RTC/TimedDouble:RTC/TimedShort"], "out"),
                                                  (["marshaling_type=text", "text.end=!"], "in out")])
def test_a_serializer_of_an_author_turns_shorts_into_doubles(system, properties, preloads):
    preload = ("-o", f"manager.modules.load_path:{sources}", "-o", "manager.modules.preload:ShortToDouble.py")
    sink = program(system, "DoubleSink.py", *(preload if "in" in preloads else ()))
    source = program(system, "ShortSource.py", *(preload if "out" in preloads else ()), input=subprocess.PIPE)
    system.rtse("con", "ShortSource0:out", "DoubleSink0:in", *[word for one in properties for word in ("-p", one)])
    system.rtse("act", "DoubleSink0", "ShortSource0")
    types(source, "-12")
    says(system, sink, "received -12.0 True")
    if properties[0] == "marshaling_type=text":
        types(source, "13", "14")
        says(system, sink, "received 14.0 True")
        log = says(system, source, "written False")
        assert "of serializer \"text\" has thrown" in log and "ValueError: not this one" in log


def test_a_connection_that_names_a_serializer_which_nobody_has_registered_is_refused(system):
    program(system, "DoubleSink.py")
    program(system, "ShortSource.py", input=subprocess.PIPE)
    refused = system.try_rtse("con", "ShortSource0:out", "DoubleSink0:in", "-p", "marshaling_type=text")
    assert refused.returncode != 0


def numbers(text, word):
    return [int(line.split()[1]) for line in text.splitlines() if line.startswith(word + " ")]


# All pairs of a port that waits by itself and one that a manager selects; with the buffer, and without, where both sides must meet.
@pytest.mark.parametrize("length", ["8", "1", "0"])
@pytest.mark.parametrize("receiver", ["ChannelReader", "ChannelIn"])
@pytest.mark.parametrize("sender", ["ChannelWriter", "ChannelOut"])
def test_every_value_of_a_csp_port_arrives_once_and_in_order(system, sender, receiver, length):
    sending, receiving = program(system, f"{sender}.py"), program(system, f"{receiver}.py", f"?port.inport.in1.buffer.length={length}")
    system.rtse("con", f"{sender}0:out1", f"{receiver}0:in1", *channel)
    system.rtse("act", f"{sender}0", f"{receiver}0")
    await_("20 values", lambda: len(numbers(system.log(receiving), "got")) >= 20)
    await_("20 acknowledged", lambda: len(numbers(system.log(sending), "sent")) >= 20)  # a sender says so after the receiver has taken it
    assert numbers(system.log(receiving), "got") == list(range(20)) == numbers(system.log(sending), "sent")


def test_a_manager_of_csp_ports_selects_each_port_that_can_go_on(system):
    sending, receiving = program(system, "ChannelOut.py"), program(system, "ChannelIn.py")
    for number in (1, 2, 3):
        system.rtse("con", f"ChannelOut0:out{number}", f"ChannelIn0:in{number}", *channel, "-p", "buffer.length=1")
    system.rtse("act", "ChannelOut0", "ChannelIn0")
    await_("20 values", lambda: len(numbers(system.log(receiving), "got")) >= 20)
    assert sorted(numbers(system.log(receiving), "got")) == list(range(20))


def test_a_csp_port_without_a_partner_does_not_write_and_another_interface_is_refused(system):
    sending = program(system, "ChannelWriter.py")
    program(system, "DoubleSink.py")
    refused = system.try_rtse("con", "ChannelWriter0:out1", "DoubleSink0:in")
    assert refused.returncode != 0
    system.rtse("act", "ChannelWriter0")
    assert "Error" not in system.rtse("ls", "-l")
    assert "sent" not in system.log(sending)


def test_a_console_reads_its_terminal_and_hears_all_its_connections(system):
    console = program(system, "Console.py", input=subprocess.PIPE)
    system.rtse("con", "-n", "loop", "Console0:out", "Console0:in")
    system.rtse("act", "Console0")
    types(console, "12", "13")
    log = says(system, console, "data=12)", "[ns]")
    for name in ("ON_BUFFER_WRITE", "ON_BUFFER_READ", "ON_SEND", "ON_RECEIVED"):
        assert f"Listener: {name} loop 12" in log
    assert "Listener: ON_CONNECT loop" in log
    types(console, "14")
    system.rtse("dis", "Console0:out", "Console0:in")
    says(system, console, "Listener: ON_DISCONNECT loop")


def test_input_that_is_no_number_ends_in_the_error_state(system):
    console = program(system, "Console.py", input=subprocess.PIPE)
    system.rtse("act", "Console0")
    types(console, "x")
    says(system, console, "ValueError: invalid literal for int()")
    await_("error state", lambda: "rror" in system.rtse("ls", "-l"))


def test_a_script_ticks_a_context_that_is_triggered_from_outside(system):
    ticked = program(system, "Ticked.py", "-o", "exec_cxt.periodic.type:ExtTrigExecutionContext")
    script = system.start(python, "-B", str(sources / "ticks.py"), system.names, input=subprocess.PIPE)
    says(system, script, "connect RTC_OK")
    assert "cycle" not in system.log(ticked)
    for number in (1, 2, 3):
        types(script, "")
        says(system, ticked, f"cycle {number} ")
    assert "cycle 4" not in system.log(ticked)
    script.stdin.close()
    assert script.wait(60) == 0, system.log(script)


def test_values_of_ten_types_come_back_as_they_were_sent(system):
    process = program(system, "Sequences.py")
    for name in ("Octet", "Short", "Long", "Float", "Double"):
        for kind in (name, name + "Seq"):
            system.rtse("con", f"Sequences0:{kind}", f"Sequences0:{kind}In")
    system.rtse("act", "Sequences0")
    assert "differs" not in says(system, process, "fifty rounds")


def test_parameters_of_all_kinds_follow_their_configuration_set(system):
    process = program(system, "Parameters.py")
    system.rtse("act", "Parameters0")
    says(system, process, "parameters 0 0.11 hoge [0.0, 1.0, 2.0, 3.0, 4.0]")
    system.rtse("conf", "Parameters0", "set", "vector_param0", "5,6")
    says(system, process, "parameters 0 0.11 hoge [5.0, 6.0]", "heard set Properties")
    system.rtse("conf", "Parameters0", "act", "fast")
    says(system, process, "parameters 7 ", "heard activate fast", "heard parameter fast int_param0")


def test_a_component_that_measures_leaves_by_itself(system):
    process = program(system, "Throughput.py", "-o", "manager.shutdown_on_nortcs:YES")
    system.rtse("con", "Throughput0:out", "Throughput0:in")
    system.rtse("act", "Throughput0")
    log = says(system, process, "connections 1 received 10 True")
    assert "connected corba_cdr True" in log
    await_("no name", lambda: "Throughput0" not in system.rtse("ls"))


def test_a_composite_of_components_of_python_runs_them_in_one_context(system):
    host = system.start(python, "-B", str(sources / "composite_host.py"), "-o", f"corba.nameservers:{system.names}",
                        "-o", "naming.formats:%n.rtc", "-o", "manager.shutdown_auto:NO", "-o", f"manager.modules.load_path:{sources}",
                        "-o", "manager.modules.preload:Sensing.py", "-o",
                        "manager.components.precreate:Sensing,Sensing,PeriodicECSharedComposite?instance_name=Whole&"
                        "conf.default.members=Sensing0|Sensing1")
    await_("all", lambda: "Whole" in system.rtse("ls"))
    system.rtse("con", "Sensing0:out", "Sensing1:in")
    system.rtse("act", "Whole")
    # One sample may come before the context runs.
    await_("both", lambda: "Sensing1 42" in system.log(host) or system.try_rtse("inject", "Sensing0:in", "RTC.TimedLong({time}, 40)") is None)
    assert "Sensing0 41" in system.log(host)


def test_a_window_runs_in_the_main_thread_beside_the_manager(system):
    process = program(system, "Slider.py")
    system.rtse("con", "Slider0:slider", "Slider0:angle")
    system.rtse("act", "Slider0")
    says(system, process, "moved [0.0, 0.0]")
    system.rtse("exit", "Slider0")
    assert process.wait(60) == 0
    assert "window closed" in system.log(process)
