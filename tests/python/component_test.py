# Components of Python: unmodified sources, run as programs and by rtcd, beside components of C++.
import os
import pathlib
import re
import signal
import subprocess
import sys

import pytest

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent / "scenario"))
from system import System, await_  # noqa: E402

bin_dir, lib_dir = os.environ["RTMSIM_BIN_DIR"], os.environ["RTMSIM_LIB_DIR"]
sources = here / "components"
python = "/usr/bin/python3"


@pytest.fixture
def system():
    with System(bin_dir, lib_dir) as one:
        one.naming()
        yield one


def program(system, file, *options, folder=sources, **more):
    return system.start(python, "-B", str(folder / file), "-o", f"corba.nameservers:{system.names}", "-o", "naming.formats:%n.rtc",
                        "-o", "manager.shutdown_auto:NO", *options, **more)


def written(tmp_path, name, body, extra=""):
    """A component of that name whose class has this body."""
    text = f'''
import sys
import OpenRTM_aist
import RTC
{extra}
{name.lower()}_spec = ["implementation_id", "{name}", "type_name", "{name}", "description", "a test", "version", "1.0", "vendor", "rtm-sim",
    "category", "test", "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script", ""]

class {name}(OpenRTM_aist.DataFlowComponentBase):
{body}

def {name}Init(manager):
    profile = OpenRTM_aist.Properties(defaults_str={name.lower()}_spec)
    manager.registerFactory(profile, {name}, OpenRTM_aist.Delete)

def MyModuleInit(manager):
    {name}Init(manager)
    manager.createComponent("{name}")

if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
'''
    (tmp_path / f"{name}.py").write_text(text)
    return f"{name}.py"


def says(system, process, text):
    return await_(text, lambda: text in system.log(process) and system.log(process))


def seen(system, name):
    await_(name, lambda: name in system.rtse("ls"))


def test_two_programs_of_python_exchange_samples_and_both_generations_of_listeners_hear_them(system):
    counter, printer = program(system, "Counter.py"), program(system, "Printer.py")
    seen(system, "Counter0")
    seen(system, "Printer0")
    system.rtse("con", "Counter0:number", "Printer0:number")
    system.rtse("act", "Counter0", "Printer0")
    log = says(system, printer, "received 5 True")
    assert "old listener ON_BUFFER_WRITE" in log and "new listener 0" in log
    assert "connected" in log and "push" in log
    assert "parameters: [1] [[0.5, 1.5]] ['counter']" in system.log(counter)


def test_a_parameter_that_a_tool_changes_reaches_the_list_that_is_bound(system):
    program(system, "Counter.py")
    printer = program(system, "Printer.py")
    seen(system, "Printer0")
    seen(system, "Counter0")
    system.rtse("con", "Counter0:number", "Printer0:number")
    system.rtse("conf", "Counter0", "set", "step", "1000000")
    system.rtse("act", "Counter0", "Printer0")
    says(system, printer, "received 3000000")


def test_a_port_of_cpp_receives_what_python_sends_and_sends_what_python_receives(system):
    program(system, "Counter.py")
    printer = program(system, "Printer.py")
    seen(system, "Counter0")
    seen(system, "Printer0")
    system.rtse("act", "Counter0", "Printer0")
    printed = system.rtse("print", "-n", "3", "-t", "30", "Counter0:number")
    assert len(printed.splitlines()) == 3
    system.rtse("inject", "Printer0:number", "RTC.TimedLong({time}, 4711)")
    says(system, printer, "received 4711")


def test_rtcd_hosts_a_module_of_python(system):
    host = system.rtcd("-o", "naming.formats:%n.rtc", str(sources / "Counter.py"), str(sources / "Printer.py"))
    seen(system, "Counter0")
    seen(system, "Printer0")
    system.rtse("con", "Counter0:number", "Printer0:number")
    system.rtse("act", "Counter0", "Printer0")
    says(system, host, "received 3 True")


