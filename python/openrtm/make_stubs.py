"""Writes the type stubs of the package OpenRTM_aist to standard output: every public name, as the module has it.

usage: PYTHONPATH=build/release/python python3 -B python/openrtm/make_stubs.py > python/openrtm/packages/OpenRTM_aist/__init__.pyi
"""
import inspect
import re
import types

import OpenRTM_aist

# What signatures do not say.
RETURNS = {
    "Manager.init": "Manager", "Manager.instance": "Manager", "Manager.getConfig": "Properties", "Manager.getLogbuf": "Logger",
    "Manager.createComponent": "Optional[DataFlowComponentBase]", "Manager.getComponent": "Optional[DataFlowComponentBase]",
    "Manager.getComponents": "List[DataFlowComponentBase]", "Manager.registerFactory": "bool", "Manager.activateManager": "bool",
    "Manager.runManager": "None", "Manager.setModuleInitProc": "None", "Manager.shutdown": "None", "Manager.terminate": "None",
    "OutPort.write": "bool", "InPort.isEmpty": "bool", "DataFlowComponentBase.addInPort": "bool",
    "DataFlowComponentBase.addOutPort": "bool", "DataFlowComponentBase.addPort": "bool", "DataFlowComponentBase.bindParameter": "bool",
    "DataFlowComponentBase.getProperties": "Properties", "DataFlowComponentBase.getConfigService": "ConfigAdmin",
    "CorbaPort.registerProvider": "bool", "CorbaPort.registerConsumer": "bool", "CSPOutPort.write": "bool", "CSPOutPort.select": "bool",
    "CSPInPort.select": "bool", "setTimestamp": "None",
}
SIMPLE = {"bool", "int", "str", "float", "None"}


def names():
    found = {name for name in vars(OpenRTM_aist) if not name.startswith("_")} | set(OpenRTM_aist._LATER)
    values = {name: getattr(OpenRTM_aist, name) for name in found}
    return {name: value for name, value in sorted(values.items()) if getattr(value, "__name__", "") not in {"RTC", "RTC__POA", "OpenRTM",
            "OpenRTM__POA", "SDOPackage", "RTM"}}


def arguments(function, is_method):
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (ValueError, TypeError):
        return ("self, " if is_method else "") + "*args: Any, **kwargs: Any"
    words, has_star = [], False
    for number, one in enumerate(parameters):
        if number == 0 and is_method:
            words.append(one.name)
            continue
        if one.kind is one.KEYWORD_ONLY and not has_star:
            words.append("*")
            has_star = True
        star = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
        has_star = has_star or star == "*"
        words.append(star + one.name + ": Any" + ("" if one.default is one.empty else " = ..."))
    return ", ".join(words)


def result(owner, name, function):
    if owner + name in RETURNS:
        return RETURNS[owner + name]
    if name == "__init__":
        return "None"
    said = re.search(r"-> (\w+)", getattr(function, "__doc__", None) or "") if not inspect.isfunction(function) else None
    return said.group(1) if said and said.group(1) in SIMPLE else "Any"


def members_of(cls):
    """Of the class and of those of its bases that are no names of the module."""
    known = set(id(value) for value in names().values())
    found = {}
    for base in reversed(cls.__mro__):
        if base is object or (base is not cls and id(base) in known) or base.__module__ == "pybind11_builtins":
            continue
        found.update(vars(base))
    return {name: value for name, value in found.items() if not name.startswith("_") or name in ("__init__", "__call__", "_ptr", "_this")}


def nearest_bases(cls):
    found = []
    for base in cls.__mro__[1:]:
        if names().get(base.__name__) is base and not any(issubclass(one, base) for one in found):
            found.append(base)
    return found


def class_lines(name, cls):
    if cls.__name__ != name and cls.__name__ in names():
        return ["%s = %s" % (name, cls.__name__)]
    bases = [base.__name__ for base in nearest_bases(cls)]
    lines = ["class %s%s:" % (name, "(%s)" % ", ".join(bases) if bases else "")]
    for member, value in sorted(members_of(cls).items()):
        if isinstance(value, (staticmethod, classmethod)):
            lines += ["    @%s" % type(value).__name__,
                      "    def %s(%s) -> %s: ..." % (member, arguments(value.__func__, isinstance(value, classmethod)),
                                                     result(name + ".", member, value.__func__))]
        elif isinstance(value, property):
            lines += ["    @property", "    def %s(self) -> Any: ..." % member]
        elif callable(value) and not isinstance(value, type):
            lines.append("    def %s(%s) -> %s: ..." % (member, arguments(value, True), result(name + ".", member, value)))
        else:
            lines.append("    %s: %s" % (member, "int" if type(value) is int else "Any"))
    return lines if len(lines) > 1 else [lines[0] + " ..."]


def main():
    print('# Made by make_stubs.py.\nfrom typing import Any, List, Optional\n')
    aliases = []
    for name, value in names().items():
        if isinstance(value, types.ModuleType):
            print("%s: Any" % name)
        elif isinstance(value, type):
            lines = class_lines(name, value)
            if " = " in lines[0] and not lines[0].startswith("class"):
                aliases.append(lines[0])
            else:
                print("\n" + "\n".join(lines))
        elif callable(value):
            print("\ndef %s(%s) -> %s: ..." % (name, arguments(value, False), result("", name, value)))
        else:
            print("%s: %s" % (name, "int" if type(value) is int else "str" if type(value) is str else "Any"))
    print("\n" + "\n".join(aliases))


if __name__ == "__main__":
    main()
