# Words that docs/glossary.md rejects do not appear in pages, help texts, messages and header comments.  plain_english.py SOURCE_DIR [--shrink]
# Pages: all of docs, README, CONTRIBUTING, SECURITY, without code. Sources: string literals that contain a blank (names and JSON keys are interfaces).
# Headers: the comment that a header begins with, without names of headers.
# plain_english.allow lists what is not rewritten yet: FILE: WORD N. A file with more is reported, and so is one with fewer, so that the list
# only shrinks. --shrink removes what is no longer needed, and follows a file that was moved; it never allows more.
import collections
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
allow_file = source / "tests/scenario/plain_english.allow"
folders = ("base", "shm", "rtm-core", "sim-server", "iface-components", "gateways", "tools", "clients", "python")

# Comments are matched first, so that a quote in one begins no string; a raw string counts as one; neighbours are joined.
token = re.compile(r"//[^\n]*|/\*.*?\*/|'(?:[^'\\\n]|\\.)'|R\"([^(\s]{0,16})\((.*?)\)\1\"|((?:\"(?:[^\"\\\n]|\\.)*\"\s*)+)|\w+", re.S)


def rejected_words():
    glossary = (source / "docs/glossary.md").read_text()
    rows = [row.split("|") for row in re.findall(r"^\|(.*)\|$", glossary, re.M)]
    words = [word for row in rows if len(row) == 3 for word in re.findall(r"`([^`]+)`", row[2])]
    assert len(words) > 30, words
    return sorted(words)


def prose_of(page):
    text = re.sub(r"^```.*?^```$", lambda block: re.sub(r"[^\n]", " ", block[0]), page.read_text(), flags=re.M | re.S)
    text = re.sub(r"`[^`\n]*`|\]\([^)\s]*\)", lambda code: " " * len(code[0]), text)
    if page.name == "glossary.md":
        text = re.sub(r"\*[^*\n]*\*", "", text)
    yield 1, text


def literals_of(text):
    for match in token.finditer(text):
        literal = match[2] if match[2] is not None else "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', match[3])) if match[3] else ""
        if " " in literal and not match[0].startswith(("//", "/*")):
            yield text.count("\n", 0, match.start()) + 1, literal.replace("\\n", " ")


def header_comment(text):
    comment = re.match(r"(?://[^\n]*\n)*", text)[0]
    return re.sub(r"[\w/]+\.h\b|`[^`\n]*`", "", comment.replace("//", "  "))


def texts():
    for page in (source / "README.md", source / "CONTRIBUTING.md", source / "SECURITY.md", *sorted((source / "docs").glob("**/*.md"))):
        yield page, prose_of(page)
    for folder in folders:
        for file in sorted((source / folder).glob("**/*")):
            if file.suffix in (".h", ".cpp") and file.is_file() and "node_modules" not in file.parts:
                text = file.read_text()
                yield file, literals_of(text)
                if file.suffix == ".h":
                    yield file, [(1, header_comment(text))]


def found(words):
    pattern = re.compile(r"(?<![\w-])(?<!CORBA )(" + "|".join(re.escape(word).replace(r"\ ", r"\s+") for word in words) + r")(?![\w-])", re.I)
    places = collections.defaultdict(list)
    for file, parts in texts():
        for line, text in parts:
            for match in pattern.finditer(text):
                word = " ".join(match[1].lower().split())
                places[str(file.relative_to(source)), word].append(line + text.count("\n", 0, match.start()) if text.count("\n") else line)
    return places


def allowed():
    rows = re.findall(r"^([^:#\n]+): (.+) (\d+)$", allow_file.read_text(), re.M)
    return {(file, word): int(number) for file, word, number in rows}


def clauses_as_headings():
    for folder in folders:
        for file in sorted((source / folder).glob("**/*.h")):
            if "node_modules" not in file.parts and re.match(r"// (What|Who|Whoever|Whether|Where|How|So|Of|That|Nobody)\b", file.read_text()):
                yield f"{file.relative_to(source)}:1: the comment begins with a clause; begin with a verb or with what the header has"


planted = """// "a comment"
char quote = '"'; f("name", "so "  // why
  "many"); g(R"x(a "raw" text)x"); /* "another comment" */ h("one \\"two\\" three");
"""
assert list(literals_of(planted)) == [(2, "so "), (3, 'a "raw" text'), (3, r'one \"two\" three')], list(literals_of(planted))
assert list(literals_of('f("so "\n  "many");')) == [(1, "so many")]
assert header_comment("// Whoever\n// asks (orb/asker.h) `nobody`.\n#pragma once  // anew\n").split() == ["Whoever", "asks", "()", "."]
places, allow = found(rejected_words()), allowed()
if "--shrink" in sys.argv:
    for (file, word), number in list(allow.items()):  # a file that was moved keeps its rows
        homes = sorted({home for home, _ in places if pathlib.Path(home).name == pathlib.Path(file).name} if not (source / file).exists() else [])
        if len(homes) == 1:
            allow[homes[0], word] = allow.get((homes[0], word), 0) + allow.pop((file, word))
    kept = {key: min(number, len(places[key])) for key, number in allow.items() if places.get(key)}
    comment = "\n".join(line for line in allow_file.read_text().splitlines() if line.startswith("#"))
    allow_file.write_text(comment + "\n" + "".join(f"{file}: {word} {number}\n" for (file, word), number in sorted(kept.items())))
    allow = kept
problems = [f"{file}:{','.join(map(str, lines))}: \"{word}\": see docs/glossary.md" + (f" ({len(lines)}, {allow[file, word]} allowed)" if (file, word) in allow else "")
            for (file, word), lines in sorted(places.items()) if len(lines) > allow.get((file, word), 0)]
problems += [f"tests/scenario/plain_english.allow: {file}: \"{word}\" is allowed {number} times, found {len(places.get((file, word), []))}: run with --shrink"
             for (file, word), number in sorted(allow.items()) if len(places.get((file, word), [])) < number]
problems += clauses_as_headings()
print("\n".join(problems) if problems else f"{sum(allow.values())} rejected words are still allowed")
sys.exit(1 if problems else 0)
