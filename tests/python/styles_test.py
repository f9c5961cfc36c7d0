# Components in the styles of public sources, written anew: what RTCBuilder of 1.0 to 2.0 writes, and what people make of it. Each prints
# OK and its name when all that it touches has worked.
import pathlib
import signal
import subprocess

import pytest

from component_test import bin_dir, lib_dir, python, says, seen  # noqa: F401
from system import System, await_

here = pathlib.Path(__file__).resolve().parent
worlds = here.parents[1] / "worlds"
styles = here / "styles"
names = sorted(file.stem for file in styles.glob("*.py") if "_spec = [" in file.read_text("latin-1"))


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("styles") / "styles"
    subprocess.run(["cp", "-r", str(styles), str(folder)], check=True)
    from service_test import omniidl
    omniidl(folder, "Lab.idl")
    return folder


@pytest.fixture(scope="module")
def system():
    with System(bin_dir, lib_dir) as one:
        one.naming()
        yield one


def started(system, sources, name):
    words = ["--instance_name=renamed"] if name == "InstanceName" else []
    process = system.start(python, "-B", f"{name}.py", *words, "-o", f"corba.nameservers:{system.names}", "-o", "naming.formats:%n.rtc",
                           "-o", "manager.shutdown_auto:NO", "-o", "exec_cxt.periodic.rate:50", cwd=str(sources), input=subprocess.DEVNULL,
                           PYTHONUNBUFFERED="1")
    instance = "renamed" if words else name + "0"
    seen(system, instance)
    return process, instance


@pytest.mark.parametrize("name", names)
def test_a_component_of_each_style_runs_as_a_program_and_ends_by_ctrl_c(system, sources, name):
    process, instance = started(system, sources, name)
    system.try_rtse("act", instance)
    log = says(system, process, f"OK {name}")
    assert "Traceback" not in log
    if name != "Leaver":
        process.send_signal(signal.SIGINT)
    assert process.wait(60) in (0, -signal.SIGINT), system.log(process)
    await_("no names", lambda: instance not in system.rtse("ls"))


def test_one_host_runs_components_of_all_styles(system, sources):
    hosted = [name for name in names if name not in ("MainLoop", "Leaver", "Inherited")]  # Whole brings Inherited
    host = system.rtcd("-o", "naming.formats:%n.rtc", "-o", "exec_cxt.periodic.rate:50", "-o", f"manager.modules.load_path:{sources}",
                       *[f"{name}.py" for name in hosted], cwd=str(sources),
                       PYTHONUNBUFFERED="1")
    for name in hosted:
        seen(system, name + "0")
        system.try_rtse("act", name + "0")
    for name in hosted:
        says(system, host, f"OK {name}")
    assert "Traceback" not in system.log(host)
    host.terminate()
    assert host.wait(60) == 0


def test_a_run_steps_components_of_several_styles(system, sources, tmp_path):
    import rtmsim
    for name in ("StarImport", "Values", "GlobalStubs"):
        started(system, sources, name)
    profile = tmp_path / "styles.xml"
    system.rtse("save", str(profile))
    result = rtmsim.run(str(profile), str(worlds / "empty.sdf"), duration=1, options=["--module-path", str(sources)])
    assert result.passed, result.why + result.logs
