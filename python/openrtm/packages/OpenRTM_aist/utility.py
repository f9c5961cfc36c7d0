"""Small helpers of the classic API."""
import threading
import time

import _openrtm_core as _core

__all__ = ["Async_tInvoker", "Async_t", "Async_ref_t", "ScopedLock", "Task", "Time", "TimeValue", "TimeMeasure", "ClockManager",
           "Guard"]


class uuid1:
    def __str__(self):
        import uuid
        return str(uuid.uuid1())


class Async_tInvoker:
    """Runs functor(obj, *args) in a thread."""

    def __init__(self, obj, functor, *args):
        self._call = (functor, obj, args)
        self._thread = None

    def invoke(self):
        functor, obj, args = self._call
        self._thread = threading.Thread(target=functor, args=(obj,) + args, daemon=True)
        self._thread.start()

    def wait(self):
        if self._thread is not None:
            self._thread.join()

    def finished(self):
        return self._thread is None or not self._thread.is_alive()


Async_t = Async_ref_t = Async_tInvoker


class ScopedLock:
    """Holds the mutex as long as it lives."""

    def __init__(self, mutex):
        self.mutex = mutex
        mutex.acquire()

    def __del__(self):
        self.mutex.release()


Guard = ScopedLock


class Task:
    """A thread that runs svc()."""

    def __init__(self):
        self._thread = None
        self._running = False

    def open(self, args=None):
        return 0

    def close(self, flags=0):
        return 0

    def svc(self):
        return 0

    def activate(self):
        if self._running:
            return
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        try:
            self.svc()
        finally:
            self._running = False

    def wait(self):
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
        return 0

    def reset(self):
        self._running = False

    def finalize(self):
        self.reset()


class TimeValue:
    def __init__(self, sec=None, usec=None):
        if isinstance(sec, TimeValue):
            sec, usec = sec.tv_sec, sec.tv_usec
        if sec is not None and usec is None:
            total = int(round(float(sec) * 1000000))
            sec, usec = divmod(total, 1000000)
        self.tv_sec, self.tv_usec = int(sec or 0), int(usec or 0)

    def sec(self):
        return self.tv_sec

    def usec(self):
        return self.tv_usec

    def toDouble(self):
        return self.tv_sec + self.tv_usec / 1000000.0

    def getTime(self):
        return self

    def set_time(self, value):
        other = TimeValue(value)
        self.tv_sec, self.tv_usec = other.tv_sec, other.tv_usec
        return self

    def __add__(self, other):
        return TimeValue(self.toDouble() + TimeValue(other).toDouble())

    def __sub__(self, other):
        return TimeValue(self.toDouble() - TimeValue(other).toDouble())

    def __str__(self):
        return "%f" % self.toDouble()

    def sign(self):
        value = self.toDouble()
        return (value > 0) - (value < 0)


class Time:
    """The time of now, by the clock in force."""

    def __init__(self):
        self.sec, nsec = _core.current_time()
        self.usec = nsec // 1000

    def getTime(self):
        return TimeValue(self.sec, self.usec)

    gettimeofday = getTime


class TimeMeasure:
    """Durations between tick() and tack(), and their statistics."""

    class Statistics:
        def __init__(self, max_=0.0, min_=0.0, mean=0.0, stdd=0.0):
            self._max_interval, self._min_interval, self._mean_interval, self._std_deviation = max_, min_, mean, stdd

    def __init__(self, buflen=100):
        self._length = buflen
        self._begin = None
        self._durations = []

    def tick(self):
        self._begin = time.perf_counter()

    def tack(self):
        if self._begin is not None:
            self._durations.append(time.perf_counter() - self._begin)
            del self._durations[:-self._length]

    def interval(self):
        return TimeValue(self._durations[-1] if self._durations else 0)

    def count(self):
        return len(self._durations)

    def reset(self):
        self._begin, self._durations = None, []

    def getStatistics(self, max_interval=None, min_interval=None, mean_interval=None, stddev=None):
        found = TimeMeasure.Statistics()
        values = self._durations
        if values:
            mean = sum(values) / len(values)
            spread = (max(sum(one * one for one in values) / len(values) - mean * mean, 0)) ** 0.5
            found = TimeMeasure.Statistics(max(values), min(values), mean, spread)
        if max_interval is None:
            return found
        for place, value in ((max_interval, found._max_interval), (min_interval, found._min_interval),
                             (mean_interval, found._mean_interval), (stddev, found._std_deviation)):
            place[0] = value
        return bool(values)


class _Clock:
    def gettime(self):
        return Time().getTime()

    def settime(self, value):
        return False


class _SystemClock(_Clock):
    def gettime(self):
        return TimeValue(time.time())


class ClockManager:
    _instance = None

    @staticmethod
    def instance():
        if ClockManager._instance is None:
            ClockManager._instance = ClockManager()
        return ClockManager._instance

    def getClock(self, name):
        """ "logical" and "adjusted" are the clock in force, "system" is the wall clock."""
        return _SystemClock() if name == "system" else _Clock()
