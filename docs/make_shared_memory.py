#!/usr/bin/env python3
"""Writes docs/shared-memory.md: the tables come from shm/rtmsim_layout.h and iface_types.h, offsets and sizes from the compiler.
    docs/make_shared_memory.py            writes the page
    docs/make_shared_memory.py --check    exit code 1 when the page is not what it would write"""
import pathlib
import re
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
header = here.parent / "shm" / "rtmsim_layout.h"
page = here / "shared-memory.md"
text = header.read_text()


def clean(comment):
    return " ".join(re.sub(r"\n\s*\*", " ", comment).replace("|", "\\|").split())


structs = []
for match in re.finditer(r"((?:/\*(?:(?!\*/).)*\*/\n)?)typedef struct \{\n(.*?)\n\} (rtmsim_\w+);", text, re.S):
    intro, body, name = match.groups()
    fields = []
    for part in re.finditer(r"^\s*(?!/\*)([\w ]+?)\s+([^;/]+);[ \t]*(?:/\*(.*?)\*/)?", body, re.M | re.S):
        kind, names, comment = part.groups()
        for one in re.findall(r"(\w+)(\[[^\]]+\])?", names):
            fields.append((kind, one[0], one[1], clean(comment or "")))
    structs.append((name, clean(re.sub(r"^/\*|\*/\s*$", "", intro.strip()).strip()) if intro.strip() else "", fields))

def printed_by(compiler, suffix, program):
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / ("program" + suffix)
        source.write_text(program)
        subprocess.run([*compiler, "-o", folder + "/program", str(source)], check=True)
        return subprocess.run([folder + "/program"], check=True, capture_output=True, text=True).stdout.splitlines()


program = '#include <stddef.h>\n#include <stdio.h>\n#include "%s"\nint main(void) {\n' % header
for name, _, fields in structs:
    program += f'  printf("{name} %zu\\n", sizeof({name}));\n'
    for kind, field, _, _ in fields:
        program += f'  printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof((({name}*)0)->{field}));\n'
program += "  return 0;\n}\n"
numbers = dict(line.split(" ", 1) for line in printed_by(["cc"], ".c", program))

# The table of iface types, a line for each type and each field.
table_program = r"""
#include <cstdio>
#include "shm/iface_types.h"
int main() {
  const auto print = [](const char* what, std::span<const shm::Field> fields) {
    for (const auto& field : fields) {
      std::printf("%s\t%s\t%zu\t%s\n", what, field.name.data(), field.kind == shm::Field::Kind::text || field.kind == shm::Field::Kind::followers ? 1 : field.count,
                  field.unit.data());
    }
  };
  for (const auto& row : shm::iface_types) {
    std::printf("type\t%u\t%s\t%s\t%d\t%llu\n", static_cast<unsigned>(row.type), row.name.data(), row.meaning.data(), row.sample_size == 0 ? 1 : 0,
                static_cast<unsigned long long>(row.most));
    print("info", row.info);
    print("sample", row.sample);
    if (row.sample_tail.fields.size() > 1) print("element", row.sample_tail.fields);
  }
}
"""
types = []
for line in printed_by(["c++", "-std=c++20", f"-I{here.parent}"], ".cpp", table_program):
    what, *words = line.split("\t")
    if what == "type":
        types.append({"number": words[0], "name": words[1], "meaning": words[2], "frames": words[3] == "1", "most": int(words[4]), "info": [], "sample": [], "element": []})
    else:
        types[-1][what].append((words[0], int(words[1]), words[2]))

