"""Names of the naming service as text."""
import CosNaming

from . import CORBA


def stringToName(text):
    """[CosNaming.NameComponent] of "a.b/c"; a backslash takes the special meaning of '.', '/' and itself."""
    parts, part, kinds, at = [], "", None, 0
    if not text:
        raise CosNaming.NamingContext.InvalidName()

    def end():
        nonlocal part, kinds
        if not part and kinds is None:
            raise CosNaming.NamingContext.InvalidName()
        parts.append(CosNaming.NameComponent(part if kinds is None else kinds, "" if kinds is None else part))
        part, kinds = "", None

    while at < len(text):
        letter = text[at]
        if letter == "\\":
            at += 1
            if at == len(text) or text[at] not in "./\\":
                raise CosNaming.NamingContext.InvalidName()
            part += text[at]
        elif letter == "." and kinds is None:
            kinds, part = part, ""
        elif letter == ".":
            raise CosNaming.NamingContext.InvalidName()
        elif letter == "/":
            end()
        else:
            part += letter
        at += 1
    end()
    return parts


def nameToString(name):
    if not name:
        raise CosNaming.NamingContext.InvalidName()

    def escape(text):
        return text.replace("\\", "\\\\").replace("/", "\\/").replace(".", "\\.")

    parts = []
    for one in name:
        text = escape(one.id)
        parts.append(text + "." + escape(one.kind) if one.kind or not one.id else text)
    return "/".join(parts)


def addrToURI(address, name=None):
    return "corbaname::" + address + ("#" + name if name else "")


def addrAndNameToURI(address, name):
    return addrToURI(address, name)
