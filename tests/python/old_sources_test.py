# Sources that were written for Python 2, loaded by rtcd.
import pytest

from component_test import system  # noqa: F401: a fixture


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
