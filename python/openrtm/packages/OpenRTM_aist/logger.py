"""The logger of components: lines of the runtime's log."""
import sys

import _openrtm_core as _core

__all__ = ["Logger", "LogStream", "SILENT", "FATAL", "ERROR", "WARN", "INFO", "DEBUG", "TRACE", "VERBOSE", "PARANOID"]

SILENT, FATAL, ERROR, WARN, INFO, DEBUG, TRACE, VERBOSE, PARANOID = range(9)
_NAMES = ("SILENT", "FATAL", "ERROR", "WARN", "INFO", "DEBUG", "TRACE", "VERBOSE", "PARANOID")


class Logger:
    SILENT, FATAL, ERROR, WARN, INFO, DEBUG, TRACE, VERBOSE, PARANOID = range(9)

    def __init__(self, name=""):
        self._name = name
        self._logger = _core.Logger(name)

    def getLogger(self, name):
        return Logger(self._name + "." + name if self._name else name)

    def setLevel(self, level):
        return self._logger.setLevel(level) if isinstance(level, int) else self._logger._set_level(str(level))

    setLogLevel = setLevel

    def isValid(self, level):
        return self._logger.isValid(level)

    def setDateFormat(self, text):
        pass

    def setLogLock(self, lock):
        pass

    def RTC_LOG(self, level, message, opt=None):
        if isinstance(level, str):
            level = _NAMES.index(level) if level in _NAMES else INFO
        if not self._logger.isValid(level):
            return
        try:
            text = message if opt is None else message % opt
        except (TypeError, ValueError) as problem:
            text = "%s: argument error: %s" % (message, problem)
        self._logger._write(level, str(text))

    def RTC_FATAL(self, message, opt=None):
        self.RTC_LOG(FATAL, message, opt)

    def RTC_ERROR(self, message, opt=None):
        self.RTC_LOG(ERROR, message, opt)

    def RTC_WARN(self, message, opt=None):
        self.RTC_LOG(WARN, message, opt)

    def RTC_INFO(self, message, opt=None):
        self.RTC_LOG(INFO, message, opt)

    def RTC_DEBUG(self, message, opt=None):
        self.RTC_LOG(DEBUG, message, opt)

    def RTC_TRACE(self, message, opt=None):
        self.RTC_LOG(TRACE, message, opt)

    def RTC_VERBOSE(self, message, opt=None):
        self.RTC_LOG(VERBOSE, message, opt)

    def RTC_PARANOID(self, message, opt=None):
        self.RTC_LOG(PARANOID, message, opt)

    @staticmethod
    def print_exception():
        """The exception that is being handled, as text with its traceback."""
        import traceback
        return "".join(traceback.format_exception(*sys.exc_info()))


LogStream = Logger
