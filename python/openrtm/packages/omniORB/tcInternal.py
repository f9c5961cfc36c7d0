"""Kinds of types, and type codes over descriptors."""
tv_null, tv_void, tv_short, tv_long, tv_ushort, tv_ulong, tv_float, tv_double, tv_boolean, tv_char, tv_octet, tv_any, tv_TypeCode = range(13)
tv_Principal, tv_objref, tv_struct, tv_union, tv_enum, tv_string, tv_sequence, tv_array, tv_alias, tv_except = range(13, 23)
tv_longlong, tv_ulonglong, tv_longdouble, tv_wchar, tv_wstring, tv_fixed, tv_value, tv_value_box, tv_native = range(23, 32)
tv_abstract_interface, tv_local_interface = 32, 33
tv__indirect = 0xffffffff

_NAMES = ("tk_null tk_void tk_short tk_long tk_ushort tk_ulong tk_float tk_double tk_boolean tk_char tk_octet tk_any tk_TypeCode "
          "tk_Principal tk_objref tk_struct tk_union tk_enum tk_string tk_sequence tk_array tk_alias tk_except tk_longlong "
          "tk_ulonglong tk_longdouble tk_wchar tk_wstring tk_fixed tk_value tk_value_box tk_native tk_abstract_interface "
          "tk_local_interface").split()

from . import Enum as _Enum, EnumItem as _EnumItem  # noqa: E402

kinds = tuple(_EnumItem(name, number) for number, name in enumerate(_NAMES))
TCKind = _Enum("IDL:omg.org/CORBA/TCKind:1.0", kinds)


class TypeCode:
    """A type code: the descriptor _d and what follows from it."""

    def __init__(self, descriptor):
        from . import CORBA, typeMapping
        if isinstance(descriptor, str):
            if descriptor not in typeMapping:
                raise CORBA.BAD_PARAM(0, CORBA.COMPLETED_NO)
            descriptor = typeMapping[descriptor]
        elif isinstance(descriptor, type):
            descriptor = typeMapping[descriptor._NP_RepositoryId]
        self._d = descriptor

    @property
    def _k(self):
        return kinds[_number(self._d)]

    def kind(self):
        return kinds[_number(self._d)]

    def _full(self):
        from . import typeMapping
        descriptor = self._d
        if isinstance(descriptor, tuple) and descriptor[0] == tv__indirect:
            return typeMapping[descriptor[1][0]]
        return descriptor

    def _field(self, by_class, other):
        from . import CORBA
        descriptor = self._full()
        number = _number(descriptor)
        if number in (tv_struct, tv_union, tv_except):
            return descriptor[by_class]
        if number in (tv_enum, tv_alias, tv_objref):
            return descriptor[other]
        raise CORBA.TypeCode.BadKind()

    def id(self):
        return self._field(2, 1)

    def name(self):
        return self._field(3, 2)

    def member_count(self):
        from . import CORBA
        descriptor = self._full()
        number = _number(descriptor)
        if number in (tv_struct, tv_except):
            return (len(descriptor) - 4) // 2
        if number == tv_union:
            return len(descriptor[6])
        if number == tv_enum:
            return len(descriptor[3])
        raise CORBA.TypeCode.BadKind()

    def member_name(self, index):
        descriptor = self._full()
        number = _number(descriptor)
        if number == tv_enum:
            return descriptor[3][index]._n
        return descriptor[6][index][1] if number == tv_union else descriptor[4 + 2 * index]

    def member_type(self, index):
        descriptor = self._full()
        return TypeCode(descriptor[6][index][2] if _number(descriptor) == tv_union else descriptor[5 + 2 * index])

    def length(self):
        descriptor = self._full()
        number = _number(descriptor)
        if number in (tv_string, tv_wstring):
            return descriptor[1]
        if number in (tv_sequence, tv_array):
            return descriptor[2]
        from . import CORBA
        raise CORBA.TypeCode.BadKind()

    def content_type(self):
        descriptor = self._full()
        number = _number(descriptor)
        if number in (tv_sequence, tv_array):
            return TypeCode(descriptor[1])
        if number == tv_alias:
            return TypeCode(descriptor[3])
        from . import CORBA
        raise CORBA.TypeCode.BadKind()

    def equal(self, other):
        return same(self._d, other._d)

    def equivalent(self, other):
        return same(unaliased(self._d), unaliased(other._d))

    __eq__ = equal

    def __hash__(self):
        return _number(self._d)

    def __repr__(self):
        try:
            return "CORBA.TypeCode(%r)" % self.id()
        except Exception:
            return "CORBA.TypeCode(CORBA.%s)" % self.kind()


def _number(descriptor):
    return descriptor[0] if isinstance(descriptor, tuple) else descriptor


def unaliased(descriptor):
    while isinstance(descriptor, tuple) and descriptor[0] == tv_alias:
        descriptor = descriptor[3]
    return descriptor


def same(one, two):
    if one is two:
        return True
    if _number(one) != _number(two) or isinstance(one, tuple) != isinstance(two, tuple):
        return False
    if not isinstance(one, tuple):
        return one == two
    number = one[0]
    if number in (tv_struct, tv_union, tv_except):
        return one[2] == two[2] and one[2] != "" or one[3:] == two[3:]
    if number in (tv_enum, tv_alias, tv_objref):
        return one[1] == two[1]
    if number in (tv_sequence, tv_array):
        return one[2] == two[2] and same(one[1], two[1])
    return one == two


def createTypeCode(descriptor, parent=None):
    return TypeCode(descriptor)


def descriptor(type_):
    """The descriptor of a type code, of a class of stubs, of a repository id, or the descriptor itself."""
    if isinstance(type_, TypeCode):
        return type_._d
    if isinstance(type_, (int, tuple)):
        return type_
    if isinstance(type_, str) or hasattr(type_, "_NP_RepositoryId"):
        return TypeCode(type_ if isinstance(type_, str) else type_._NP_RepositoryId)._d
    raise TypeError("a type code is expected, got %r" % (type_,))
