"""Calls any object by its IDL, over the small ORB of giop.py: what a tool of another make is to our processes. One thread at a time."""

import json
import os
import subprocess
import types

from giop import SystemException

here = os.path.dirname(os.path.abspath(__file__))


class Idl:
    """The declarations of IDL files, and values of their types to octets and back. Structs are namespaces, enumerators their names, nil is None."""

    def __init__(self, folder, *files):
        self.found = {'CORBA::Object': {'kind': 'interface', 'id': 'IDL:omg.org/CORBA/Object:1.0', 'bases': [], 'operations': {}}}
        for file in files:
            text = subprocess.run(['omniidl', '-p', here, '-bidl_json', '-I' + folder, file if os.path.isabs(file) else f'{folder}/{file}'],
                                  capture_output=True, text=True, check=True).stdout
            for name, declared in json.loads(text).items():
                # A forward declaration says less.
                if name not in self.found or declared.get('operations') or declared['kind'] != 'interface':
                    self.found[name] = declared

    def interface(self, name):
        return self.found[name]

    def operation(self, name, operation):
        declared = self.found[name]
        if operation in declared['operations']:
            return declared['operations'][operation]
        for base in declared['bases']:
            if found := self.operation(base, operation):
                return found
        return None

    def all_ids(self, name):
        declared = self.found[name]
        return {declared['id']}.union(*(self.all_ids(base) for base in declared['bases']))

    def struct(self, name, /, **values):
        members = [member for member, _ in self.found[name]['members']]
        assert sorted(members) == sorted(values), f'{name} has {members}'
        return types.SimpleNamespace(**values)

    def write(self, out, kind, value):
        if kind == 'string':
            out.string(value)
        elif kind == 'any':
            out.any(value)
        elif isinstance(kind, str):
            out.number(kind, value)
        elif kind[0] == 'sequence':
            if kind[1] == 'B':
                out.octets(value)
            else:
                out.sequence(value, lambda one: self.write(out, kind[1], one))
        elif kind[0] == 'name':
            declared = self.found[kind[1]]
            if declared['kind'] == 'alias':
                self.write(out, declared['type'], value)
            elif declared['kind'] == 'enum':
                out.ulong(declared['words'].index(value))
            elif declared['kind'] == 'interface':
                out.ior(value.ior if isinstance(value, Remote) else value)
            else:
                for member, type_ in declared['members']:
                    self.write(out, type_, getattr(value, member))
        else:
            raise ValueError(f'no way to write {kind}')

    def read(self, data, kind, orb=None):
        if kind == 'void':
            return None
        if kind == 'string':
            return data.string()
        if kind == 'any':
            return data.any()
        if isinstance(kind, str):
            return data.number(kind)
        if kind[0] == 'sequence':
            return data.octets() if kind[1] == 'B' else data.sequence(lambda: self.read(data, kind[1], orb))
        declared = self.found[kind[1]]
        if declared['kind'] == 'alias':
            return self.read(data, declared['type'], orb)
        if declared['kind'] == 'enum':
            return declared['words'][data.ulong()]
        if declared['kind'] == 'interface':
            ior = data.ior()
            return Remote(self, orb, ior, kind[1]) if ior else None
        return types.SimpleNamespace(**{member: self.read(data, type_, orb) for member, type_ in declared['members']})


class Remote:
    """remote.operation(in and inout arguments) -> the result, or a tuple of the result and what came out."""

    def __init__(self, idl, orb, ior, interface):
        self.idl, self.orb, self.ior, self.interface = idl, orb, ior, interface

    def narrow(self, interface):
        return Remote(self.idl, self.orb, self.ior, interface) if self.is_a(self.idl.interface(interface)['id']) else None

    def is_a(self, repository_id):
        return bool(self.orb.invoke(self.ior, '_is_a', lambda out: out.string(repository_id)).octet())

    def is_gone(self):
        return bool(self.orb.invoke(self.ior, '_non_existent').octet())

    def __getattr__(self, operation):
        declared = self.idl.operation(self.interface, operation)
        if declared is None:
            raise AttributeError(f'{self.interface} has no operation {operation}')

        def call(*arguments):
            given = iter(arguments)
            values = [(kind, next(given)) for direction, kind in declared['parameters'] if direction != 'out']

            def write(out):
                for kind, value in values:
                    self.idl.write(out, kind, value)

            answer = self.orb.invoke(self.ior, operation, write)
            results = [] if declared['result'] == 'void' else [self.idl.read(answer, declared['result'], self.orb)]
            results += [self.idl.read(answer, kind, self.orb) for direction, kind in declared['parameters'] if direction != 'in']
            assert answer.position >= len(answer.data), f'{operation}: octets behind the answer'
            return results[0] if len(results) == 1 else tuple(results) or None

        return call


class Servant:
    """An object whose operations are the methods of `behaviour` with their names; what it has not is answered with NO_IMPLEMENT."""

    def __init__(self, idl, orb, interface, behaviour):
        self.idl, self.orb, self.interface, self.behaviour = idl, orb, interface, behaviour
        self.ior = orb.add(idl.interface(interface)['id'], self.call, idl.all_ids(interface))

    def call(self, operation, data, out):
        declared = self.idl.operation(self.interface, operation)
        method = getattr(self.behaviour, operation, None)
        if declared is None or method is None:
            raise SystemException('NO_IMPLEMENT')
        given = [self.idl.read(data, kind, self.orb) for direction, kind in declared['parameters'] if direction != 'out']
        result = method(*given)
        if declared['result'] != 'void':
            self.idl.write(out, declared['result'], result)
