# Sources that were written for Python 2, loaded by rtcd.
import subprocess

import pytest

from component_test import bin_dir, system  # noqa: F401: system is a fixture


@pytest.mark.parametrize("source, line", [
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    exec 'print 1'\n", "Old.py:4: is Python 2: write exec(...)"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    try:\n        pass\n    except ValueError, e:\n        pass\n", "Old.py:6: is Python 2: write `except Error as name:`"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    raise ValueError, 'x'\n", "Old.py:4: is Python 2: write `raise Error(...)`"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    if 1 <> 2: pass\n", "Old.py:4: is Python 2: write `!=`"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    x = 0777\n", "Old.py:4: is Python 2: write 0o777"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    x = `1`\n", "Old.py:4: is Python 2: write repr(...)"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    x = 10L\n", "Old.py:4: is Python 2: write integers without L"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    x = ur'a'\n", "Old.py:4: is Python 2: write"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    if 1:\n\tpass\n", "Old.py:5: mixes tabs and blanks"),
    ("import OpenRTM_aist\nimport Tkinter\n\ndef OldInit(manager):\n    pass\n", "Old.py:2: is Python 2: the module Tkinter is tkinter"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    print({}.has_key('a'))\n", "Old.py:4: is Python 2: write `key in dictionary` instead of has_key"),
    ("import OpenRTM_aist\n\ndef OldInit(manager):\n    print(unicode('a'))\n", "Old.py:4: is Python 2: the name unicode is str"),
    ("import OpenRTM_aist, RTC\n\ndef OldInit(manager):\n    RTC.TimedLong(*([None] * ((len(RTC._d_TimedLong) - 4) / 2)))\n", "Old.py:4: is Python 2: write // "),
])
def test_sources_of_python_2_are_one_line_each_with_what_to_write(system, tmp_path, source, line):  # noqa: F811
    (tmp_path / "Old.py").write_text(source)
    host = system.rtcd(str(tmp_path / "Old.py"))
    assert host.wait(60) == 1
    assert line in system.log(host), system.log(host)
    assert "Traceback" not in system.log(host)


# What stops the host is on stderr also when the log goes to a file, and once when it does not.
@pytest.mark.parametrize("log", ["rtc.log", "stderr"])
@pytest.mark.parametrize("module, why", [
    ("Missing.so", 'module "Missing.so": not found; looked in '),
    ("Old.py", 'module "Old.py": Old.py:1: is Python 2: write print(...)'),
    ("Fails.py", ': its initialisation failed'),
])
def test_what_stops_the_host_is_on_stderr(tmp_path, log, module, why):
    (tmp_path / "Old.py").write_text("print 1\n")
    (tmp_path / "Fails.py").write_text("""import OpenRTM_aist
class Fails(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        raise ValueError("no reason")
def FailsInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=["implementation_id", "Fails", "language", "Python", ""]), Fails, OpenRTM_aist.Delete)
""")
    host = subprocess.run([f"{bin_dir}/rtcd", "-o", "naming.enable:NO", "-o", f"logger.file_name:{log}",
                           "-o", "manager.modules.load_path:.", module], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert host.returncode == 1
    lines = [line for line in host.stderr.splitlines() if why in line]
    assert len(lines) == 1 and lines[0].startswith("rtcd: ") == (log != "stderr"), host.stderr
    assert host.stderr.splitlines()[-1] == "rtcd: not everything on the command line could be created"
