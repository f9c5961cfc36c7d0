# What rtse recording shows of MCAP files that other programs wrote: recordings_of_others.py BIN_DIR. Needs no name server.
import json
import struct
import subprocess
import sys
import tempfile

(bin_dir,) = sys.argv[1:]
magic = b"\x89MCAP0\r\n"


def text(value):
    octets = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(octets)) + octets


def texts(values):
    return text(b"".join(text(key) + text(value) for key, value in values.items()))


def record(kind, content):
    return struct.pack("<BQ", kind, len(content)) + content


# Channels are (topic, encoding), messages (channel, number, time, data).
def write(path, channels, messages, metadata=None):
    octets = magic + record(1, text("") + text("another"))
    octets += record(3, struct.pack("<H", 1) + text("pkg.Thing") + text("protobuf") + text(b"\x0a\x00"))
    for number, (topic, encoding) in enumerate(channels, 1):
        octets += record(4, struct.pack("<HH", number, 1) + text(topic) + text(encoding) + texts({}))
    for channel, number, time, data in messages:
        octets += record(5, struct.pack("<HIQQ", channel, number, time, time) + data)
    for name, values in (metadata or {}).items():
        octets += record(12, text(name) + texts(values))
    octets += record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + magic
    with open(path, "wb") as file:
        file.write(octets)


def recording(*words, code=0):
    done = subprocess.run([f"{bin_dir}/rtse", *words[:1], "recording", *words[1:]] if words[0] == "--json" else [f"{bin_dir}/rtse", "recording", *words], capture_output=True, text=True, timeout=60)
    assert done.returncode == code, (words, done)
    return done


def missing(numbers_and_times):
    write(file, [("/a", "json")], [(1, number, time, b"{}") for number, time in numbers_and_times])
    return json.loads(recording("--json", "info", file).stdout)["channels"][0]["missing"]


with tempfile.TemporaryDirectory() as folder:
    file = f"{folder}/others.mcap"
    # Numbers are in the order of the file, times are not.
    assert missing([(number, 100 - number) for number in range(10)]) == 0
    assert missing([(number, number ^ 3) for number in range(16)]) == 0
    assert missing([(number, number ^ 3) for number in range(16) if number not in (5, 9)]) == 2
    assert missing([(number, number) for number in (0, 1, 4, 5, 9)]) == 5
    assert missing([(0, time) for time in range(10)]) == 0, "a writer that does not number its samples"
    assert missing([(number % 2**32, number) for number in range(2**32 - 3, 2**32 + 3)]) == 0, "numbers go on at 0"
    assert "missing" not in recording("info", file).stdout

    # Metadata of others, and samples that nobody here can read.
    write(file, [("/blob", "protobuf"), ("/text", "json")], [(1, 0, 5, b"\x08\x01\x10"), (2, 0, 6, b'{"n": 1}')], {"calibration": {"camera": "left"}, "run": {"seed": "7"}})
    info = json.loads(recording("--json", "info", file).stdout)
    assert info["metadata"] == [{"name": "calibration", "texts": {"camera": "left"}}] and info["run"] == {"seed": "7"}, info
    assert "metadata    calibration\n              camera = left\n" in recording("info", file).stdout
    done = recording("cat", file, code=1)
    assert [json.loads(line) for line in done.stdout.splitlines()] == [
        {"time": 5e-09, "topic": "/blob", "sequence": 0, "encoding": "protobuf", "type": "pkg.Thing", "octets": 3},
        {"time": 6e-09, "topic": "/text", "sequence": 0, "value": {"n": 1}},
    ], done
    assert done.stderr.count("\n") == 1 and 'encoding "protobuf"' in done.stderr, done
print("ok")
