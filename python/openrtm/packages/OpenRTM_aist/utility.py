"""Small helpers of the classic API."""
import threading
import time

import _openrtm_core as _core

__all__ = ["Async_tInvoker", "Async_ref_tInvoker", "Async_t", "Async_ref_t", "ScopedLock", "Task", "Time", "TimeValue", "TimeMeasure",
           "ClockManager", "SystemClock", "LogicalClock", "AdjustedClock", "Guard", "Timer", "PeriodicTask", "ListenerObject", "ListenerFunc", "toTypename"]


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


Async_t = Async_ref_t = Async_ref_tInvoker = Async_tInvoker


class ScopedLock:
    """Holds the mutex as long as it lives."""

    def __init__(self, mutex):
        self.mutex = mutex
        mutex.acquire()

    def __del__(self):
        self.mutex.release()


class Guard(ScopedLock):
    ScopedLock = ScopedLock


class Task:
    """A thread that runs svc()."""
    __thread = None
    __runs = False

    def __init__(self):
        pass

    def open(self, args=None):
        return 0

    def close(self, flags=0):
        return 0

    def svc(self):
        return 0

    def activate(self):
        if self.__runs:
            return
        self.__runs = True
        self.__told = getattr(self, "_rtm_loop_is_over", lambda is_over: None)  # of a context whose loop this is
        self.__told(False)
        self.__thread = threading.Thread(target=self.__run, daemon=True)
        self.__thread.start()

    def __run(self):
        try:
            self.svc()
        finally:
            self.__runs = False
            self.__told(True)

    def wait(self):
        if self.__thread is not None and self.__thread is not threading.current_thread():
            self.__thread.join()
        return 0

    def reset(self):
        self.__runs = False

    def finalize(self):
        self.reset()


class TimeValue:
    """A duration: seconds and microseconds, both of the same sign."""

    def __init__(self, sec=None, usec=None):
        if isinstance(sec, TimeValue):
            sec, usec = sec.tv_sec, sec.tv_usec
        if usec is None:
            sec, usec = 0, round(float(sec or 0) * 1000000)
        self.tv_sec, self.tv_usec = int(sec or 0), int(usec)
        self.normalize()

    def normalize(self):
        """Carries whole seconds of tv_usec to tv_sec, and makes both signs the same. For sources that set the two attributes."""
        total = self.tv_sec * 1000000 + self.tv_usec
        sign = -1 if total < 0 else 1
        sec, usec = divmod(abs(total), 1000000)
        self.tv_sec, self.tv_usec = sign * sec, sign * usec

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
    """The time of now, by the clock in force; a difference of two is a Time, too."""

    def __init__(self, sec=None, usec=0):
        if sec is not None:
            self.sec, self.usec = sec, usec
            return
        self.sec, nsec = _core.current_time()
        self.usec = nsec // 1000

    def __sub__(self, other):
        sec, usec = divmod((self.sec - other.sec) * 1000000 + self.usec - other.usec, 1000000)
        return Time(sec, usec)

    def __add__(self, other):
        return Time(*divmod((self.sec + other.sec) * 1000000 + self.usec + other.usec, 1000000))

    def getTime(self):
        return TimeValue(self.sec, self.usec)

    gettimeofday = getTime



class ListenerObject:
    """Calls function(obj)."""

    def __init__(self, obj, function):
        self.invoke = lambda: function(obj)


class ListenerFunc:
    def __init__(self, function):
        self.invoke = function


