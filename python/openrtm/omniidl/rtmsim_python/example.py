"""An example of servants, to fill in (-Wbexample)."""
from omniidl import idlast, idltype, idlutil

from .names import identifier


_EXAMPLE_HEAD = '''\
#!/usr/bin/env python3
# -*- coding: utf-8 -*-
"""Servants for the interfaces of {file}: fill in the operations."""

import sys

import omniORB
from omniORB import CORBA, PortableServer
{imports}
'''

_EXAMPLE_CLASS = '''

class {name}_i({poa}):
    """Servant of {scoped}."""

    def __init__(self):
        """Prepare the values that the operations use."""
'''

_EXAMPLE_OPERATION = '''
    # {signature}
    def {name}(self{arguments}):
        raise CORBA.NO_IMPLEMENT(0, CORBA.COMPLETED_NO)
        # {must}: {results}
'''

_EXAMPLE_MAIN = '''

if __name__ == "__main__":
    orb = CORBA.ORB_init(sys.argv)
    poa = orb.resolve_initial_references("RootPOA")
    servant = {name}_i()
    poa.activate_object(servant)
    poa._get_the_POAManager().activate()
    print(orb.object_to_string(servant._this()))
    orb.run()
'''


def interfaces_of(declarations):
    for node in declarations:
        if not node.mainFile():
            continue
        if isinstance(node, idlast.Module):
            yield from interfaces_of(node.definitions())
        elif isinstance(node, idlast.Interface):
            yield node


def example(tree, stub):
    modules = []
    for name in stub.modules_seen:
        top = name.split(".")[0]
        if top not in modules:
            modules.append(top)
    imports = "".join("import %s, %s__POA\n" % (name, name) for name in modules)
    text = _EXAMPLE_HEAD.format(file=stub.main, imports=imports)
    last = None
    for node in interfaces_of(tree.declarations()):
        scope = node.scopedName()
        if len(scope) == 1:
            scope = [stub.options.global_module] + scope
        poa = ".".join([scope[0] + "__POA"] + [identifier(part) for part in scope[1:]])
        last = node.identifier()
        text += _EXAMPLE_CLASS.format(name=last, poa=poa, scoped=idlutil.ccolonName(node.scopedName()))
        for one in all_callables(node):
            text += example_operation(one)
    return text + (_EXAMPLE_MAIN.format(name=last) if last else "")


# With those of the bases.
def all_callables(node):
    found = list(node.callables())
    for base in node.inherits():
        base = base.fullDecl() if hasattr(base, "fullDecl") else base
        found += [one for one in all_callables(base) if one not in found]
    return found


def example_operation(one):
    if isinstance(one, idlast.Attribute):
        text = ""
        for declarator in one.declarators():
            name = declarator.identifier()
            text += _EXAMPLE_OPERATION.format(signature="attribute " + name, name="_get_" + name, arguments="",
                                              must="Must return", results="the value")
            if not one.readonly():
                text += _EXAMPLE_OPERATION.format(signature="attribute " + name, name="_set_" + name, arguments=", value",
                                                  must="Must return", results="None")
        return text
    results = ["result"] if one.returnType().kind() != idltype.tk_void else []
    results += [identifier(p.identifier()) for p in one.parameters() if p.is_out()]
    signature = "%s(%s)" % (one.identifier(), ", ".join(
        ("in ", "out ", "inout ")[p.direction()] + p.identifier() for p in one.parameters()))
    return _EXAMPLE_OPERATION.format(
        signature=signature, name=identifier(one.identifier()),
        arguments="".join(", " + identifier(p.identifier()) for p in one.parameters() if p.is_in()),
        must="Must return", results=", ".join(results) or "None")
