"""Names of IDL and their names in Python."""
import keyword
import os
import re

from omniidl import idltype

# The kinds whose descriptor is a number, and its name in tcInternal.
BASIC = {
    idltype.tk_null: "null", idltype.tk_void: "void", idltype.tk_short: "short", idltype.tk_long: "long",
    idltype.tk_ushort: "ushort", idltype.tk_ulong: "ulong", idltype.tk_float: "float", idltype.tk_double: "double",
    idltype.tk_boolean: "boolean", idltype.tk_char: "char", idltype.tk_octet: "octet", idltype.tk_any: "any",
    idltype.tk_TypeCode: "TypeCode", idltype.tk_longlong: "longlong", idltype.tk_ulonglong: "ulonglong",
    idltype.tk_longdouble: "longdouble", idltype.tk_wchar: "wchar",
}


def module_of(file):
    base = os.path.basename(file)
    if base.endswith(".idl"):
        base = base[:-4]
    return re.sub(r"\W", "_", base) + "_idl"


def identifier(name):
    return "_" + name if keyword.iskeyword(name) else name
