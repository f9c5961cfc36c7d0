"""Selection among CSP ports (csp.py). Any thread."""
import threading
import time

__all__ = ["CSPManager"]

# Two managers that select from each other wait in turns: each asks the other again after this time [s].
_TURN = 0.05


class CSPManager:
    """Selects among CSP ports the one that can go on."""

    def __init__(self):
        self._csp_inports, self._csp_outports = [], []
        self._csp_changed = threading.Condition()
        self._csp_waits = False
        self._csp_chosen = None

    def addInPort(self, port):
        self._csp_inports.append(port)

    def addOutPort(self, port):
        self._csp_outports.append(port)

    def removeInPort(self, port):
        self._csp_inports.remove(port)

    def removeOutPort(self, port):
        self._csp_outports.remove(port)

    def reset(self):
        for port in self._csp_inports + self._csp_outports:
            port.releaseManager()
        self._csp_inports, self._csp_outports = [], []

    def selectOutPort(self):
        port = next((one for one in self._csp_outports if one.select()), None)
        return port is not None, port

    def selectInPort(self):
        port = next((one for one in self._csp_inports if one.select()), None)
        return port is not None, port

    def select(self, timeout):
        """(True, outport, None) or (True, None, inport): write it by writeData(), read it by readData(). (False, None, None): time is up."""
        end = time.monotonic() + max(timeout, 0)
        while True:
            found, port = self.selectOutPort()
            if found:
                return True, port, None
            found, port = self.selectInPort()
            if found:
                return True, None, port
            left = end - time.monotonic()
            if left <= 0:
                return False, None, None
            port = self._wait(min(left, _TURN))
            if port is not None:
                return (True, port, None) if port in self._csp_outports else (True, None, port)

    def notify(self, outport=None, inport=None):
        """End the wait of select() with this port. False if no call of select() is waiting."""
        with self._csp_changed:
            if not self._csp_waits or self._csp_chosen is not None:
                return False
            self._csp_chosen = outport or inport
            self._csp_changed.notify()
            return True

    def _wait(self, seconds):
        with self._csp_changed:
            self._csp_waits = True
            self._csp_changed.wait_for(lambda: self._csp_chosen is not None, max(seconds, 0))
            self._csp_waits = False
            port, self._csp_chosen = self._csp_chosen, None
            return port
