"""Helpers for text."""
import os

__all__ = ["escape", "unescape", "eraseBlank", "eraseHeadBlank", "eraseTailBlank", "eraseBothEndsBlank", "normalize", "replaceString",
           "split", "toBool", "includes", "isAbsolutePath", "isURL", "otos", "stringTo", "stringToStrVec", "unique_sv", "flatten",
           "toArgv", "urlparam2map", "replaceEnv", "toUpper", "toLower", "_stringToList", "isEscaped"]

_ESCAPES = {"\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r", '"': '\\"', "'": "\\'", "\\": "\\\\"}
_UNESCAPES = {"t": "\t", "n": "\n", "f": "\f", "r": "\r"}


def escape(text):
    return "".join(_ESCAPES.get(letter, letter) for letter in text)


def unescape(text):
    import re
    return re.sub(r"\\(.)", lambda found: _UNESCAPES.get(found.group(1), found.group(1)), text, flags=re.S)


def _in_place(function):
    """Sources for 1.x give a list of one text, which is changed in it."""

    def changed(text, *args):
        if not isinstance(text, list):
            return function(text, *args)
        text[0] = function(text[0], *args)
        return text[0]

    changed.__name__ = function.__name__
    return changed


@_in_place
def eraseBlank(text):
    return "".join(letter for letter in text if letter not in " \t")


@_in_place
def eraseHeadBlank(text):
    return text.lstrip(" \t")


@_in_place
def eraseTailBlank(text):
    return text.rstrip(" \t")


@_in_place
def eraseBothEndsBlank(text):
    return text.strip(" \t")


@_in_place
def normalize(text):
    return text.strip(" \t").lower()


@_in_place
def replaceString(text, old, new):
    return text.replace(old, new)


def isEscaped(text, at):
    """Whether an odd number of backslashes stands before text[at]."""
    before = text[:at]
    return (len(before) - len(before.rstrip("\\"))) % 2 == 1


def split(text, delimiter):
    """The parts that are not empty, without blanks around them."""
    return [part.strip() for part in text.split(delimiter) if part.strip()]


def toBool(text, yes, no, default_value=None):
    upper = text.upper()
    if upper.find(yes.upper()) >= 0:
        return True
    if upper.find(no.upper()) >= 0:
        return False
    return True if default_value is None else default_value


def includes(list_, value, ignore_case=True):
    if isinstance(list_, str):
        list_ = split(list_, ",")
    if ignore_case:
        return value.lower() in [one.lower() for one in list_]
    return value in list_


def isAbsolutePath(text):
    import re
    return os.path.isabs(text) or bool(re.match(r"[A-Za-z]:[\\/]", text)) or text.startswith("\\\\")


def isURL(text):
    at = text.find(":")
    return at > 0 and text[at:at + 3] == "://"


def otos(value):
    return str(value)


def toUpper(text):
    return text.upper()


def toLower(text):
    return text.lower()


def _stringToList(var, text):
    parts = [part.strip() for part in text.split(",")]
    first = var[0][0] if var[0] else ""
    values = list(var[0])[:len(parts)]
    values += [first] * (len(parts) - len(values))
    result = []
    for sample, part in zip(values, parts):
        one = [sample]
        if not stringTo(one, part):
            return False
        result.append(one[0])
    var[0] = result
    return True


def stringTo(var, text):
    """Convert text to the type of var[0], and put it there. False, and nothing is changed, when it cannot be converted."""
    if not var or text is None or text == "":
        return False
    kind = var[0]
    try:
        if isinstance(kind, bool):
            var[0] = text.strip().lower() in ("true", "yes", "1", "on")
        elif isinstance(kind, int):
            try:
                var[0] = int(text)
            except ValueError:
                var[0] = int(text.strip(), 0)
        elif isinstance(kind, float):
            var[0] = float(text)
        elif isinstance(kind, list):
            return _stringToList(var, text)
        elif isinstance(kind, str):
            var[0] = str(text)
        else:
            return False
        return True
    except ValueError:
        return False


def stringToStrVec(var, text):
    var[0] = [part.strip() for part in text.split(",")]
    return True


def unique_sv(values):
    return list(dict.fromkeys([values] if isinstance(values, str) else values))


def flatten(values, delimiter=", "):
    return delimiter.join(str(one) for one in values)


def toArgv(args):
    return args


def urlparam2map(text):
    result = {}
    for part in text.partition("?")[2 if "?" in text else 0].split("&"):
        key, is_pair, value = part.partition("=")
        if key.strip():
            result[key.strip()] = value.strip() if is_pair else ""
    return result


def replaceEnv(text):
    import re
    return re.sub(r"\$\{(\w+)\}", lambda found: os.environ.get(found.group(1), ""), text)

