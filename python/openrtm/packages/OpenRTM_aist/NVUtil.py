"""Helpers for SDOPackage.NVList: lists of SDOPackage.NameValue."""
import SDOPackage
from omniORB import any as _any


def newNV(name, value):
    return SDOPackage.NameValue(name, _any.to_any(value))


newNVString = newNVChar = newNVShort = newNVLong = newNVFloat = newNVDouble = newNVAny = newNV


def copyFromProperties(nvs, properties):
    del nvs[:]
    for key in properties.propertyNames():
        nvs.append(newNV(key, properties.getProperty(key)))


def copyToProperties(properties, nvs):
    for one in nvs:
        value = _any.from_any(one.value, keep_structs=True)
        properties.setProperty(one.name, value if isinstance(value, str) else str(value))


def toProperties(nvs):
    """The list as Properties."""
    from _openrtm_core import Properties
    properties = Properties()
    copyToProperties(properties, nvs)
    return properties


def copy(to, from_):
    to[:] = list(from_)


def find(nvs, name):
    for one in nvs:
        if one.name == name:
            return one.value
    raise KeyError("%s: not found" % name)


def find_index(nvs, name):
    for number, one in enumerate(nvs):
        if one.name == name:
            return number
    return -1


def setValue(nvs, name, value):
    at = find_index(nvs, name)
    if at >= 0:
        nvs[at].value = value
    else:
        nvs.append(newNV(name, value))


def isString(nvs, name):
    return find_index(nvs, name) >= 0 and isinstance(find(nvs, name).value(), str)


def isStringValue(nvs, name, value):
    return isString(nvs, name) and toString(nvs, name) == value


def toString(nvs, name=None):
    if name is None:
        return "".join("%s: %s\n" % (one.name, one.value.value()) for one in nvs)
    return find(nvs, name).value() if isString(nvs, name) else ""


def appendStringValue(nvs, name, value):
    """Add the value to the list of that name, which has commas between its values."""
    at = find_index(nvs, name)
    if at < 0:
        nvs.append(newNV(name, value))
    else:
        values = [one.strip() for one in nvs[at].value.value().split(",")]
        if value not in values:
            nvs[at].value = _any.to_any(nvs[at].value.value() + ", " + value)
    return True


def append(to, from_):
    to.extend(from_)


def dump(nvs):
    print(toString(nvs), end="")


def dump_to_stream(out, nvs):
    out.append(toString(nvs))
