"""Recording: samples of a recorded run (MCAP) as numpy arrays."""
from __future__ import annotations

import fnmatch

import numpy

from . import _core
from ._cdr import decoder
from ._core import Error, NotFound
from ._recording import File


class Recording:
    """A recording of rtse run --record, rtse record, or of another program that writes MCAP.

        with rtmsim.Recording("run.mcap") as recording:
            scans = recording.samples("/sim/laser/pioneer2dx/laser")
            print(scans["time"], scans["ranges"].shape)

    Times are simulated seconds. Error: the file cannot be read, or is none. NotFound: no such channel. `damage` says what of a broken file
    is missing. One thread at a time.
    """

    def __init__(self, file):
        self.file = _core.path("file", file)
        self._file = File(self.file)
        self._channels = self._file.channels
        self._decoders: dict = {}
        self._is_iterated = False

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file. Arrays stay valid."""
        self._file = None

    def _open(self):
        if self._file is None:
            raise Error(f"{self.file}: is closed")
        return self._file

    @property
    def channels(self) -> dict[str, int]:
        """Number of samples by channel (topic): "/COMPONENT/PORT", "/sim/laser/NAME", "/tf", "/log", ..."""
        counts: dict[str, int] = {}
        for channel in self._channels.values():
            counts[channel["topic"]] = counts.get(channel["topic"], 0) + channel["messages"]
        return dict(sorted(counts.items()))

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return self._open().span[0] / 1e9

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return self._open().span[1] / 1e9

    @property
    def damage(self) -> str:
        """What could not be read, in one line; empty: the file is whole."""
        return self._open().damage

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """Metadata of the file; "run" has world, seed, step_ns and versions."""
        return self._open().metadata

    @property
    def attachments(self) -> list[str]:
        """Names, as "world.sdf", "system.xml"."""
        return self._open().attachments

    def attachment(self, name: str) -> bytes:
        """Content of an attachment."""
        return self._open().attachment(_core.text("name", name))

    def _ids(self, topic: str) -> list[int]:
        if ":" in _core.text("topic", topic) and not topic.startswith("/"):
            topic = "/" + topic.replace(":", "/", 1)
        ids = [number for number, channel in self._channels.items() if fnmatch.fnmatchcase(channel["topic"], topic)]
        if not ids:
            raise NotFound(f"{self.file}: has no channel {topic!r}; channels: {', '.join(self.channels)}")
        return ids

    def messages(self, *topics: str, start: float = 0.0, end: float | None = None):
        """Yields (topic, time [s], value) in the order of time. Values are dicts; sequences of numbers in them are numpy arrays. `topics`:
        names or patterns with *; "COMPONENT:PORT" is a name, too; none: all that can be decoded."""
        ids = sorted({number for topic in topics for number in self._ids(topic)})
        first = round(_core.seconds("start", start) * 1e9)
        last = (1 << 64) - 1 if end is None else round(_core.seconds("end", end) * 1e9)
        # Each of several iterators at a time has a place of its own in the file.
        own = File(self.file) if self._is_iterated else None
        file = own or self._open()
        self._is_iterated = True
        try:
            file.seek(ids, first, last)
            while True:
                batch = file.read(1000)
                for number, time, data in batch:
                    decode = self._decoder(number, bool(topics))
                    if decode is not None:
                        yield self._channels[number]["topic"], time / 1e9, decode(data)
                if len(batch) < 1000:
                    return
        finally:
            if own is None:
                self._is_iterated = False

    def _decoder(self, number: int, is_asked_for: bool):
        if number not in self._decoders:
            channel = self._channels[number]
            try:
                self._decoders[number] = decoder(channel["encoding"], channel["schema_encoding"], channel["schema_text"], channel["schema"])
            except Error as problem:
                self._decoders[number] = problem
        found = self._decoders[number]
        if not isinstance(found, Error):
            return found
        if is_asked_for:
            raise Error(f"channel {self._channels[number]['topic']}: {found}")
        return None

    def samples(self, topic: str, *, start: float = 0.0, end: float | None = None) -> dict:
        """All samples of a channel: "time" [s], float64 (n,), and an array for each number or text of a sample by its place, as "data.vx".
        Sequences of one length become (n, length), others arrays of objects."""
        times, columns = [], {}
        for _, time, value in self.messages(topic, start=start, end=end):
            for place, member in _members(value):
                columns.setdefault(place, []).append((len(times), member))
            times.append(time)
        return {"time": numpy.array(times, numpy.float64), **{place: _column(cells, len(times)) for place, cells in columns.items()}}


def _members(value, place: str = ""):
    if isinstance(value, dict):
        for key, member in value.items():
            yield from _members(member, f"{place}.{key}" if place else key)
    elif isinstance(value, list):
        for index, member in enumerate(value):
            yield from _members(member, f"{place}[{index}]")
    else:
        yield place, value


def _column(cells, count: int):
    values = [member for _, member in cells]
    if len(values) == count:
        if isinstance(values[0], numpy.ndarray):
            if len({value.shape for value in values}) == 1:
                return numpy.stack(values)
        elif not any(value is None for value in values):
            return numpy.array(values)
    column = numpy.empty(count, object)
    for index, member in cells:
        column[index] = member
    return column
