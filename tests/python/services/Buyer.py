"""Calls Shop::Counter by its port `counter`."""
import sys

import OpenRTM_aist
import RTC
import Shop

buyer_spec = ["implementation_id", "Buyer", "type_name", "Buyer", "description", "Uses a counter", "version", "1.0", "vendor", "rtm-sim",
              "category", "test", "activity_type", "DataFlowComponent", "max_instance", "1", "language", "Python", "lang_type", "script", ""]


class Buyer(OpenRTM_aist.DataFlowComponentBase):
    def __init__(self, manager):
        OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)
        self._counterPort = OpenRTM_aist.CorbaPort("counter")
        self._counter = OpenRTM_aist.CorbaConsumer(interfaceType=Shop.Counter)

    def onInitialize(self):
        self._counterPort.registerConsumer("counter0", "Shop::Counter", self._counter)
        self.addPort(self._counterPort)
        self._done = False
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        if self._counter._ptr() is None or self._done:
            return RTC.RTC_OK
        self._done = True
        item, left, last = self._counter._ptr().buy("apple", 5)
        print("bought", item, left, last, flush=True)
        try:
            self._counter._ptr().buy("gone", 1)
        except Shop.Sold as sold:
            print("sold out", sold.what, sold.left, flush=True)
        return RTC.RTC_OK


def MyModuleInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=buyer_spec), Buyer, OpenRTM_aist.Delete)
    manager.createComponent("Buyer")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
