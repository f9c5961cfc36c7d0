# The type stubs of OpenRTM_aist, and the component of the page about components.
import os
import pathlib
import shutil
import subprocess

import pytest

root = pathlib.Path(__file__).resolve().parents[2]
python = "/usr/bin/python3"


def component_of_the_page():
    text = (root / "docs" / "python-components.md").read_text()
    return text.split("```text\n", 1)[1].split("```", 1)[0]


def test_the_stubs_have_every_name_of_the_module():
    made = subprocess.run([python, "-B", str(root / "python/openrtm/make_stubs.py")], capture_output=True, text=True, timeout=60, check=True)
    assert made.stdout == (root / "python/openrtm/packages/OpenRTM_aist/__init__.pyi").read_text(), "run python/openrtm/make_stubs.py"


@pytest.mark.skipif(not shutil.which("mypy"), reason="mypy is not installed")
@pytest.mark.parametrize("change, problem", [("", ""), ("manager.createComponent(", "manager.creatComponent("),
                                             ('OutPort("number", self._d_number)', 'OutPort("number")'),
                                             ("RTC.TimedLong(RTC.Time(0, 0), 0)", "RTC.TimedLong(RTC.Time(0, 0))"),
                                             ("RTC.TimedLong(RTC.Time(0, 0), 0)", "RTC.TimedLong(0, 0)"),
                                             ("self._d_number.data +=", "self._d_number.dta +="),
                                             ("return RTC.RTC_OK", "return RTC.RTC_OKAY")])
def test_a_type_checker_accepts_the_component_of_the_page_and_finds_slips(tmp_path, change, problem):
    text = component_of_the_page()
    assert change in text
    text = text.replace(change, problem) if change else text
    text = text.replace("def MyModuleInit(manager):", "def MyModuleInit(manager: OpenRTM_aist.Manager) -> None:")
    (tmp_path / "Counter.py").write_text(text)
    checked = subprocess.run(["mypy", "--check-untyped-defs", "--ignore-missing-imports", "--follow-imports=silent", "Counter.py"],
                             cwd=tmp_path, capture_output=True, text=True, timeout=120,
                             env={**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]})
    assert ("Success" in checked.stdout) == (not change), checked.stdout + checked.stderr


@pytest.mark.skipif(not shutil.which("mypy"), reason="mypy is not installed")
def test_the_type_stubs_of_our_idl_files_are_consistent():
    built = pathlib.Path(os.environ["PYTHONPATH"].split(os.pathsep)[0])
    stubs = [str(built / name / "__init__.pyi") for name in ("RTC", "OpenRTM", "SDOPackage", "RTM", "Img", "JARA_ARM", "CosNaming", "CSP")]
    checked = subprocess.run(["mypy", "--follow-imports=silent", "--ignore-missing-imports", *stubs], capture_output=True, text=True, timeout=120,
                             env={**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]}, cwd="/")
    assert "Success" in checked.stdout, checked.stdout + checked.stderr


def test_omniidl_writes_the_types_of_a_users_idl_file_beside_those_of_another(tmp_path):
    (tmp_path / "One.idl").write_text("module Mine { struct A { long x; sequence<octet> raw; double grid[2][3]; string name; }; };")
    (tmp_path / "Two.idl").write_text("""#include "One.idl"
module Mine {
  typedef sequence<A> As;
  enum Kind { here, there };
  exception Lost { string why; };
  interface Calls { Kind find(in As all, out long count) raises (Lost); };
  union U switch (long) { case 1: A first; default: string s; };
  const long most = 3;
};""")
    back_end = pathlib.Path(os.environ["PYTHONPATH"].split(os.pathsep)[0]) / "omniidl_backend"
    for file in ("One.idl", "Two.idl", "Two.idl"):
        subprocess.run(["omniidl", "-bpython", file], cwd=tmp_path, check=True, timeout=60, env={**os.environ, "PYTHONPATH": str(back_end)})
    text = (tmp_path / "Mine" / "__init__.pyi").read_text()
    assert text.count("class A:") == 1 and text.count("class Calls(") == 1
    for line in ("    x: int", "    raw: bytes", "    grid: List[List[float]]", "    def find(self, all: List[Mine.A]) -> Tuple[Mine.Kind, int]: ...",
                 "here: Mine.Kind", "most: int", "    why: str", "    s: str", "def __getattr__(name: str) -> Any: ..."):
        assert line in text, line


def test_omniidl_names_a_value_type_that_it_leaves_out(tmp_path):
    (tmp_path / "Value.idl").write_text("module Mine { valuetype V { public long x; }; struct A { long x; }; };")
    made = subprocess.run(["omniidl", "-bpython", "Value.idl"], cwd=tmp_path, capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONPATH": str(root / "python/openrtm/omniidl")})
    assert made.returncode == 0, made.stderr
    assert "Value.idl:1: warning: the Python back end leaves out Value: value types and their kin are not supported" in made.stderr
    assert "class A " in (tmp_path / "Value_idl.py").read_text()


def test_the_component_of_the_page_runs(tmp_path):
    (tmp_path / "Counter.py").write_text(component_of_the_page().replace(
        "    manager.runManager()", "    print('made', manager.getComponent('Counter0').getTypeName())\n    manager.runManager(True)\n    manager.shutdown()"))
    ran = subprocess.run([python, "-B", "Counter.py", "-o", "corba.nameservers:127.0.0.1:9"], cwd=tmp_path, capture_output=True, text=True,
                         timeout=120)
    assert "made Counter" in ran.stdout, ran.stdout + ran.stderr
