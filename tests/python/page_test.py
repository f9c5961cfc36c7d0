# Executes the Python blocks of docs/python.md in order, in one namespace, in a folder that looks like the project's.
import os
import pathlib
import re

import pytest
from conftest import source

page = (source / "docs" / "python.md").read_text()
blocks = re.findall(r"^```python\n(.*?)^```$", page, flags=re.M | re.S)


def test_the_blocks_of_the_page_run_as_written(tmp_path, monkeypatch):
    assert len(blocks) > 8
    for name in ("worlds", "python"):
        os.symlink(source / name, tmp_path / name)
    (tmp_path / "build").mkdir()
    os.symlink(pathlib.Path(os.environ["RTMSIM_BIN_DIR"]).parent, tmp_path / "build" / "release")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "page"}
    for number, block in enumerate(blocks, 1):
        if "import pytest" in block:  # a file of tests
            (tmp_path / f"test_block{number}.py").write_text(block)
            assert pytest.main(["-q", "-p", "no:cacheprovider", str(tmp_path / f"test_block{number}.py")]) == 0, block
            continue
        # Line numbers of a failure are those of the block.
        exec(compile(block, f"docs/python.md, block {number}", "exec"), names)


def test_every_name_that_the_module_offers_is_on_the_page_and_has_a_docstring():
    import inspect

    import rtmsim
    for name in rtmsim.__all__:
        value = getattr(rtmsim, name)
        assert value.__doc__, name
        assert name in page, name
        for member, one in inspect.getmembers(value):
            is_ours = inspect.isfunction(one) and one.__module__.startswith("rtmsim") or isinstance(one, property) and one.fget.__module__.startswith("rtmsim")
            if is_ours and not member.startswith("_"):
                assert one.__doc__, f"{name}.{member}"


# Names and arguments, by class: "Class.member" -> arguments.
def stubs():
    import ast
    found = {}
    tree = ast.parse((source / "python" / "rtmsim" / "__init__.pyi").read_text())
    for node in tree.body:
        for owner, one in [("", node)] if isinstance(node, ast.FunctionDef) else [(node.name + ".", item) for item in getattr(node, "body", [])] if isinstance(
                node, ast.ClassDef) else []:
            if isinstance(one, ast.FunctionDef):
                given = one.args
                # The first one of a property is its getter.
                found.setdefault(owner + one.name, [argument.arg for argument in given.posonlyargs + given.args + given.kwonlyargs])
    return found


def test_the_type_stubs_have_the_functions_and_arguments_of_the_module():
    import inspect

    import rtmsim
    from rtmsim import running, world
    told = stubs()
    real = {}
    for name in (*rtmsim.__all__, "Verdict", "Velocity"):
        value = getattr(rtmsim, name, None) or getattr(running, name, None) or getattr(world, name)
        if inspect.isfunction(value):
            real[name] = list(inspect.signature(value).parameters)
            continue
        for member, one in inspect.getmembers(value):
            is_ours = inspect.isfunction(one) and one.__module__.startswith("rtmsim") or isinstance(one, property) and one.fget.__module__.startswith("rtmsim")
            if is_ours and not member.startswith("_"):
                real[f"{name}.{member}"] = ["self"] if isinstance(one, property) else list(inspect.signature(one).parameters)
    for name, arguments in real.items():
        told_arguments = told.get(name)
        assert told_arguments is not None, f"{name} has no stub"
        assert told_arguments == [one for one in arguments if one not in ("topics", "names", "world_options")], name
    missing = [name for name in told if "._" not in name and name not in real]
    assert missing == [] or all(name.startswith("Env.") for name in missing), missing
