"""Values to and from CORBA.Any."""
from . import CORBA, EnumItem, StructBase, Union, tcInternal, typeCodeMapping, typeMapping


def _code(repo_id):
    code = typeCodeMapping.get(repo_id)
    return code if code is not None else tcInternal.TypeCode(typeMapping[repo_id])


def to_any(data):
    """CORBA.Any of a Python value: int by its size, float double, str string, bytes octets, list a sequence, dict a struct."""
    code, value = _to_tc_value(data)
    return CORBA.Any(code, value)


def _integer(data):
    if -0x80000000 <= data <= 0x7fffffff:
        return CORBA.TC_long
    if 0 <= data <= 0xffffffff:
        return CORBA.TC_ulong
    if -0x8000000000000000 <= data <= 0x7fffffffffffffff:
        return CORBA.TC_longlong
    if 0 <= data <= 0xffffffffffffffff:
        return CORBA.TC_ulonglong
    raise CORBA.BAD_PARAM(0, CORBA.COMPLETED_NO)


def _to_tc_value(data):
    if data is None:
        return CORBA.TC_null, None
    if isinstance(data, CORBA.Any):
        return CORBA.TC_any, data
    if isinstance(data, bool):
        return CORBA.TC_boolean, data
    if isinstance(data, int):
        return _integer(data), data
    if isinstance(data, float):
        return CORBA.TC_double, data
    if isinstance(data, str):
        return CORBA.TC_string, data
    if isinstance(data, (bytes, bytearray)):
        return tcInternal.TypeCode((tcInternal.tv_sequence, tcInternal.tv_octet, 0)), bytes(data)
    if isinstance(data, EnumItem):
        return _code(data._parent_id), data
    if isinstance(data, (StructBase, Union, CORBA.UserException)):
        return _code(data._NP_RepositoryId), data
    if isinstance(data, CORBA.Object):
        return _code(data._NP_RepositoryId), data
    if isinstance(data, (list, tuple)):
        return _sequence(list(data))
    if isinstance(data, dict):
        members, values = [], []
        for name, value in data.items():
            code, converted = _to_tc_value(value)
            members += [name, code._d]
            values.append(converted)
        cls = _anonymous_struct(tuple(members[::2]))
        return tcInternal.TypeCode((tcInternal.tv_struct, cls, "", "") + tuple(members)), cls(*values)
    if hasattr(data, "tolist"):
        return _to_tc_value(data.tolist())
    raise CORBA.BAD_PARAM(0, CORBA.COMPLETED_NO)


def _sequence(data):
    if not data:
        return tcInternal.TypeCode((tcInternal.tv_sequence, tcInternal.tv_any, 0)), []
    pairs = [_to_tc_value(one) for one in data]
    first = pairs[0][0]
    if all(tcInternal.same(code._d, first._d) for code, _ in pairs):
        return tcInternal.TypeCode((tcInternal.tv_sequence, first._d, 0)), [value for _, value in pairs]
    if all(isinstance(one, int) and not isinstance(one, bool) for one in data):
        for code, low, high in ((CORBA.TC_long, -2 ** 31, 2 ** 31), (CORBA.TC_longlong, -2 ** 63, 2 ** 63)):
            if all(low <= one < high for one in data):
                return tcInternal.TypeCode((tcInternal.tv_sequence, code._d, 0)), data
    return tcInternal.TypeCode((tcInternal.tv_sequence, tcInternal.tv_any, 0)), [CORBA.Any(code, value) for code, value in pairs]


_structs = {}  # by the names of their members


def _anonymous_struct(names):
    if names in _structs:
        return _structs[names]
    if len(_structs) > 1000:  # peers can send any number of them
        _structs.clear()

    class Struct(StructBase):
        _NP_RepositoryId = ""

        def __init__(self, *values):
            for name, value in zip(names, values):
                setattr(self, name, value)

        def _members(self):
            return names
    return _structs.setdefault(names, Struct)


def from_any(data, keep_structs=False):
    """The value of a CORBA.Any as plain Python; structs become dictionaries unless they are kept."""
    if not isinstance(data, CORBA.Any):
        raise CORBA.BAD_PARAM(0, CORBA.COMPLETED_NO)
    return _plain(data._v, keep_structs)


def _plain(value, keep_structs):
    if isinstance(value, CORBA.Any):
        return _plain(value._v, keep_structs)
    if isinstance(value, list):
        return [_plain(one, keep_structs) for one in value]
    if isinstance(value, StructBase) and not keep_structs:
        return {name: _plain(getattr(value, name), keep_structs) for name in value._members()}
    return value
