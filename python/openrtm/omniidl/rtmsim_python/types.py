"""Type stubs (*.pyi) of IDL definitions."""
from omniidl import idlast, idltype

from .names import BASIC, identifier


class Types:
    """The lines of type stubs, by module. Fields have the types that reading gives."""

    _NUMBERS = {idltype.tk_float: "float", idltype.tk_double: "float", idltype.tk_longdouble: "float", idltype.tk_boolean: "bool",
                idltype.tk_char: "str", idltype.tk_wchar: "str", idltype.tk_string: "str", idltype.tk_wstring: "str",
                idltype.tk_any: "Any", idltype.tk_TypeCode: "Any", idltype.tk_fixed: "Any", idltype.tk_void: "None",
                idltype.tk_null: "None"}

    def __init__(self, options):
        self.options = options
        self.lines = {}   # dotted module: lines

    def module(self, declarations, scope):
        for one in declarations:
            if isinstance(one, idlast.Module):
                self.module(one.definitions(), scope + [one.identifier()])
            elif one.mainFile() or self.options.inline:
                name = ".".join(identifier(part) for part in scope) or self.options.global_module
                lines = self.lines.setdefault(name, [])
                self.top = name.split(".")[0]
                self.tops = set()
                text = self.declared(one)
                lines[:0] = ["import " + top for top in sorted(self.tops) if "import " + top not in lines]
                lines.extend(text)

    def name(self, scoped):
        path = [identifier(part) for part in scoped]
        if len(path) == 1:
            path.insert(0, self.options.global_module)
        self.tops.add(path[0])
        return ".".join(path)

    def of(self, type_, sizes=()):
        if sizes:
            return self.many(type_, lambda: self.of(type_, sizes[1:]) if sizes[1:] else self.of(type_), not sizes[1:])
        kind = type_.kind()
        if kind == idltype.tk_alias:
            declarator = type_.decl()
            return self.of(declarator.alias().aliasType(), tuple(declarator.sizes()))
        if kind == idltype.tk_sequence:
            return self.many(type_.seqType(), lambda: self.of(type_.seqType()), True)
        if kind in self._NUMBERS:
            return self._NUMBERS[kind]
        if kind in BASIC:
            return "int"
        if kind == idltype.tk_objref or type_.scopedName() == ["CORBA", "Object"]:
            return "Any"
        return self.name(type_.scopedName())

    @staticmethod
    def many(element, text, is_last):
        kind = element.kind()
        if is_last and kind in (idltype.tk_octet, idltype.tk_char):
            return "bytes" if kind == idltype.tk_octet else "str"
        return "List[%s]" % text()

    def declared(self, node):
        for kind, function in ((idlast.Struct, self.struct), (idlast.Exception, self.struct), (idlast.Enum, self.enum),
                               (idlast.Union, self.union), (idlast.Interface, self.interface), (idlast.Const, self.const),
                               (idlast.Typedef, self.typedef)):
            if isinstance(node, kind):
                return function(node)
        return []

    @staticmethod
    def extras(name):
        return ["_d_%s: Any" % name, "_tc_%s: Any" % name]

    def fields(self, node):
        found = []
        for member in node.members():
            for declarator in member.declarators():
                found.append((identifier(declarator.identifier()), self.of(member.memberType(), tuple(declarator.sizes()))))
        return found

    def struct(self, node):
        name, fields = identifier(node.identifier()), self.fields(node)
        arguments = "".join(", %s: %s" % field for field in fields)
        return (["class %s%s:" % (name, "(Exception)" if isinstance(node, idlast.Exception) else ""), "    _NP_RepositoryId: str"]
                + ["    %s: %s" % field for field in fields] + ["    def __init__(self%s) -> None: ..." % arguments] + self.extras(name))

    def enum(self, node):
        name, full = identifier(node.identifier()), self.name(node.scopedName())
        return (["class %s:" % name, "    _NP_RepositoryId: str", "    _items: Tuple[%s, ...]" % full, "    _n: str", "    _v: int",
                 "    @staticmethod", "    def _item(number: int) -> %s: ..." % full]
                + ["%s: %s" % (identifier(one.identifier()), full) for one in node.enumerators()] + self.extras(name))

    def union(self, node):
        name = identifier(node.identifier())
        fields = [(identifier(case.declarator().identifier()), self.of(case.caseType(), tuple(case.declarator().sizes())))
                  for case in node.cases()]
        return (["class %s:" % name, "    _NP_RepositoryId: str", "    _d: Any", "    _v: Any"] + ["    %s: %s" % field for field in fields]
                + ["    def __init__(self, *args: Any, **kw: Any) -> None: ..."] + self.extras(name))

    def const(self, node):
        return ["%s: %s" % (identifier(node.identifier()), self.of(node.constType()))]

    def typedef(self, node):
        return [line for one in node.declarators() for line in ["%s: Any" % identifier(one.identifier())] + self.extras(
            identifier(one.identifier()))]

    def interface(self, node):
        name = identifier(node.identifier())
        bases = [base.fullDecl() if hasattr(base, "fullDecl") else base for base in node.inherits()]
        lines = ["class %s(%s):" % (name, ", ".join(self.name(base.scopedName()) for base in bases) or "Object"),
                 "    _NP_RepositoryId: str"]
        for one in node.declarations():
            lines += ["    " + line for line in self.declared(one)]
        for one in node.callables():
            lines += ["    " + line for line in self.operation(one)]
        return lines + ["_objref_%s: Any" % name] + self.extras(name)

    def operation(self, one):
        if isinstance(one, idlast.Attribute):
            lines = []
            for declarator in one.declarators():
                lines.append("def _get_%s(self) -> %s: ..." % (declarator.identifier(), self.of(one.attrType())))
                if not one.readonly():
                    lines.append("def _set_%s(self, value: %s) -> None: ..." % (declarator.identifier(), self.of(one.attrType())))
                lines.append("%s: %s" % (identifier(declarator.identifier()), self.of(one.attrType())))
            return lines
        results = [] if one.returnType().kind() == idltype.tk_void else [self.of(one.returnType())]
        results += [self.of(p.paramType()) for p in one.parameters() if p.is_out()]
        given = "".join(", %s: %s" % (identifier(p.identifier()), self.of(p.paramType())) for p in one.parameters() if p.is_in())
        result = results[0] if len(results) == 1 else "Tuple[%s]" % ", ".join(results) if results else "None"
        return ["def %s(self%s) -> %s: ..." % (identifier(one.identifier()), given, result)]
