"""States of an oven: substates that derive from Link alone get the events of their super states."""
import RTC
import OpenRTM_aist.StaticFSM as StaticFSM


def say(*words):
    print(*words, flush=True)


@StaticFSM.FSM_TOPSTATE
class TOP(StaticFSM.Link):
    class Data:
        def __init__(self):
            self.left = 0

    def onInit(self):
        self.set_state(StaticFSM.State(Closed))
        return RTC.RTC_OK

    def heat(self, time):
        pass

    def door(self):
        pass

    def tick(self):
        pass


@StaticFSM.FSM_SUBSTATE(TOP)
class Opened(StaticFSM.Link):
    def onEntry(self):
        say("opened")
        return RTC.RTC_OK

    def door(self):
        self.set_state(StaticFSM.State(Closed))


@StaticFSM.deephistory
@StaticFSM.FSM_SUBSTATE(TOP)
class Closed(StaticFSM.Link):
    def onInit(self):
        self.set_state(StaticFSM.State(Cold))
        return RTC.RTC_OK

    def door(self):
        self.set_state(StaticFSM.State(Opened))


@StaticFSM.FSM_SUBSTATE(Closed)
class Cold(StaticFSM.Link):
    def onEntry(self):
        say("cold")
        return RTC.RTC_OK

    def heat(self, time):
        self.set_state(StaticFSM.State(Hot))
        self.dispatch(StaticFSM.Event(TOP.heat, time))


@StaticFSM.FSM_SUBSTATE(Closed)
class Hot(StaticFSM.Link):
    def onEntry(self):
        say("hot")
        return RTC.RTC_OK

    def onExit(self):
        say("off")
        return RTC.RTC_OK

    def heat(self, time):
        self.data(TOP).left += time.data
        say("left", self.data(TOP).left)

    def tick(self):
        self.data(TOP).left -= 1
        say("left", self.data(TOP).left)
        if self.data(TOP).left == 0:
            self.set_state(StaticFSM.State(Cold))
