"""Provides Shop::Counter by its port `counter`."""
import sys

import OpenRTM_aist
import RTC

from counter import Counter_i

seller_spec = ["implementation_id", "Seller", "type_name", "Seller", "description", "Provides a counter", "version", "1.0", "vendor", "rtm-sim",
               "category", "test", "activity_type", "DataFlowComponent", "max_instance", "1", "language", "Python", "lang_type", "script", ""]


class Seller(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._counterPort = OpenRTM_aist.CorbaPort("counter")
        self._counter = Counter_i()
        self._counterPort.registerProvider("counter0", "Shop::Counter", self._counter)
        self.addPort(self._counterPort)
        return RTC.RTC_OK


def MyModuleInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=seller_spec), Seller, OpenRTM_aist.Delete)
    manager.createComponent("Seller")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
