# Recordings of an enemy, shown by rtse: one line says what is wrong, memory stays bounded, nothing is written elsewhere.
# hostile_recordings.py CASE BIN_DIR LIB_DIR SOURCE_DIR.
import ctypes
import functools
import json
import os
import re
import resource
import stat
import struct
import subprocess
import sys
import tempfile
import time
import zlib

case, bin_dir, *_ = sys.argv[1:]
magic = b"\x89MCAP0\r\n"
cdr = b"\0\1\0\0"  # little-endian
max_memory = 900 << 20  # [octets] of addresses: a chunk of 128 MiB, its values, their text, and the program with its libraries


def text(value):
    octets = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(octets)) + octets


def record(code, content):
    return struct.pack("<BQ", code, len(content)) + content


def compressed(octets):
    zstd = ctypes.CDLL("libzstd.so.1")
    zstd.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(len(octets) // 2 + 1024)
    size = zstd.ZSTD_compress(room, ctypes.c_size_t(len(room)), octets, ctypes.c_size_t(len(octets)), 3)
    return room.raw[:size]


compressed_once = functools.cache(compressed)


# Channels (topic, encoding, schema's name, schema's encoding, schema's text) and messages (channel from 1, octets).
def recording(path, channels, messages):
    body = b""
    for n, (topic, encoding, *schema) in enumerate(channels, 1):
        body += record(3, struct.pack("<H", n) + b"".join(map(text, schema)))
        body += record(4, struct.pack("<HH", n, n) + text(topic) + text(encoding) + text(""))
    body += b"".join(record(5, struct.pack("<HIQQ", channel, 0, moment, moment) + octets) for moment, (channel, octets) in enumerate(messages))
    packed = compressed(body)
    chunk = struct.pack("<QQQI", 0, len(messages), len(body), 0) + text("zstd") + struct.pack("<Q", len(packed)) + packed
    with open(path, "wb") as out:
        out.write(magic + record(1, text("") + text("")) + record(6, chunk) + record(15, bytes(4)) + record(2, bytes(20)) + magic)
    return path


# With a summary: a chunk of its own for each message of one JSON channel, at each second.
def summarized(path, messages):
    channel = record(4, struct.pack("<HH", 1, 0) + text("/a") + text("json") + text(""))
    data = magic + record(1, text("") + text(""))
    places = b""
    for n, octets in enumerate(messages):
        at = n * 10**9
        head = (channel if n == 0 else b"") + struct.pack("<BQHIQQ", 5, 22 + len(octets), 1, n, at, at)  # record 5 without its data
        size = len(head) + len(octets)
        packed = compressed(head + octets) if size < 1 << 20 else compressed(head) + compressed_once(octets)  # two frames
        chunk = record(6, struct.pack("<QQQI", at, at, size, 0) + text("zstd") + struct.pack("<Q", len(packed)) + packed)
        index = record(7, struct.pack("<HIQQ", 1, 16, at, 0))
        places += record(8, struct.pack("<QQQQIHQQ", at, at, len(data), len(chunk), 10, 1, len(data) + len(chunk), len(index)) +
                         text("zstd") + struct.pack("<QQ", len(packed), size))
        data += chunk + index
    count = len(messages)
    statistics = record(11, struct.pack("<QHIIIIQQIHQ", count, 0, 1, 0, 0, count, 0, (count - 1) * 10**9, 10, 1, count))
    data += record(15, bytes(4))
    with open(path, "wb") as out:
        out.write(data + channel + statistics + places + record(2, struct.pack("<QQI", len(data), 0, 0)) + magic)
    return path


def rtse(*words):
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (max_memory, max_memory))  # noqa: E731
    return subprocess.run([f"{bin_dir}/rtse", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limit, timeout=120)


# Exit code 1 and so many lines that say this.
def refused(*words, says, lines=1):
    done = rtse(*words)
    assert done.returncode == 1 and done.stderr.count(b"\n") == lines and says in done.stderr.decode(), (words, done.returncode, done.stderr)


# Few octets that would become gigabytes of values, or overflow the stack.
def bombs():
    count = 120 << 20
    kinds = {"ros": ("/b", "cdr", "t/msg/T", "ros2msg", "bool[] a\n", cdr + struct.pack("<I", count) + bytes(count)),
             "idl": ("/b", "cdr", "RTC::TimedOctetSeq", "omgidl", "", cdr + struct.pack("<III", 0, 0, count) + bytes(count)),
             "json": ("/b", "json", "", "", "", b"[" + b"0," * (50 << 20) + b"0]")}
    for name, (*channel, octets) in kinds.items():
        file = recording(f"{name}.mcap", [channel], [(1, octets)])
        assert os.path.getsize(file) < 20000
        refused("recording", "cat", file, says="more than 8388608 values")
        refused("recording", "export", file, "-o", "out", says="more than 8388608 values")
    deep = recording("deep.mcap", [("/b", "json", "", "", "")], [(1, b"[" * 1000000 + b"]" * 1000000), (1, b"[1]")])
    refused("recording", "cat", deep, says="nested deeper than 100 levels")
    many = recording("many.mcap", [("/b", "json", "", "", "")], [(1, b"")] * 1600000)
    for words in (["cat", many], ["export", many, "-o", "many"], ["compare", many, many]):
        done = rtse("recording", *words)
        assert done.returncode == 1 and "more than 1500000 messages in chunks of one time are not read" in done.stderr.decode(), (words, done)
    wide = recording("wide.mcap", [("/b", "json", "", "", ""), ("/c", "json", "", "", "")], [(1, b"[" + b"0," * 300000 + b"0]"), (2, b"5")])
    refused("recording", "export", wide, "-o", "wide", says="has more than 262144 members, which is too much for a table")
    assert os.listdir("wide") == ["c.csv"]


# What is no UTF-8 is shown with marks in its place, in JSON, too.
def letters():
    file = recording("letters.mcap", [(b"/a\xff", "json", "", "", ""), ("/s", "cdr", "t/msg/T", "ros2msg", "string a\n")],
                     [(1, b'{"v":1}'), (2, cdr + text(b"\xffx\0"))])
    done = rtse("recording", "cat", file)
    samples = [json.loads(line) for line in done.stdout.decode().splitlines()]
    assert done.returncode == 0 and [s["value"] for s in samples] == [{"v": 1}, {"a": "\ufffdx"}], done
    assert [c["topic"] for c in json.loads(rtse("--json", "recording", "ls", file).stdout)] == ["/a\ufffd", "/s"]


# Pictures whose members have other types, or rows that begin beyond the memory.
def pictures():
    image = "sensor_msgs/msg/Image"
    rows = cdr + struct.pack("<III", 3, 1000, 5) + b"rgb8\0" + bytes(7) + struct.pack("<QI", 1 << 63, 3000) + bytes(3000)
    file = recording("rows.mcap", [("/p", "cdr", image, "ros2msg", "uint32 height\nuint32 width\nstring encoding\nuint64 step\nuint8[] data\n")],
                     [(1, rows)])
    refused("recording", "export", file, "--png", "-o", "rows", says="a picture of 1000 x 3 pixels in 3000 bytes")
    file = recording("types.mcap", [("/p", "json", image, "", ""), ("/q", "json", "RTC::CameraImage", "", "")],
                     [(1, b'{"encoding":5}'), (2, b'{"pixels":[1e300,-5,null,"x"],"width":"x"}')])
    refused("recording", "export", file, "--png", "-o", "types", says="members of other types", lines=2)


# Topics that look like paths, are the same as a file, or are longer than names may be.
def names():
    topics = ["/../../up", "/a/b", "/a.b", "/" + "x" * 5000, "/" + "x" * 5001, "", "-rf", b"/c\x1b[2J\xff\xe2\x80\xae"]
    file = recording("names.mcap", [(topic, "json", "", "", "") for topic in topics], [(n, b'{"v":%d}' % n) for n in range(1, 9)])
    done = rtse("recording", "export", file, "-o", "tables")
    assert done.returncode == 0, done
    long = "x" * 200
    assert sorted(os.listdir("tables")) == sorted(f"{n}.csv" for n in ("_.....up", "a.b", "a.b-2", long, long + "-2", "_", "_rf", "c_[2J__")), os.listdir("tables")
    assert open("tables/a.b-2.csv").read() == "time,v\n0.000000002,3\n"


# What cannot be done leaves what is there: a pipe in the place of the output, a recording of yesterday.
def targets():
    file = recording("good.mcap", [("/a", "json", "", "", "")], [(1, b"1")])
    before = open(file, "rb").read()
    os.mkfifo("pipe")
    refused("recording", "repair", file, "-o", "pipe", says="is not a regular file")
    assert stat.S_ISFIFO(os.stat("pipe").st_mode)
    refused("record", "--views", "-s", "9999", "-o", file, says="no simulation")
    assert open(file, "rb").read() == before
    refused("recording", "cat", file, "--from", "5", "--to", "1", says="expected a time behind --from 5")


# What a terminal would obey is shown as what it is.
def terminal():
    evil, c1 = "\x1b]0;evil\x07", "\u009b31m"
    file = recording("terminal.mcap", [("/a" + evil + c1, "json", evil, "", ""), ("/b" + c1, "cdr" + evil, "t" + c1, "x", "")],
                     [(1, f'{{"v":"{c1}\x7f"}}'.encode()), (2, b"")])
    other = recording("other.mcap", [("/c" + evil + c1, "json", evil, "", "")], [(1, b"1")])
    for words in (["info", file], ["ls", file], ["cat", file], ["cat", file, "/nope"], ["compare", file, other], ["export", file, "-o", "out"]):
        done = rtse("recording", *words)
        said = (done.stdout + done.stderr).decode()
        assert said and not [c for c in said if c != "\n" and (ord(c) < 32 or 127 <= ord(c) < 160)], (words, done)
    value = json.loads(rtse("recording", "cat", file).stdout.splitlines()[0])["value"]
    assert value == {"v": c1 + "\x7f"}, value
    turned = "\u202egpj\u2066"
    raw = b"\x9b31m\xff" + turned.encode()
    file = recording("raw.mcap", [(b"/a" + raw, "json", raw, "", ""), (b"/b" + raw, b"cdr" + raw, b"t" + raw, "x", "")],
                     [(1, f'{{"v":"{turned}"}}'.encode()), (2, b"")])
    for words in (["info", file], ["ls", file], ["cat", file], ["cat", file, "/nope"], ["compare", file, other], ["export", file, "-o", "raw"]):
        done = rtse("recording", *words)
        said = (done.stdout + done.stderr).decode()  # it is UTF-8
        assert said and not [c for c in said if c in turned and ord(c) > 127], (words, done)


# A file of many broken chunks is told in a few lines.
def many_broken():
    file = summarized("broken.mcap", [b'{"v":"%d"}' % n for n in range(200)])
    octets = bytearray(open(file, "rb").read())
    at = octets.find(b"zstd", octets.find(b"zstd") + 4)  # the first one describes the channel
    for _ in range(199):
        octets[at + 16] ^= 0x55
        at = octets.find(b"zstd", at + 4)
    with open(file, "wb") as out:
        out.write(octets)
    refused("recording", "cat", file, says='"broken.mcap": ... and 194 more', lines=6)
    refused("recording", "export", file, "-o", "out", says='"broken.mcap": ... and 194 more', lines=6)


# Gigabytes of zeros in a small file: what the indexes say is told without them.
def large():
    chunks = int(os.environ.get("LARGE_CHUNKS", "20"))
    chunk = b'{"v":"' + b"0" * (127 << 20) + b'"}'
    file = summarized("large.mcap", [chunk] * chunks)
    assert os.path.getsize(file) < 10 << 20
    began = time.monotonic()
    done = rtse("--json", "recording", "info", file)
    took = time.monotonic() - began
    info = json.loads(done.stdout)
    channel = info["channels"][0]
    assert channel["samples"] == info["samples"] == chunks and channel["longest_gap"] == 1 and channel["rate"] > 0.9, channel
    assert channel["octets"] is channel["missing"] is None, channel
    print(f"{os.path.getsize(file)} octets, info in {took:.3f} s")
    said = rtse("recording", "info", file)
    assert b"counted by their indexes: without bytes" in said.stderr and b"Hz\n" in said.stdout, said


# A flipped octet costs a chunk, which is said.
def flipped():
    file = recording("flipped.mcap", [("/a", "json", "", "", "")], [(1, b'{"v":"%d"}' % n) for n in range(100)])
    octets = bytearray(open(file, "rb").read())
    octets[octets.index(b"zstd") + 20] ^= 0x55
    with open(file, "wb") as out:
        out.write(octets)
    done = rtse("recording", "repair", file)
    assert done.returncode == 1 and re.match(rb"0 samples kept, \d\d+ bytes lost, 1 broken chunk with an unknown number of samples\n.*the chunk", done.stdout), done


# A flipped bit in the length of a record in the middle leads a walk astray; the summary still knows the way.
def astray():
    file = summarized("astray.mcap", [b'{"v":"%d"}' % n for n in range(50)])
    octets = bytearray(open(file, "rb").read())
    index = octets.index(record(7, b"")[:1] + struct.pack("<Q", 22), 100)  # of the first chunk
    octets[index + 3] ^= 1
    with open(file, "wb") as out:
        out.write(octets)
    assert json.loads(rtse("--json", "recording", "info", file).stdout)["samples"] == 50
    done = rtse("recording", "repair", file)
    assert done.returncode == 0 and done.stdout.startswith(b"50 samples kept, 0 bytes lost\n"), done
    assert len(rtse("recording", "cat", file).stdout.splitlines()) == 50
    octets[octets.index(b"zstd", octets.index(b"zstd") + 4) + 16] ^= 0x55
    with open(file, "wb") as out:
        out.write(octets)
    done = rtse("recording", "repair", file)
    assert done.returncode == 1 and done.stdout.startswith(b"49 samples kept, ") and b", 1 broken chunk with 1 samples\n" in done.stdout, done
    assert len(rtse("recording", "cat", file).stdout.splitlines()) == 49


# A piece of a ring that a kill has left, with a chunk of its own for each message, at so many seconds.
def piece(path, number, times):
    texts = text("number") + text(str(number)) + text("resets") + text("0") + text("span_ns") + text(str(10**12)) + text("compression") + text("zstd")
    data = magic + record(1, text("") + text("rtm-sim")) + record(12, text("ring") + text(texts))
    for n, seconds in enumerate(times):
        at = seconds * 10**9
        body = record(4, struct.pack("<HH", 1, 0) + text("/a") + text("json") + text("")) if n == 0 else b""
        body += record(5, struct.pack("<HIQQ", 1, seconds, at, at) + b'{"v":%d}' % seconds)
        packed = compressed(body)
        data += record(6, struct.pack("<QQQI", at, at, len(body), zlib.crc32(body)) + text("zstd") + struct.pack("<Q", len(packed)) + packed)
        data += record(7, struct.pack("<HIQQ", 1, 16, at, 0))
    with open(path, "wb") as out:
        out.write(data)
    return path


def flip(path, *changes):
    octets = bytearray(open(path, "rb").read())
    for place, bits in changes:
        octets[place] ^= bits
    with open(path, "wb") as out:
        out.write(octets)


def chunk_of(path, number):
    octets, place = open(path, "rb").read(), -1
    for _ in range(number):
        place = octets.index(b"zstd", place + 1 if place > 0 else octets.index(b"zstd") + 1)  # the first one is among the metadata
    return place - 41


# What is lost of a ring is told, and its pieces stay.
def broken_ring():
    def fresh():
        for name in os.listdir("."):
            os.remove(name)
        piece("r-004.mcap", 4, range(10))
        return piece("r-005.mcap", 5, range(10, 20))

    def repaired(code, kept, *said):
        done = rtse("recording", "repair", "r.mcap")
        assert done.returncode == code and done.stdout.decode().startswith(f"{kept} samples kept of "), done
        assert not [text for text in said if text not in done.stdout.decode()], (said, done)
        assert len(rtse("recording", "cat", "r.mcap").stdout.splitlines()) == kept
        assert sorted(n for n in os.listdir(".") if n.startswith("r-")) == sorted(there) if code else os.listdir(".") == ["r.mcap"], os.listdir(".")

    fresh()
    repaired(0, 20)
    there = ["r-004.mcap", "r-005.mcap"]
    newer = fresh()
    flip(newer, (chunk_of(newer, 3) + 4, 1))  # its length
    repaired(1, 12, '"r-005.mcap": not all can be read: ', " bytes are lost; ", "the last record is truncated", "the segments are kept")
    newer = fresh()
    flip(newer, (chunk_of(newer, 3), 0x80))  # its opcode
    repaired(1, 19, '"r-005.mcap": not all can be read: 1 samples are lost; ', "a record of kind 134 among the data")
    newer = fresh()
    flip(newer, (chunk_of(newer, 3) + 60, 0x55))
    repaired(1, 19, '"r-005.mcap": not all can be read: 1 samples are lost; ', "the chunk")
    for octets in (b"", b"garbage", open(fresh(), "rb").read()[:30]):
        fresh()
        with open("r-004.mcap", "wb") as out:
            out.write(octets)
        repaired(1, 10, '"r-004.mcap": ', "it is left out", "the segments are kept")
    json_said = fresh() and rtse("--json", "recording", "repair", "r.mcap").stdout
    assert json.loads(json_said) == {"samples": 20, "pieces": 2, "samples_lost": 0, "damage": ""}, json_said


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    globals()[case]()
print("ok")
