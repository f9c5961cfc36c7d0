"""State machines of components: states are classes, events are calls of their methods.

A machine is of one thread: run_event() handles the events that wait. State methods: onInit, onEntry, onExit, and events with at most one
argument, which are dispatched to the current state.
"""
import collections
import threading

import RTC

__all__ = ["FSM_TOPSTATE", "FSM_SUBSTATE", "deephistory", "history", "Link", "State", "Event", "Machine"]

_INIT, _ENTRY, _DO, _EXIT, _STATE_CHANGE = range(5)


class State:
    """A state to change to."""

    def __init__(self, state_class, data=None):
        self.state_class = state_class
        self.data = data


class Event:
    """An event that waits: a method of the top state and its arguments."""

    def __init__(self, method, *args):
        self.name = method if isinstance(method, str) else method.__name__
        self.args = args


class Link:
    """Base of all states. An instance is made once for each machine."""

    _history = None

    def __init__(self, machine):
        self._rtm_machine = machine

    def onInit(self):
        pass

    def onEntry(self):
        pass

    def onExit(self):
        pass

    on_init, on_entry, on_exit = onInit, onEntry, onExit

    def set_state(self, state):
        self._rtm_machine.change(state)

    setState = set_state

    def setStateHistory(self, state):
        self._rtm_machine.change(state, with_history=True)

    def setStateDirect(self, state):
        self._rtm_machine.change(state)

    def dispatch(self, event):
        self._rtm_machine.dispatch(event)

    def data(self, state_class=None):
        return self._rtm_machine.data_of(state_class or type(self))

    @property
    def rtComponent(self):
        return self._rtm_machine.component


def FSM_TOPSTATE(cls):
    cls._super = None
    return cls


def FSM_SUBSTATE(super_state):
    def decorate(cls):
        cls._super = super_state
        return cls
    return decorate


def deephistory(cls):
    cls._history = "deep"
    return cls


def history(cls):
    cls._history = "shallow"
    return cls


class Machine:
    """A machine in its top state; the component may be None."""

    def __init__(self, top, component=None):
        self.component = component
        self._tells = hasattr(component, "_rtm_tell_fsm")
        self._top = top
        self._states, self._data, self._last = {}, {}, {}
        self._waiting = collections.deque()
        self._dispatched = collections.deque()
        self._is_handling = True
        self._lock = threading.Lock()
        self._next = None
        self._current = top
        if self._tells:
            from .fsm_service import offer
            offer(self, top)
        self._enter_from(None, top)
        self._settle()
        self._is_handling = False
        self._handle_dispatched()

    # --- for states

    def change(self, state, with_history=False):
        target = state.state_class if isinstance(state, State) else state
        if with_history and target in self._last:
            target = self._last[target]
        self._next = target

    def enqueue(self, event):
        with self._lock:
            self._waiting.append(event)

    def data_of(self, cls):
        if cls not in self._data:
            made = getattr(cls, "Data", None)
            self._data[cls] = made() if made else None
        return self._data[cls]

    # --- for components

    def run_event(self):
        """Handle the events that wait. States may add others."""
        while True:
            with self._lock:
                if not self._waiting:
                    return
                event = self._waiting.popleft()
            self.dispatch(event)

    def dispatch(self, event):
        """Handle the event now, and those that states dispatch meanwhile. From a state: after the event that it handles."""
        self._dispatched.append(event)
        if not self._is_handling:
            self._handle_dispatched()

    handle = dispatch

    def shutdown(self):
        """Leave all states; events are ignored from now on."""
        if self._current is None:
            return
        for cls in reversed(self._path(self._current)):
            self._told(_EXIT, cls, self._state(cls).onExit)
        self._current = None

    def current(self):
        return self._current

    # --- the inside

    def _handle_dispatched(self):
        self._is_handling = True
        try:
            while self._dispatched:
                self._handle(self._dispatched.popleft())
        finally:
            self._is_handling = False
            self._dispatched.clear()

    # The nearest state of the path that has such a method handles it; the others ignore it.
    def _handle(self, event):
        if self._current is None:
            return
        for cls in reversed(self._path(self._current)):
            if hasattr(cls, event.name):
                self._told(_DO, cls, lambda: getattr(self._state(cls), event.name)(*event.args))
                self._settle()
                return

    def _state(self, cls):
        if cls not in self._states:
            self._states[cls] = cls(self)
        return self._states[cls]

    @staticmethod
    def _path(cls):
        path = []
        while cls is not None:
            path.insert(0, cls)
            cls = getattr(cls, "_super", None)
        return path

    def _enter_from(self, old, new):
        for cls in self._path(new)[len(self._common(old, new)):]:
            self._told(_ENTRY, cls, self._state(cls).onEntry)
        self._current = new
        self._next = None
        self._told(_INIT, new, self._state(new).onInit)

    # Calls it between the listeners of before and after.
    def _told(self, action, cls, call, after=None):
        if not self._tells:
            return call()
        self.component._rtm_tell_fsm(False, action, cls.__name__, RTC.RTC_OK)
        code = call()
        is_code = getattr(code, "_parent_id", None) == RTC.ReturnCode_t._NP_RepositoryId
        self.component._rtm_tell_fsm(True, action, (after() if after else cls).__name__, code if is_code else RTC.RTC_OK)

    def _common(self, old, new):
        common = []
        for one, two in zip(self._path(old), self._path(new)):
            if one is not two or one is new:
                break
            common.append(one)
        return common

    # Changes until no state asks for a further change.
    def _settle(self):
        while self._next is not None:
            self._told(_STATE_CHANGE, self._current, self._change, lambda: self._current)

    def _change(self):
        old, new = self._current, self._next
        for cls in reversed(self._path(old)[len(self._common(old, new)):]):
            self._told(_EXIT, cls, self._state(cls).onExit)
            if getattr(cls, "_history", None):
                self._last[cls] = old
        self._enter_from(old, new)
