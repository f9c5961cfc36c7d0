"""A state machine that handles the events of its CSP ports."""
from .StaticFSM import Machine
from .csp_manager import CSPManager

__all__ = ["CSPMachine"]


class CSPMachine(Machine, CSPManager):
    def __init__(self, top, component=None):
        CSPManager.__init__(self)
        Machine.__init__(self, top, component)

    def run_event(self, timeout=10):
        """Handle the next event, or write the next value. The port, or None if time is up [s]."""
        found, outport, inport = self.select(timeout)
        if not found:
            return None
        if inport is not None:
            inport.readData()()
            return inport
        outport.write()
        return outport