out = """# Shared memory, byte for byte

Every device of a simulated world is an *iface*: a segment of POSIX shared memory named

    rtmsim-<uid>-<server>.<type>.<iface name>

with the type in words (`laser`, `position2d`, ...) and the iface name as model names joined by `::`, then the sensor or plugin name. The file
`shm/rtmsim_layout.h` (C11 and C++) defines the layout; `docs/make_shared_memory.py` makes the tables below from it. `simctl dump IFACE` prints the segment of
a running simulator. If another user owns a file of that name, the segment is in a folder `rtmsim-<uid>.<random letters>` of the simulator's user. Functions for
C are in `shm/rtmsim_iface.h`, for C++ in `shm/client.h`.

All numbers are little endian; areas start at multiples of 64. Units: m, rad, s, kg, N; times are int64 nanoseconds; x forward, y left, z up,
counter-clockwise positive; quaternions are (w, x, y, z). Fields marked [atomic] are written while other processes read them.
"Server" is the simulator that owns the segment.

## Rules

- **Reading a sample.** Sample *n* is in cell *n* mod `count` of the area `cells`: a lock word, then the sample. Read `sequence`, the lock, the sample (by atomic words), the lock again;
  the copy is valid if both locks are 2 n + 2. The writer never waits for readers.
- **Waiting.** Read `wake_word`, set `waiting` to 2 wake_word + 1, read `wake_word` again and sleep on it (futex, shared) if it is the same. With `waiting` 0 the writer makes no system call. A
  late wake-up for a sample that you have read already is possible; it does not change `waiting`.
- **Subscribing.** Take a lease: change `owner` from 0 to (pid << 32) + a number that no other lease of your process has, then write `pid_namespace`, `start_time` and last `flags` with
  `RTMSIM_LEASE_SUBSCRIBER`. Add 1 to `lease_epoch` of the header: without that the simulator does not read the leases. A sensor works as long as one lease has the flag; leases of dead processes are
  released. To release a lease, store 0 in `owner` and add 1 to `lease_epoch`. Then add 1 to `attention` of the simulation iface and wake it if `attention_waiting` is set: a sensor that is
  switched on in a paused simulation then publishes the current state at once; otherwise the simulator finds the lease within a second. Such a sample does not change later samples.
  While the simulation runs, samples are due at the first step at or after each multiple of the period. So a new subscriber does not change the samples of other subscribers.
- **Frames.** Put slot + 1 into a `holds` word of the own lease. Then check that the slot's `lock` still has the number of the frame. The writer does not overwrite held slots, and counts
  the frames that it must drop.
- **Commands** are in the leases: make `command_lock` odd, write the command and the `command_values` doubles behind it, make the lock even; then store (number of commands + 1) << 16 | index
  of the lease in `command_latest` of the header, which selects the valid command. The iface chooses `command_values` (layout version 2; version 1 had twelve). When its owner exits or releases the lease, the robot stops. A process that takes or releases a lease first writes a command of kind 0xffffffff into it
  in the same way, since the lease may still have a command, or half of one, of another process. The simulator does this for processes that exited.
- **Requests** use a slot of the client, with the states `idle` - `asked` - `replying` - `replied`. Longer texts are sent in several rounds with the same id.
- **Stale segments** (pid, start time, boot id of the server) are replaced by the next server; the name of a running simulator is rejected. Mode 0600 unless `--shm-mode` or `--shm-group` say otherwise.
- The server keeps private copies of every size and index: data of a client cannot make it read or write outside of the segment. A truncated file does not end a process: a
  process that has mapped it continues with zeros (`base/cut_guard.h`), and the server logs it. The iface exists again after its next start.

"""
c_names = dict(re.findall(r"(RTMSIM_\w+) = (\d+)", re.search(r"/\* Iface types\..*?\*/\s*enum \{\n(.*?)\};", text, re.S).group(1)))
assert sorted(c_names.values(), key=int) == [one["number"] for one in types], "rtmsim_layout.h and iface_types.h have the same types"
c_names = {number: name for name, number in c_names.items()}
out += "## Iface types\n\n| value | name | in segment names | meaning | largest count |\n| --- | --- | --- | --- | ---: |\n"
for one in types:
    unit = " pixels" if one["frames"] else ""
    out += f"| {one['number']} | `{c_names[one['number']]}` | `{one['name']}` | {one['meaning']} | {str(one['most']) + unit if one['most'] else ''} |\n"
out += """
The largest count is the maximum number of beams, transducers, contacts or pixels. An iface with more, or with none, is neither created nor opened. `shm/iface_types.h`
has the table of types with number, name, constants, samples and fields; programs, checks and this page use it.

"""

out += "## Areas\n\n| value | name | meaning |\n| --- | --- | --- |\n"
for name, value, comment in re.findall(r"(\w+) = (\d+),?\s*(?:/\*(.*?)\*/)?", re.search(r"/\* Areas of a segment.*?\*/\s*enum \{\n(.*?)\};", text, re.S).group(1), re.S):
    out += f"| {value} | `{name}` | {clean(comment)} |\n"
out += "\n"


def table(title, pattern):
    rows = ""
    for body in re.findall(pattern, text, re.S):
        for name, value, comment in re.findall(r"(RTMSIM_\w+) =\s*(\d+),?[ \t]*(?:/\*(.*?)\*/)?", body, re.S):
            rows += f"| {value} | `{name}` | {clean(comment)} |\n"
    assert rows, title
    return f"## {title}\n\n| value | name | meaning |\n| --- | --- | --- |\n{rows}\n"


