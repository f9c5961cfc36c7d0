"""The stub file of an IDL file: descriptors, classes, references and skeletons."""
import os
import sys

from omniidl import idlast, idltype

from .names import BASIC, identifier, module_of
from .types import Types


class Stub:
    def __init__(self, tree, options):
        self.tree = tree
        self.options = options
        self.main = os.path.basename(tree.file())
        self.module = module_of(tree.file())
        self.lines = []
        self.modules_seen = []  # dotted
        self.recursive = []     # repository ids of what is being defined
        self.types = Types(options)
        self.types.module(tree.declarations(), [])

    def put(self, text=""):
        self.lines.append(text)

    def text(self):
        self.put("# Python stubs made by omniidl from %s" % self.main)
        self.put("import omniORB, _omnipy")
        self.put("from omniORB import CORBA, PortableServer")
        self.put("_0_CORBA = CORBA")
        self.put()
        self.put("_omnipy.checkVersion(4,2, __file__, 1)" if not self.options.stdout else '_omnipy.checkVersion(4,2, "<stdin>", 1)')
        self.put()
        if not self.options.inline:
            self.import_included()
        self.opened = []
        for declaration in self.tree.declarations():
            if declaration.mainFile() or self.options.inline:
                self.declare(declaration, [])
            else:
                self.open_all(declaration, [])
        self.put()
        self.put("_exported_modules = (%s)" % "".join('"%s", ' % name for name in self.modules_seen))
        return "\n".join(self.lines) + "\n"

    def import_included(self):
        files = []
        for declaration in self.tree.declarations():
            self.find_files(declaration, files)
        for file in files:
            base = os.path.basename(file)
            stem = base[:-4] if base.endswith(".idl") else base
            package = self.options.stubs
            for name in (file, base, stem):
                if name in self.options.extern:
                    package = self.options.extern[name]
                    package = package + "." if package else None
            if package is not None:
                self.put("# #include \"%s\"" % base)
                self.put("import %s%s" % (package, module_of(file)))
        if files:
            self.put()

    def find_files(self, declaration, files):
        if not declaration.mainFile() and declaration.file() not in files and not self.is_only_forward(declaration):
            files.append(declaration.file())
        if isinstance(declaration, idlast.Module):
            for one in declaration.definitions():
                self.find_files(one, files)

    @staticmethod
    def is_only_forward(declaration):
        return isinstance(declaration, idlast.Forward)

    def open_all(self, declaration, scope):
        if isinstance(declaration, idlast.Module):
            self.open_module(scope + [declaration.identifier()])
            for one in declaration.definitions():
                self.open_all(one, scope + [declaration.identifier()])

    # The variable of a module is _0_ and its names, joined by dots: _0_A.B is an attribute of _0_A.
    def open_module(self, scope):
        name = ".".join(identifier(part) for part in scope)
        if name in self.opened:
            return
        self.opened.append(name)
        full = self.options.modules + name
        poa = ".".join([identifier(scope[0]) + "__POA"] + [identifier(part) for part in scope[1:]])
        if len(scope) == 1:
            self.put('_0_%s = omniORB.openModule("%s", r"%s")' % (name, full, self.main))
            self.put('_0_%s = omniORB.openModule("%s", r"%s")' % (poa, self.options.modules + poa, self.main))
        else:
            self.put('_0_%s = omniORB.openModule("%s", r"%s")' % (name, full, self.main))
            self.put('_0_%s = omniORB.openModule("%s", r"%s")' % (poa, self.options.modules + poa, self.main))

    # How a scope is written in the stub file.
    def place(self, scope):
        if not scope:
            scope = [self.options.global_module]
            self.open_module(scope)
        return "_0_" + ".".join(identifier(part) for part in scope)

    def seen(self, scope):
        name = ".".join(identifier(part) for part in scope) or self.options.global_module
        if name not in self.modules_seen:
            self.modules_seen.append(name)

    def declare(self, node, scope):
        kinds = [(idlast.Module, self.module_), (idlast.Interface, self.interface), (idlast.Forward, self.forward),
                 (idlast.Const, self.const), (idlast.Typedef, self.typedef), (idlast.Exception, self.exception),
                 (idlast.Struct, self.struct), (idlast.StructForward, self.struct_forward),
                 (idlast.UnionForward, self.struct_forward), (idlast.Union, self.union), (idlast.Enum, self.enum)]
        for kind, function in kinds:
            if isinstance(node, kind):
                if not scope and kind is not idlast.Module:
                    self.seen([])
                function(node, scope)
                return
        sys.stderr.write("%s:%d: warning: the Python back end leaves out %s: value types and their kin are not supported\n"
                         % (node.file(), node.line(), type(node).__name__))

    def module_(self, node, scope):
        inner = scope + [node.identifier()]
        self.put()
        self.put('# Module "%s"' % ".".join(inner))
        for count in range(1, len(inner) + 1):
            self.open_module(inner[:count])
        self.put('__name__ = "%s"' % (self.options.modules + ".".join(identifier(part) for part in inner)))
        self.seen(inner)
        for one in node.definitions():
            if one.mainFile() or self.options.inline:
                self.declare(one, inner)
        self.put('__name__ = "%s"' % (self.options.stubs + self.module))

    # --- types as descriptors

    def descriptor(self, type_):
        kind = type_.kind()
        if kind in BASIC:
            return "omniORB.tcInternal.tv_" + BASIC[kind]
        if kind == idltype.tk_string:
            return "(omniORB.tcInternal.tv_string,%d)" % type_.bound()
        if kind == idltype.tk_wstring:
            return "(omniORB.tcInternal.tv_wstring,%d)" % type_.bound()
        if kind == idltype.tk_sequence:
            return "(omniORB.tcInternal.tv_sequence, %s, %d)" % (self.descriptor(type_.seqType()), type_.bound())
        if kind == idltype.tk_fixed:
            return "(omniORB.tcInternal.tv_fixed, %d, %d)" % (type_.digits(), type_.scale())
        name = type_.scopedName()
        if name == ["CORBA", "Object"]:
            return 'omniORB.typeMapping["IDL:omg.org/CORBA/Object:1.0"]'
        declaration = type_.decl()
        if declaration.repoId() in self.recursive:
            return '(omniORB.tcInternal.tv__indirect, ["%s"])' % declaration.repoId()
        return 'omniORB.typeMapping["%s"]' % declaration.repoId()

    def declared(self, type_, declarator):
        text = self.descriptor(type_)
        for size in reversed(declarator.sizes()):
            text = "(omniORB.tcInternal.tv_array, %s, %d)" % (text, size)
        return text

    # --- declarations

    def header(self, kind, name):
        self.put()
        self.put("# %s %s" % (kind, name))

    def forward(self, node, scope):
        name = identifier(node.identifier())
        place = self.place(scope)
        self.header("forward interface", name)
        self.put('%s._d_%s = (omniORB.tcInternal.tv_objref, "%s", "%s")' % (place, name, node.repoId(), node.identifier()))
        self.put('omniORB.typeMapping["%s"] = %s._d_%s' % (node.repoId(), place, name))

    def struct_forward(self, node, scope):
        self.put('omniORB.typeMapping.setdefault("%s", (omniORB.tcInternal.tv__indirect, ["%s"]))' % (node.repoId(), node.repoId()))

    def const(self, node, scope):
        name = identifier(node.identifier())
        self.header("constant", name)
        self.put("%s.%s = %s" % (self.place(scope), name, self.value(node.constType(), node.value())))

    def value(self, type_, value):
        kind = type_.unalias().kind()
        if kind == idltype.tk_enum:
            return self.place(value.scopedName()[:-1]) + "." + identifier(value.identifier())
        if kind == idltype.tk_wstring and isinstance(value, list):
            return repr("".join(chr(one) for one in value))
        if kind == idltype.tk_wchar and isinstance(value, int):
            return repr(chr(value))
        if kind == idltype.tk_boolean:
            return str(bool(value))
        return repr(value)

    def typedef(self, node, scope):
        place = self.place(scope)
        if node.constrType():
            self.declare(node.aliasType().decl(), scope)
        for declarator in node.declarators():
            name = identifier(declarator.identifier())
            text = self.declared(node.aliasType(), declarator)
            self.header("typedef ...", name)
            self.put("class %s:" % name)
            self.put('    _NP_RepositoryId = "%s"' % declarator.repoId())
            self.put("    def __init__(self, *args, **kw):")
            self.put('        raise RuntimeError("Cannot construct objects of this type.")')
            self.put("%s.%s = %s" % (place, name, name))
            self.put("%s._d_%s = %s" % (place, name, text))
            self.put('%s._ad_%s = (omniORB.tcInternal.tv_alias, %s._NP_RepositoryId, "%s", %s._d_%s)'
                     % (place, name, name, declarator.identifier(), place, name))
            self.register(place, name, "_ad_")

    def register(self, place, name, prefix="_d_"):
        self.put("%s._tc_%s = omniORB.tcInternal.createTypeCode(%s.%s%s)" % (place, name, place, prefix, name))
        self.put("omniORB.registerType(%s._NP_RepositoryId, %s.%s%s, %s._tc_%s)" % (name, place, prefix, name, place, name))
        self.put("del %s" % name)

    def constructed(self, type_, scope):
        if isinstance(type_, idltype.Declared):
            self.declare(type_.decl(), scope)

    def record(self, node, scope, kind):
        name = identifier(node.identifier())
        place = self.place(scope)
        inner = scope + [node.identifier()]
        self.header(kind, name)
        nested = [member for member in node.members() if member.constrType()]
        base = "omniORB.StructBase" if kind == "struct" else "CORBA.UserException"
        self.put("class %s (%s):" % (name, base))
        self.put('    _NP_RepositoryId = "%s"' % node.repoId())
        members = [(member, declarator) for member in node.members() for declarator in member.declarators()]
        names = [identifier(declarator.identifier()) for _, declarator in members]
        self.put()
        self.put("    def __init__(self%s):" % "".join(", " + one for one in names))
        if kind == "exception":
            self.put("        CORBA.UserException.__init__(self%s)" % "".join(", " + one for one in names))
        for one in names:
            self.put("        self.%s = %s" % (one, one))
        if not names:
            self.put("        pass")
        self.put("%s.%s = %s" % (place, name, name))
        self.recursive.append(node.repoId())
        for member in nested:
            self.constructed(member.memberType(), inner)
        parts = ['%s, %s._NP_RepositoryId, "%s"' % (name, name, node.identifier())]
        for member, declarator in members:
            parts.append('"%s", %s' % (identifier(declarator.identifier()), self.declared(member.memberType(), declarator)))
        self.recursive.pop()
        self.put("%s._d_%s = (omniORB.tcInternal.tv_%s, %s)" % (place, name, "struct" if kind == "struct" else "except", ", ".join(parts)))
        self.register(place, name)

    def struct(self, node, scope):
        self.record(node, scope, "struct")

    def exception(self, node, scope):
        self.record(node, scope, "exception")

    def enum(self, node, scope):
        name = identifier(node.identifier())
        place = self.place(scope)
        self.header("enum", name)
        items = []
        for number, enumerator in enumerate(node.enumerators()):
            item = place + "." + identifier(enumerator.identifier())
            self.put('%s = omniORB.EnumItem("%s", %d)' % (item, enumerator.identifier(), number))
            items.append(item)
        self.put('%s.%s = omniORB.Enum("%s", (%s,))' % (place, name, node.repoId(), ", ".join(items)))
        self.put('%s._d_%s = (omniORB.tcInternal.tv_enum, %s.%s._NP_RepositoryId, "%s", %s.%s._items)'
                 % (place, name, place, name, node.identifier(), place, name))
        self.put("%s._tc_%s = omniORB.tcInternal.createTypeCode(%s._d_%s)" % (place, name, place, name))
        self.put("omniORB.registerType(%s.%s._NP_RepositoryId, %s._d_%s, %s._tc_%s)" % (place, name, place, name, place, name))

    def union(self, node, scope):
        name = identifier(node.identifier())
        place = self.place(scope)
        inner = scope + [node.identifier()]
        self.header("union", name)
        self.put("class %s (omniORB.Union):" % name)
        self.put('    _NP_RepositoryId = "%s"' % node.repoId())
        self.put("%s.%s = %s" % (place, name, name))
        self.recursive.append(node.repoId())
        if node.constrType():
            self.constructed(node.switchType(), inner)
        for case in node.cases():
            if case.constrType():
                self.constructed(case.caseType(), inner)
        labels, default_at, default_label = [], -1, None
        for case in node.cases():
            member = identifier(case.declarator().identifier())
            text = self.declared(case.caseType(), case.declarator())
            for label in case.labels():
                value = self.value(node.switchType(), label.value())
                if label.default():
                    default_at, default_label = len(labels), value
                labels.append((value, member, text, label.default()))
        self.recursive.pop()
        usual = [one for one in labels if not one[3]]
        default = next((one for one in labels if one[3]), None)
        self.put("%s._m_to_d = {%s}" % (name, ", ".join('"%s": %s' % (one[1], one[0]) for one in usual)))
        self.put("%s._d_to_m = {%s}" % (name, ", ".join('%s: "%s"' % (one[0], one[1]) for one in usual)))
        self.put("%s._def_m = %s" % (name, '"%s"' % default[1] if default else None))
        self.put("%s._def_d = %s" % (name, default_label))
        self.put("%s._m_%s = (%s)" % (place, name, "".join('(%s, "%s", %s), ' % one[:3] for one in labels)))
        self.put('%s._d_%s = (omniORB.tcInternal.tv_union, %s, %s._NP_RepositoryId, "%s", %s, %d, %s._m_%s, %s, {%s})' % (
            place, name, name, name, node.identifier(), self.descriptor(node.switchType()), default_at, place, name,
            "%s._m_%s[%d]" % (place, name, default_at) if default else None,
            ", ".join("%s: %s._m_%s[%d]" % (one[0], place, name, at) for at, one in enumerate(labels) if not one[3])))
        self.register(place, name)

    # --- interfaces

    def interface(self, node, scope):
        name = identifier(node.identifier())
        place = self.place(scope)
        poa = place.split(".", 1)
        poa[0] += "__POA"
        poa = ".".join(poa)
        self.header("interface", name)
        self.put('%s._d_%s = (omniORB.tcInternal.tv_objref, "%s", "%s")' % (place, name, node.repoId(), node.identifier()))
        self.put('omniORB.typeMapping["%s"] = %s._d_%s' % (node.repoId(), place, name))
        bases = [base.fullDecl() if hasattr(base, "fullDecl") else base for base in node.inherits()]
        named = [self.place(base.scopedName()[:-1]) + "." + identifier(base.identifier()) for base in bases]
        self.put("class %s%s:" % (name, " (%s)" % ", ".join(named) if named else " "))
        self.put("    _NP_RepositoryId = %s._d_%s[1]" % (place, name))
        self.put("    def __init__(self, *args, **kw):")
        self.put('        raise RuntimeError("Cannot construct objects of this type.")')
        self.put("    _nil = CORBA.Object._nil")
        self.put("%s.%s = %s" % (place, name, name))
        self.put("%s._tc_%s = omniORB.tcInternal.createTypeCode(%s._d_%s)" % (place, name, place, name))
        self.put("omniORB.registerType(%s._NP_RepositoryId, %s._d_%s, %s._tc_%s)" % (name, place, name, place, name))
        for one in node.declarations():
            self.declare(one, scope + [node.identifier()])
        operations = self.operations(node)
        for operation, text in operations:
            self.put("%s.%s._d_%s = %s" % (place, name, operation, text))
        self.objref(node, place, name, bases, operations)
        self.skeleton(node, place, poa, name, bases, operations)

    # (name, descriptor) of every operation and attribute.
    def operations(self, node):
        found = []
        for one in node.callables():
            if isinstance(one, idlast.Attribute):
                for declarator in one.declarators():
                    text = self.descriptor(one.attrType())
                    found.append(("_get_" + declarator.identifier(), "((),(%s,),None)" % text))
                    if not one.readonly():
                        found.append(("_set_" + declarator.identifier(), "((%s,),(),None)" % text))
                continue
            ins = [self.descriptor(p.paramType()) for p in one.parameters() if p.is_in()]
            outs = [self.descriptor(p.paramType()) for p in one.parameters() if p.is_out()]
            if one.returnType().kind() != idltype.tk_void:
                outs.insert(0, self.descriptor(one.returnType()))
            raises = ", ".join('"%s": omniORB.typeMapping["%s"]' % (e.repoId(), e.repoId()) for e in one.raises())
            as_tuple = lambda texts: "(%s)" % "".join(text + ", " for text in texts)
            found.append((identifier(one.identifier()), "(%s,%s,%s)" % (
                as_tuple(ins), None if one.oneway() else as_tuple(outs), "{%s}" % raises if raises else None)))
        return found

    @staticmethod
    def wire_name(operation):
        return operation[1:] if operation.startswith("_") and not operation.startswith(("_get_", "_set_")) else operation

    def objref(self, node, place, name, bases, operations):
        parents = [self.place(base.scopedName()[:-1]) + "._objref_" + identifier(base.identifier()) for base in bases]
        self.put()
        self.put("class _objref_%s (%s):" % (name, ", ".join(parents) or "CORBA.Object"))
        self.put("    _NP_RepositoryId = %s.%s._NP_RepositoryId" % (place, name))
        self.put("    def __init__(self, obj):")
        self.put("        CORBA.Object.__init__(self, obj)")
        for operation, _ in operations:
            self.put("    def %s(self, *args):" % operation)
            self.put('        return self._obj.invoke("%s", %s.%s._d_%s, args)' % (self.wire_name(operation), place, name, operation))
        written = dict(operations)
        for operation in written:
            if operation.startswith("_get_"):
                attribute = operation[5:]
                self.put("    %s = property(_get_%s%s)" % (identifier(attribute), attribute,
                                                           ", _set_" + attribute if "_set_" + attribute in written else ""))
        self.put("omniORB.registerObjref(%s._NP_RepositoryId, _objref_%s)" % (name, name))
        self.put("%s._objref_%s = _objref_%s" % (place, name, name))
        self.put("del %s, _objref_%s" % (name, name))

    def skeleton(self, node, place, poa, name, bases, operations):
        parents = []
        for base in bases:
            parent = self.place(base.scopedName()[:-1]).split(".", 1)
            parent[0] += "__POA"
            parents.append(".".join(parent) + "." + identifier(base.identifier()))
        self.put()
        self.put("class %s (%s):" % (name, ", ".join(parents) or "PortableServer.Servant"))
        self.put("    _NP_RepositoryId = %s.%s._NP_RepositoryId" % (place, name))
        self.put("    _omni_op_d = {%s}" % ", ".join(
            '"%s": %s.%s._d_%s' % (self.wire_name(operation), place, name, operation) for operation, _ in operations))
        for parent in parents:
            self.put("    _omni_op_d.update(%s._omni_op_d)" % parent)
        self.put("%s._omni_skeleton = %s" % (name, name))
        self.put("%s.%s = %s" % (poa, name, name))
        self.put("omniORB.registerSkeleton(%s._NP_RepositoryId, %s)" % (name, name))
        self.put("del %s" % name)
