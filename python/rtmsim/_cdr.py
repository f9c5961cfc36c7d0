"""Decoders of samples: made from a schema (IDL or ROS 2 message definitions), called with the bytes of each sample (CDR)."""
from __future__ import annotations

import re
import struct

import numpy

from ._core import Error

_primitives = {
    # name: (struct letter, size)
    "boolean": ("?", 1), "bool": ("?", 1), "octet": ("B", 1), "byte": ("B", 1), "char": ("B", 1), "uint8": ("B", 1), "int8": ("b", 1),
    "short": ("h", 2), "int16": ("h", 2), "unsigned short": ("H", 2), "uint16": ("H", 2),
    "long": ("i", 4), "int32": ("i", 4), "unsigned long": ("I", 4), "uint32": ("I", 4), "enum": ("I", 4),
    "long long": ("q", 8), "int64": ("q", 8), "unsigned long long": ("Q", 8), "uint64": ("Q", 8),
    "float": ("f", 4), "float32": ("f", 4), "double": ("d", 8), "float64": ("d", 8),
}
_largest_count = 1 << 27


class _Input:
    """The bytes of a sample behind the four that name the byte order."""

    __slots__ = ("data", "at", "order")

    def __init__(self, data: bytes):
        if len(data) < 4 or data[1] > 1:
            raise Error("sample: expected CDR, with its byte order first")
        self.order = "<" if data[1] == 1 else ">"
        self.data = memoryview(data)[4:]
        self.at = 0

    def align(self, size: int) -> None:
        self.at = (self.at + size - 1) // size * size

    def number(self, letter: str, size: int):
        self.align(size)
        value = struct.unpack_from(self.order + letter, self.data, self.at)[0]
        self.at += size
        return value

    def numbers(self, letter: str, size: int, count: int):
        if count == 0:
            return numpy.empty(0, numpy.dtype(letter))
        self.align(size)
        if self.at + size * count > len(self.data):
            raise Error(f"sample: is shorter than its {count} numbers")
        values = numpy.frombuffer(self.data, numpy.dtype(letter).newbyteorder(self.order), count, self.at)
        self.at += size * count
        return values.astype(numpy.dtype(letter))

    def text(self, kind: str) -> str:
        length = self.number("I", 4)
        if self.at + length > len(self.data):
            raise Error("sample: is shorter than its text")
        raw = bytes(self.data[self.at:self.at + length])
        self.at += length
        if kind == "wstring":
            # omniORB: UTF-16 in the order of the sample or with a mark, without a zero at the end.
            return raw.decode("utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-16-be", "replace")
        return raw.rstrip(b"\0").decode("utf-8", "replace")


def _primitive(name):
    letter, size = _primitives[name]
    return lambda source: source.number(letter, size)


def _sequence(name, element, count):
    """`count`: of an array; None: the sample says."""
    if name in _primitives:
        letter, size = _primitives[name]
        if count is not None:
            return lambda source: source.numbers(letter, size, count)
        return lambda source: source.numbers(letter, size, source.number("I", 4))

    def read(source):
        length = source.number("I", 4) if count is None else count
        if length > _largest_count or length > len(source.data):
            raise Error(f"sample: has {length} elements in {len(source.data)} bytes")
        return [element(source) for _ in range(length)]
    return read


def _structure(members):
    def read(source):
        return {name: member(source) for name, member in members}
    return read


class _Schema:
    """Readers by name of a type."""

    def __init__(self):
        self.types: dict = {}

    def find(self, name: str, scope: str = ""):
        while True:
            full = f"{scope}::{name}" if scope else name
            if full in self.types:
                return self.types[full]
            if not scope:
                break
            scope = scope.rpartition("::")[0]
        last = name.rpartition("::")[2]
        found = [reader for known, reader in self.types.items() if known.rpartition("::")[2] == last]
        if not found:
            raise Error(f"schema: the type {name} is not defined")
        return found[-1]


def _ros_schema(text: str, name: str):
    """Definitions of ROS 2 messages, separated by lines of =."""
    parts = re.split(r"^=+$", text, flags=re.M)
    definitions = {name: parts[0]}
    for part in parts[1:]:
        head, _, body = part.strip().partition("\n")
        definitions[head.replace("MSG:", "").strip()] = body
    made: dict = {}

    def short(kind):
        words = kind.split("/")
        return f"{words[0]}/{words[-1]}"
    by_short = {short(kind): kind for kind in definitions}

    def reader(kind, package):
        if kind in _primitives:
            return _primitive(kind)
        if kind.startswith(("string", "wstring")):
            plain = "wstring" if kind.startswith("w") else "string"
            return lambda source: source.text(plain)
        full = by_short.get(short(kind) if "/" in kind else f"{package}/{kind}")
        if full is None and kind in ("time", "duration"):
            return _structure([("sec", _primitive("int32")), ("nanosec", _primitive("uint32"))])
        if full is None:
            raise Error(f"schema {name}: the type {kind} is not defined")
        return lambda source: structure(full)(source)

    def structure(kind):
        if kind in made:
            return made[kind]
        members: list = []
        package = kind.split("/")[0]
        for line in definitions[kind].splitlines():
            words = line.split("#")[0].split()
            if len(words) < 2 or "=" in words[1] or (len(words) > 2 and words[2].startswith("=")):
                continue
            match = re.fullmatch(r"([^\[\]]+?)(<=\d+)?(?:\[(<=)?(\d*)\])?", words[0])
            if match is None:
                raise Error(f"schema {name}: cannot read {line.strip()!r}")
            base = match.group(1)
            member = reader(base, package)
            if "[" in words[0]:
                count = int(match.group(4)) if match.group(4) and not match.group(3) else None
                member = _sequence(base, member, count)
            members.append((words[1], member))
        made[kind] = _structure(members)
        return made[kind]

    return structure(name)