class PeriodicTask:
    """Calls a function at a period on a thread of its own: setTask, setPeriod, activate; finalize ends it."""

    def __init__(self):
        self.__function = None
        self.__period = 0.0
        self.__thread = None
        self.__changed = threading.Condition()
        self.__is_over = self.__is_suspended = self.__is_told = False
        self.__measures_execution = self.__measures_period = True
        self.__execution, self.__between = TimeMeasure(1000), TimeMeasure(1000)

    def setTask(self, function, delete_in_dtor=True):
        self.__function = getattr(function, "svc", function)
        return True

    def setPeriod(self, period):
        """Seconds, or a TimeValue."""
        self.__period = period.toDouble() if hasattr(period, "toDouble") else float(period)

    def activate(self):
        if self.__thread is None and self.__function is not None:
            self.__is_over = False
            self.__thread = threading.Thread(target=self.__run, daemon=True)
            self.__thread.start()

    def suspend(self):
        self.__is_suspended = True
        return 0

    def resume(self):
        with self.__changed:
            self.__is_suspended = False
            self.__changed.notify()
        return 0

    def signal(self):
        """Call it now, although its time has not come or it is suspended."""
        with self.__changed:
            self.__is_told = True
            self.__changed.notify()

    def finalize(self):
        with self.__changed:
            self.__is_over = True
            self.__changed.notify()
        if self.__thread is not None and self.__thread is not threading.current_thread():
            self.__thread.join()
        self.__thread = None

    def executionMeasure(self, value):
        """Switches the measurement of the duration of each call; it is on from the start."""
        self.__measures_execution = bool(value)

    def executionMeasureCount(self, n):
        """Begins a new measurement that keeps the last n durations."""
        with self.__changed:
            self.__execution = TimeMeasure(max(n, 1))

    def periodicMeasure(self, value):
        """Switches the measurement of the time between calls; it is on from the start."""
        self.__measures_period = bool(value)

    def periodicMeasureCount(self, n):
        """Begins a new measurement that keeps the last n durations."""
        with self.__changed:
            self.__between = TimeMeasure(max(n, 1))

    def getExecStat(self):
        with self.__changed:
            return self.__execution.getStatistics()

    def getPeriodStat(self):
        with self.__changed:
            return self.__between.getStatistics()

    def __run(self):
        due = time.monotonic()
        while True:
            with self.__changed:
                self.__changed.wait_for(lambda: self.__is_over or self.__is_told, max(due - time.monotonic(), 0))
                self.__changed.wait_for(lambda: self.__is_over or self.__is_told or not self.__is_suspended)
                if self.__is_over:
                    return
                self.__is_told = False
                if self.__measures_period:
                    self.__between.tack()
                    self.__between.tick()
                if self.__measures_execution:
                    self.__execution.tick()
            self.__function()
            with self.__changed:
                if self.__measures_execution:
                    self.__execution.tack()
            due = max(due + self.__period, time.monotonic())


class Timer:
    """Calls listeners at their periods, on a thread of its own between start() and stop()."""

    def __init__(self, interval):
        self._interval = interval
        self._tasks = {}
        self._is_running = False

    def registerListener(self, listener, period):
        task = PeriodicTask()
        task.setTask(listener.invoke)
        task.setPeriod(period)
        self._tasks[listener] = task
        if self._is_running:
            task.activate()
        return listener

    def registerListenerObj(self, obj, function, period):
        return self.registerListener(ListenerObject(obj, function), period)

    def registerListenerFunc(self, function, period):
        return self.registerListener(ListenerFunc(function), period)

    def unregisterListener(self, listener):
        task = self._tasks.pop(listener, None)
        if task is not None:
            task.finalize()
        return task is not None

    def start(self):
        self._is_running = True
        for task in list(self._tasks.values()):
            task.activate()

    def stop(self):
        self._is_running = False
        for task in list(self._tasks.values()):
            task.finalize()


class _Factory:
    """The factory of one kind of object in this process; the methods return 0 for success, 2 and 3 for an id that exists, that does not."""
    FACTORY_OK, FACTORY_ERROR, ALREADY_EXISTS, NOT_FOUND, INVALID_ARG, UNKNOWN_ERROR = range(6)

    @classmethod
    def instance(cls):
        if "_the_one" not in vars(cls):
            cls._the_one = cls()
            cls._the_one._creators = {}
        return cls._the_one

    def addFactory(self, id_, creator, deleter=None):
        if not id_ or not callable(creator):
            return self.INVALID_ARG
        code = self._add(id_, creator)
        if code == self.FACTORY_OK:
            self._creators[id_] = creator
        return code

    def removeFactory(self, id_):
        self._creators.pop(id_, None)
        return self._remove(id_)

    def hasFactory(self, id_):
        return id_ in self.getIdentifiers()

    def getIdentifiers(self):
        return list(self._identifiers())

    def createObject(self, id_):
        """Of those that Python has registered; None for others."""
        return self._creators[id_]() if id_ in self._creators else None

    def deleteObject(self, object_, id_=None):
        return self.FACTORY_OK


def toTypename(value):
    """The repository id of a value of an IDL type."""
    return value._NP_RepositoryId


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


class LogicalClock:
    """The clock in force: simulated time in simulated contexts."""

    def gettime(self):
        return Time().getTime()

    def settime(self, value):
        return False


class AdjustedClock(LogicalClock):
    pass


class SystemClock(LogicalClock):
    """The wall clock."""

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
        return SystemClock() if name == "system" else LogicalClock()
