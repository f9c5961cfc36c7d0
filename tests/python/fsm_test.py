# State machines in Python.
from OpenRTM_aist import StaticFSM

seen = []


@StaticFSM.FSM_TOPSTATE
class Top(StaticFSM.Link):
    class Data:
        def __init__(self):
            self.minutes = 0

    def onInit(self):
        self.set_state(StaticFSM.State(Ready))

    def open(self):
        pass

    def minute(self, count):
        pass

    def start(self):
        pass


@StaticFSM.FSM_SUBSTATE(Top)
class Ready(Top):
    def onInit(self):
        pass

    def onEntry(self):
        seen.append("ready")

    def onExit(self):
        seen.append("not ready")

    def minute(self, count):
        self.data(Top).minutes += count

    def start(self):
        self.set_state(StaticFSM.State(Cooking))


@StaticFSM.FSM_SUBSTATE(Top)
class Cooking(Top):
    def onInit(self):
        pass

    def onEntry(self):
        seen.append("cooking %d" % self.data(Top).minutes)

    def open(self):
        self.set_state(StaticFSM.State(Ready))


def test_events_wait_and_go_to_the_current_state_in_order():
    seen.clear()
    machine = StaticFSM.Machine(Top)
    assert machine.current() is Ready
    for event in (StaticFSM.Event(Top.minute, 2), StaticFSM.Event(Top.start), StaticFSM.Event(Top.minute, 5), StaticFSM.Event(Top.open)):
        machine.enqueue(event)
    assert seen == ["ready"]
    machine.run_event()
    assert seen == ["ready", "not ready", "cooking 2", "ready"]
    assert machine.current() is Ready
