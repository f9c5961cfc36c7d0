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
                                             ('OutPort("number", self._d_number)', 'OutPort("number")')])
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


def test_the_component_of_the_page_runs(tmp_path):
    (tmp_path / "Counter.py").write_text(component_of_the_page().replace(
        "    manager.runManager()", "    print('made', manager.getComponent('Counter0').getTypeName())\n    manager.runManager(True)\n    manager.shutdown()"))
    ran = subprocess.run([python, "-B", "Counter.py", "-o", "corba.nameservers:127.0.0.1:9"], cwd=tmp_path, capture_output=True, text=True,
                         timeout=120)
    assert "made Counter" in ran.stdout, ran.stdout + ran.stderr
