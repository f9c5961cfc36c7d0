"""A stand-in for a toolkit of windows, whose loop must run in the main thread."""
import queue
import threading


class Window:
    def __init__(self):
        if threading.current_thread() is not threading.main_thread():
            raise RuntimeError("main thread is not in main loop")
        self._events = queue.Queue()
        self.position = [0.0, 0.0]

    def get(self):
        return list(self.position)

    def set_on_update(self, function):
        self._function = function

    def after(self, event):
        self._events.put(event)

    def quit(self):
        self._events.put(None)

    def mainloop(self):
        while True:
            event = self._events.get(timeout=60)
            if event is None:
                return
            self._function(event)