_token = re.compile(r"::|[A-Za-z_]\w*|\d+|[{}()<>\[\];:,=]|\"[^\"]*\"|'[^']*'|[-+.\d][\w.+-]*|.")


class _Idl:
    """A reader of the IDL that recordings have: modules, structs, enums, typedefs, constants."""

    def __init__(self, text: str):
        text = re.sub(r"//[^\n]*|/\*.*?\*/|^\s*#[^\n]*", " ", text, flags=re.S | re.M)
        self.words = [word for word in _token.findall(text) if not word.isspace()]
        self.at = 0
        self.schema = _Schema()
        self.constants: dict = {}
        while self.at < len(self.words):
            self.definition("")

    def word(self) -> str:
        if self.at >= len(self.words):
            raise Error("schema: the IDL ends too early")
        self.at += 1
        return self.words[self.at - 1]

    def next_is(self, word: str) -> bool:
        return self.at < len(self.words) and self.words[self.at] == word

    def expect(self, word: str) -> None:
        found = self.word()
        if found != word:
            raise Error(f"schema: expected {word!r}, got {found!r}")

    def skip(self) -> None:
        """To the end of a definition that no sample has."""
        depth = 0
        while True:
            word = self.word()
            depth += (word == "{") - (word == "}")
            if word == ";" and depth == 0:
                return

    def definition(self, scope: str) -> None:
        word = self.word()
        if word == ";":
            return
        if word == "module":
            inner = self.named(scope, self.word())
            self.expect("{")
            while not self.next_is("}"):
                self.definition(inner)
            self.expect("}")
        elif word == "struct":
            name = self.named(scope, self.word())
            if self.next_is(";"):
                return
            self.expect("{")
            members: list = []
            while not self.next_is("}"):
                members += self.declarators(scope)
            self.expect("}")
            self.schema.types[name] = ("struct", _structure(members))
        elif word == "enum":
            name = self.named(scope, self.word())
            self.expect("{")
            while self.word() != "}":
                pass
            self.schema.types[name] = ("enum", _primitive("enum"))
        elif word == "typedef":
            for name, reader in self.declarators(scope, typedef=True):
                self.schema.types[self.named(scope, name)] = reader
        elif word == "const":
            self.kind(scope)
            name = self.word()
            self.expect("=")
            value = self.word()
            if value.isdigit():
                self.constants[name] = int(value)
            while not self.next_is(";"):
                self.word()
        else:
            self.at -= 1
            self.skip()

    @staticmethod
    def named(scope: str, name: str) -> str:
        return f"{scope}::{name}" if scope else name

    def count(self) -> int:
        word = self.word()
        while self.next_is("::"):
            self.word()
            word = self.word()
        if word.isdigit():
            return int(word)
        if word in self.constants:
            return self.constants[word]
        raise Error(f"schema: expected a number of elements, got {word!r}")

    def kind(self, scope: str):
        """(name of a primitive or "", reader)"""
        word = self.word()
        if word == "sequence":
            self.expect("<")
            name, element = self.kind(scope)
            if self.next_is(","):
                self.word()
                self.count()
            self.expect(">")
            return "", _sequence(name, element, None)
        if word in ("string", "wstring"):
            if self.next_is("<"):
                self.word()
                self.count()
                self.expect(">")
            return "", lambda source: source.text(word)
        if word == "unsigned":
            word += " " + self.word()
        if word.endswith("long") and self.next_is("long"):
            word += " " + self.word()
        if word in _primitives:
            return word, _primitive(word)
        if word == "::":
            word = self.word()
        while self.next_is("::"):
            self.word()
            word += "::" + self.word()
        name, reader = self.schema.find(word, scope)
        return (name if name in _primitives else ""), reader

    def declarators(self, scope: str, typedef: bool = False) -> list:
        name, reader = self.kind(scope)
        made = []
        while True:
            declared = self.word()
            counts = []
            while self.next_is("["):
                self.word()
                counts.append(self.count())
                self.expect("]")
            one, kind = reader, name
            for count in reversed(counts):
                one, kind = _sequence(kind, one, count), ""
            made.append((declared, (kind, one) if typedef else one))
            if self.word() == ";":
                return made


def decoder(encoding: str, schema_encoding: str, schema: str, name: str):
    """A function of the bytes of a sample: nested dicts, with numpy arrays of numbers."""
    if encoding == "json":
        import json
        return lambda data: json.loads(bytes(data).decode("utf-8", "replace"))
    if encoding == "cdr" and schema_encoding == "ros2msg":
        read = _ros_schema(schema, name)
    elif encoding == "cdr" and schema_encoding == "omgidl":
        read = _Idl(schema).schema.find(name.replace("/", "::"))[1]
    else:
        raise Error(f"samples of {name or 'no type'} in {encoding!r} ({schema_encoding or 'without a schema'}) cannot be decoded")

    def decode(data: bytes):
        try:
            return read(_Input(data))
        except struct.error as problem:
            raise Error(f"sample of {name}: {problem}") from None
    return decode