def test_an_exception_in_on_execute_ends_in_the_error_state_with_its_traceback_in_the_log(system, tmp_path):
    file = written(tmp_path, "Broken", """
    def onExecute(self, ec_id):
        self.no_such_thing.go()
        return RTC.RTC_OK
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Broken0")
    subprocess.run([f"{bin_dir}/rtse", "--ns", system.names, "act", "Broken0"], timeout=60, capture_output=True)
    log = says(system, process, "has no attribute 'no_such_thing'")
    assert "Traceback" in log and "Broken.py" in log and "onExecute" in log
    assert "threw: AttributeError: 'Broken' object has no attribute 'no_such_thing'\n" in log, "the line begins with what was raised"
    await_("error state", lambda: "rror" in system.rtse("ls", "-l"))


@pytest.mark.parametrize("statement, why", [("return None", "it returned None"), ("return 0", "it returned 0"), ("sys.exit(3)", "SystemExit")])
def test_anything_but_a_return_code_is_an_error(system, tmp_path, statement, why):
    file = written(tmp_path, "Odd", f"""
    def onExecute(self, ec_id):
        {statement}
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Odd0")
    subprocess.run([f"{bin_dir}/rtse", "--ns", system.names, "act", "Odd0"], timeout=60, capture_output=True)
    says(system, process, why)
    assert process.poll() is None


def test_a_wrong_value_is_one_log_line_with_port_member_and_types(system, tmp_path):
    file = written(tmp_path, "Wrong", """
    def onInitialize(self):
        self._d = RTC.TimedLongSeq(RTC.Time(0, 0), [])
        self._out = OpenRTM_aist.OutPort("out", self._d)
        self.addOutPort("out", self._out)
        self._count = 0
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        self._d.data = [1, 2, "three"]
        assert self._out.write() is False
        self._count += 1
        if self._count == 20:
            print("twenty times", flush=True)
        return RTC.RTC_OK
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Wrong0")
    system.rtse("act", "Wrong0")
    log = says(system, process, "twenty times")
    lines = [line for line in log.splitlines() if "cannot be written" in line]
    assert len(lines) == 1
    assert "RTC/TimedLongSeq cannot be written to port Wrong0.out: data[2]: expected long, got str 'three'" in lines[0]


def test_control_c_ends_a_program_that_waits_in_run_manager(system):
    process = program(system, "Counter.py")
    seen(system, "Counter0")
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 0
    await_("no name", lambda: "Counter0" not in system.rtse("ls"))


def test_run_manager_without_blocking_returns_and_the_program_ends_with_its_main_thread(system, tmp_path):
    file = written(tmp_path, "Quick", "    pass\n")
    text = (tmp_path / file).read_text().replace("mgr.runManager()", 'mgr.runManager(True); print("goes on", flush=True)')
    (tmp_path / file).write_text(text)
    process = program(system, file, folder=tmp_path)
    assert process.wait(60) == 0
    assert "goes on" in system.log(process)


def test_a_source_of_python_2_is_one_clear_line(system, tmp_path):
    (tmp_path / "Old.py").write_text('import OpenRTM_aist\n\ndef OldInit(manager):\n    print "hello"\n')
    host = system.rtcd(str(tmp_path / "Old.py"))
    assert host.wait(60) == 1
    line = [line for line in system.log(host).splitlines() if "Old.py" in line and "Python 2" in line]
    assert len(line) == 1 and "Old.py:4: is Python 2: write print(...) instead of `print \"hello\"`" in line[0]


def test_a_run_in_lock_step_with_a_component_of_python_is_repeatable(tmp_path):
    import rtmsim
    world = here.parents[1] / "worlds" / "obstacle_course.sdf"
    system_file = here.parents[1] / "worlds" / "systems" / "obstacle_avoidance.xml"
    text = system_file.read_text()
    start = text.index("<rts:ConfigurationSets", text.index(":LaserObstacleAvoid:"))
    end = text.index("</rts:ConfigurationSets>", start) + len("</rts:ConfigurationSets>")
    text = text[:start] + text[end:]
    profile = tmp_path / "python.xml"
    profile.write_text(text.replace("LaserObstacleAvoid", "Avoider"))
    results = [rtmsim.run(str(profile), str(world), duration=3, expect=[{"path_length": {"model": "pioneer2dx", "min": 0.3}}],
                          options=["--module-path", str(sources), "--module-path", lib_dir]) for _ in range(2)]
    for result in results:
        assert result.passed, result.why
    assert results[0].state_hash and results[0].state_hash == results[1].state_hash


@pytest.mark.parametrize("statement", ["while True: pass", "import time; time.sleep(1000)", "import re; re.match('(a*)*$', 'a' * 40 + 'b')",
                                       "sys.stdin.readline()", "import threading; threading.Event().wait()"])
def test_a_callback_that_never_returns_does_not_keep_the_process_from_its_end(system, tmp_path, statement):
    file = written(tmp_path, "Stuck", f"""
    def onExecute(self, ec_id):
        print("stuck", flush=True)
        {statement}
        return RTC.RTC_OK
""")
    process = program(system, file, "-o", "exec_cxt.callback_timeout:0.5", folder=tmp_path, input=subprocess.PIPE)
    seen(system, "Stuck0")
    system.try_rtse("act", "Stuck0")
    says(system, process, "stuck")
    process.terminate()
    process.wait(50)


def test_a_program_that_ends_in_a_callback_is_gone_at_once(system, tmp_path):
    file = written(tmp_path, "Gone", """
    def onExecute(self, ec_id):
        os._exit(7)
""", extra="import os")
    process = program(system, file, folder=tmp_path)
    seen(system, "Gone0")
    system.try_rtse("act", "Gone0")
    assert process.wait(60) == 7


@pytest.mark.parametrize("body", ["    def __init__(self, manager):\n        raise ValueError('not today')\n",
                                  "    def __init__(self, manager):\n        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)\n"
                                  "        raise ValueError('not today')\n",
                                  "    def onInitialize(self):\n        raise ValueError('not today')\n"])
def test_a_component_that_cannot_be_made_is_none_and_the_log_says_why(system, tmp_path, body):
    file = written(tmp_path, "Never", body)
    text = (tmp_path / file).read_text().replace('    manager.createComponent("Never")', '    print("made", manager.createComponent("Never"), flush=True)')
    (tmp_path / file).write_text(text)
    process = program(system, file, folder=tmp_path)
    log = says(system, process, "made None")
    assert "ValueError: not today" in log
    process.terminate()
    assert process.wait(60) == 0


def test_a_component_leaves_and_another_one_comes_in_one_process(system, tmp_path):
    file = written(tmp_path, "Again", """
    def onInitialize(self):
        self._out = OpenRTM_aist.OutPort("out", RTC.TimedLong(RTC.Time(0, 0), 0))
        self.addOutPort("out", self._out)
        return RTC.RTC_OK
    def onFinalize(self):
        print("finalized", self.getInstanceName(), flush=True)
        return RTC.RTC_OK
    def __del__(self):
        print("deleted", flush=True)
""")
    text = (tmp_path / file).read_text().replace("mgr.runManager()", """mgr.runManager(True)
    import gc, time
    for i in range(20):
        mgr.deleteComponent(mgr.getComponents()[0].getInstanceName())
        while mgr.getComponents(): time.sleep(0.01)
        mgr.createComponent("Again")
    gc.collect()
    print("twenty times", flush=True)
    mgr.shutdown()""")
    (tmp_path / file).write_text(text)
    process = program(system, file, "-o", "manager.shutdown_on_nortcs:NO", folder=tmp_path)
    assert process.wait(60) == 0, system.log(process)
    log = system.log(process)
    assert "twenty times" in log and log.count("finalized") >= 20 and log.count("deleted") >= 19


def test_a_script_finds_connects_and_activates_components_by_their_references(system):
    program(system, "Counter.py")
    printer = program(system, "Printer.py")
    seen(system, "Counter0")
    seen(system, "Printer0")
    said = system.call(python, "-B", str(sources / "connector.py"), system.names)
    assert "not found missing_node Nothing0" in said
    assert "connect RTC_OK True connector0" in said
    assert "profile Counter IDL:RTC/TimedLong:1.0" in said
    assert "activate RTC_OK 100.0" in said
    assert "parameter 1" in said and "set True" in said
    assert "as in 1.x True" in said and "root True" in said and "by url True" in said and "by name True" in said
    assert "direct RTC_OK PORT_OK" in said
    says(system, printer, "received 4712")
    says(system, printer, "connected connector0 push")
    await_("the new step", lambda: any(int(value) > 2000 for value in re.findall(r"^received (\d+) True$", system.log(printer), re.MULTILINE)))


@pytest.mark.parametrize("body", [
    "threading.Thread(target=lambda: [0 for _ in iter(int, 1)]).start()",  # computes for ever, not a daemon
    "threading.Thread(target=threading.Event().wait).start()",
    "[threading.Thread(target=threading.Event().wait).start() for _ in range(50)]",
])
def test_threads_of_an_author_that_never_end_do_not_keep_the_process_from_its_end(system, tmp_path, body):
    file = written(tmp_path, "Threads", f"""
    def onActivated(self, ec_id):
        {body}
        print("started", flush=True)
        return RTC.RTC_OK
""", extra="import threading")
    process = program(system, file, folder=tmp_path)
    seen(system, "Threads0")
    system.rtse("act", "Threads0")
    says(system, process, "started")
    process.terminate()
    process.wait(50)


def test_a_list_that_does_not_fit_into_memory_ends_in_the_error_state(system, tmp_path):
    file = written(tmp_path, "Huge", """
    def onExecute(self, ec_id):
        resource.setrlimit(resource.RLIMIT_AS, (1 << 31, resource.RLIM_INFINITY))
        self.numbers = [0] * (10 << 30)
        return RTC.RTC_OK
""", extra="import resource")
    process = program(system, file, folder=tmp_path)
    seen(system, "Huge0")
    system.try_rtse("act", "Huge0")
    says(system, process, "MemoryError")
    await_("error state", lambda: "rror" in system.rtse("ls", "-l"))
    process.terminate()
    assert process.wait(50) == 0


@pytest.mark.parametrize("call", ["shutdown()", "terminate()"])
def test_a_component_that_ends_the_manager_in_its_callback_ends_the_process(system, tmp_path, call):
    file = written(tmp_path, "Ender", f"""
    def onExecute(self, ec_id):
        manager = OpenRTM_aist.Manager.instance()
        manager.{call}
        return RTC.RTC_OK
""")
    process = program(system, file, folder=tmp_path)
    seen(system, "Ender0")
    system.try_rtse("act", "Ender0")
    process.wait(60)
    await_("no name", lambda: "Ender0" not in system.rtse("ls"))


def test_a_component_that_deletes_itself_and_the_manager_object_leaves_the_others_running(system, tmp_path):
    file = written(tmp_path, "Suicide", """
    def onExecute(self, ec_id):
        del self._manager
        OpenRTM_aist.Manager._instance = None
        self.exit()
        return RTC.RTC_OK
""")
    host = system.rtcd("-o", "naming.formats:%n.rtc", str(tmp_path / file), str(sources / "Counter.py"))
    seen(system, "Suicide0")
    seen(system, "Counter0")
    system.try_rtse("act", "Suicide0")
    await_("no name", lambda: "Suicide0" not in system.rtse("ls"))
    system.rtse("act", "Counter0")
    says(system, host, "parameters: [1]")
    host.terminate()
    assert host.wait(50) == 0


@pytest.mark.parametrize("statement", ["while True: pass", "os._exit(7)", "sys.exit(1)", "self.no_such_thing()"])
def test_a_run_names_the_component_that_does_not_go_on(tmp_path, statement):
    import rtmsim
    written(tmp_path, "Hostile", f"""
    def onInitialize(self):
        self._in = OpenRTM_aist.InPort("range", OpenRTM_aist.instantiateDataType(RTC.RangeData))
        self.addInPort("range", self._in)
        self._out = OpenRTM_aist.OutPort("velocity", OpenRTM_aist.instantiateDataType(RTC.TimedVelocity2D))
        self.addOutPort("velocity", self._out)
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        {statement}
        return RTC.RTC_OK
""", extra="import os")
    root = here.parents[1] / "worlds"
    text = (root / "systems" / "obstacle_avoidance.xml").read_text()
    start = text.index("<rts:ConfigurationSets", text.index(":LaserObstacleAvoid:"))
    end = text.index("</rts:ConfigurationSets>", start) + len("</rts:ConfigurationSets>")
    profile = tmp_path / "hostile.xml"
    profile.write_text((text[:start] + text[end:]).replace("LaserObstacleAvoid", "Hostile"))
    result = rtmsim.run(str(profile), str(root / "obstacle_course.sdf"), duration=1,
                        options=["--module-path", str(tmp_path), "--module-path", lib_dir])
    assert not result.passed
    assert "Hostile0" in result.why


# The host is Debian's Python with its own library, whatever comes first in PATH; of an active virtual environment it has the packages.
@pytest.mark.parametrize("is_active", [False, True])
def test_the_host_is_the_python_of_the_system_or_of_the_active_environment(system, tmp_path, is_active):
    version = subprocess.run([python, "-c", "import sys; print('python%d.%d' % sys.version_info[:2])"], check=True, capture_output=True, text=True).stdout.strip()
    (tmp_path / "bin").mkdir()
    library = tmp_path / "lib" / version
    (library / "lib-dynload").mkdir(parents=True)
    if is_active:
        (tmp_path / "bin/python3").symlink_to(python)
        (tmp_path / "pyvenv.cfg").write_text("home = /usr/bin\ninclude-system-site-packages = true\n")
        (library / "site-packages").mkdir()
        (library / "site-packages/only_here.py").write_text("")
    else:  # another installation
        (tmp_path / "bin/python3").write_text("#!/bin/false\n")
        (tmp_path / "bin/python3").chmod(0o755)
        (library / "os.py").write_text("")
    module = written(tmp_path, "Where", """
    def onActivated(self, ec_id):
        print("prefix", sys.base_prefix, "packages", importlib.util.find_spec("only_here") is not None, flush=True)
        return RTC.RTC_OK
""", "import importlib.util")
    more = {"VIRTUAL_ENV": str(tmp_path)} if is_active else {}
    host = system.rtcd("-o", "naming.formats:%n.rtc", str(tmp_path / module), PATH=f"{tmp_path}/bin:{os.environ['PATH']}", **more)
    seen(system, "Where0")
    system.rtse("act", "Where0")
    assert f"prefix /usr packages {is_active}" in says(system, host, "prefix ")
