"""A back end of omniidl that prints what the files declare as JSON: omniidl -p FOLDER -bidl_json X.idl. See idl_client.py."""

import json

from omniidl import idlast, idltype

PLAIN = {idltype.tk_void: 'void', idltype.tk_short: 'h', idltype.tk_long: 'i', idltype.tk_ushort: 'H', idltype.tk_ulong: 'I',
         idltype.tk_longlong: 'q', idltype.tk_ulonglong: 'Q', idltype.tk_float: 'f', idltype.tk_double: 'd', idltype.tk_boolean: '?',
         idltype.tk_octet: 'B', idltype.tk_char: 'c', idltype.tk_string: 'string', idltype.tk_any: 'any', idltype.tk_TypeCode: 'TypeCode'}


def type_of(kind):
    """'i', 'string', ... or ['sequence', type], ['name', 'RTC::PortService'], ['array', type, length]."""
    if isinstance(kind, idltype.Sequence):
        return ['sequence', type_of(kind.seqType())]
    if isinstance(kind, idltype.Declared):
        return ['name', '::'.join(kind.scopedName())]
    return PLAIN.get(kind.kind(), 'unknown')


def members_of(node):
    members = []
    for member in node.members():
        for declarator in member.declarators():
            members.append((declarator.identifier(), sized(type_of(member.memberType()), declarator)))
    return members


def sized(kind, declarator):
    for size in reversed(declarator.sizes()):
        kind = ['array', kind, size]
    return kind


def add(found, node):
    if isinstance(node, idlast.Module):
        for inner in node.definitions():
            add(found, inner)
        return
    name = '::'.join(node.scopedName()) if hasattr(node, 'scopedName') else ''
    if isinstance(node, idlast.Interface):
        found[name] = {'kind': 'interface', 'id': node.repoId(), 'bases': ['::'.join(base.scopedName()) for base in node.inherits()],
                       'operations': {operation.identifier(): {
                           'result': type_of(operation.returnType()), 'oneway': bool(operation.oneway()),
                           'parameters': [(['in', 'out', 'inout'][p.direction()], type_of(p.paramType())) for p in operation.parameters()]}
                           for operation in node.callables() if isinstance(operation, idlast.Operation)}}
        for inner in node.declarations():
            add(found, inner)
    elif isinstance(node, idlast.Forward):
        found.setdefault(name, {'kind': 'interface', 'id': node.repoId(), 'bases': [], 'operations': {}})
    elif isinstance(node, (idlast.Struct, idlast.Exception)):
        found[name] = {'kind': 'struct', 'id': node.repoId(), 'members': members_of(node)}
    elif isinstance(node, idlast.Enum):
        found[name] = {'kind': 'enum', 'id': node.repoId(), 'words': [word.identifier() for word in node.enumerators()]}
    elif isinstance(node, idlast.Union):
        found[name] = {'kind': 'union', 'id': node.repoId()}
    elif isinstance(node, idlast.Typedef):
        for declarator in node.declarators():
            found['::'.join(declarator.scopedName())] = {'kind': 'alias', 'type': sized(type_of(node.aliasType()), declarator)}


def run(tree, args):
    found = {}
    for node in tree.declarations():
        add(found, node)
    print(json.dumps(found))