out += table("Other numbers", r"enum \{\s*(RTMSIM_(?:STATE|LEASE|COMMAND|DRIVE|STATUS|SLOT|PARTICIPANT|DROPPED)_.*?)\}")
out += table("Requests", r"enum \{\s*(RTMSIM_REQUEST_.*?)\}")
out += table("Views of a screenshot", r"enum \{\s*(RTMSIM_VIEW_.*?)\}")
out += """Texts of replies are JSON:

| request | text |
| --- | --- |
| list | `world`; `models`: name, static, pose (x y z qw qx qy qz); `ifaces`: type, name, model, subscribed; of joints also `groups`: kind (array, gripper, chain, pan_tilt), joints, name of the gripper, field of view of the camera [rad]; `attachments`: name, on, holds (MODEL::LINK or empty) of grippers and detachable joints |
| tree | `models`: name, static, pose, `links` (name, mass, pose, collisions, sensors with the names of their ifaces), `joints` (name, type, parent, child, position, velocity), plugins, `grippers` (name, palm, fingers); `actors`: name |
| stats | what `simctl --json stats` prints: time, speed, hash, counts, `parts` (where wall time goes), `participants`, `contacts_by_model` |
| contacts | `model`, `total` since the start, `contacts` of now: link, other, position, normal, depth |
| models | `models`: name, sorted; at most 10,000 |
| faults | `time`; `faults`: iface, kind, amount or null, from, until [s] or null, on (false: it starts later) |

| constant | value |
| --- | --- |
"""
for name, value in re.findall(r"#define (RTMSIM_(?!LAYOUT_H)\w+) ([^\s/]+)", text):
    value = value.strip('"')
    out += f"| `{name}` | `{value}` |\n"
out += "\n"
out += "## Formats of frames\n\n| value | name | bytes of a pixel |\n| --- | --- | --- |\n"
for name, value, comment in re.findall(r"(\w+) = (\d+),?\s*(?:/\*(.*?)\*/)?", re.search(r"enum \{\n(\s*RTMSIM_FORMAT_.*?)\};", text, re.S).group(1), re.S):
    out += f"| {value} | `{name}` | {clean(comment)} |\n"
out += """
- Rows run from the top down, pixels from left to right; `stride` bytes from one row to the next, now without padding. Colours are sRGB.
- A camera publishes the format that its world names: `R8G8B8`, `B8G8R8`, `L8`, `L16`, `BAYER_RGGB8`, `BAYER_BGGR8`, `BAYER_GBRG8`, `BAYER_GRBG8`, `RGBA_INT8`, `BGRA_INT8`, and the other
  spellings of the same (`RGB_INT8`, `L_INT8`, ...). An unknown format is logged once, and the camera publishes `R8G8B8`. Depth and points are always float (`R_FLOAT32`).
- Luminance is 0.299 R + 0.587 G + 0.114 B of the sRGB values; 16 bits hold 257 times that of 8 bits, with its fractions.
- Depth is measured along the optical axis. Where no object is between the clip planes it is +infinity, and the point is NaN NaN NaN. Clouds are organised: point i belongs to pixel i of the depth
  image of the same time, x forward, y left, z up in the sensor. With a distorting lens, the points are on the distorted rays of its pixels.
- A pixel at column u, row v has its centre at (u + 0.5, v + 0.5); a point (x, y, z) of the sensor is seen at u = cx - fx y / x, v = cy - fy z / x. With `distortion`, these tangents are first
  distorted by k1 k2 p1 p2 k3 as in OpenCV. For a wide-angle lens (`<lens>`), fx and fy are those of a pinhole camera with the same field of view.
- The cameras of a set (`multicamera`) are ifaces `sensor::camera`, taken at the same time; the base line of a stereo pair is the difference of their `pose`s.
- `dropped` counts frames for which readers held every slot of the ring. A slow reader only misses the sequence numbers in between.

"""
out += """## What `simctl` shows

Names and units of `simctl info` and `simctl echo`, as text and as JSON. Every sample also has a `stamp`: `sequence`, `sim_time` [s], `wall_time` [s], `valid`. Poses are `position` [m] and
`orientation` (w x y z). In ranges, null is "no hit" and -1 is "too near".

| type | info | sample |
| --- | --- | --- |
"""


def described(fields):
    words = [f"`{name}`" + (f" ({count})" if count > 1 else "") + (f" [{unit}]" if unit else "") for name, count, unit in fields if name != "stamp"]
    return ", ".join(words)


for one in types:
    elements = f"; of each: {described(one['element'])}" if one["element"] else ""
    out += f"| `{one['name']}` | {described(one['info'])} | {described(one['sample'])}{elements} |\n"
out += "\n## Structures\n\n"
for name, intro, fields in structs:
    out += f"### `{name}`, {numbers[name]} bytes\n\n" + (intro + "\n\n" if intro else "") + "| offset | size | field | type | meaning |\n| ---: | ---: | --- | --- | --- |\n"
    for kind, field, array, comment in fields:
        offset, size = numbers[f"{name}.{field}"].split()
        out += f"| {offset} | {size} | `{field}` | {kind}{array} | {comment} |\n"
    out += "\n"
out = out.rstrip() + "\n"

if "--check" in sys.argv:
    if not page.exists() or page.read_text() != out:
        sys.exit("docs/shared-memory.md is not what docs/make_shared_memory.py writes: run it")
else:
    page.write_text(out)
