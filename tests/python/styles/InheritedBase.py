import OpenRTM_aist, RTC
class InheritedBase(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._d = RTC.TimedLong(RTC.Time(0,0), 0)
    def onInitialize(self):
        self.out = OpenRTM_aist.OutPort("out", self._d)
        self.addOutPort("out", self.out)
        return RTC.RTC_OK
