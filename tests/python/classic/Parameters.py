#!/usr/bin/env python3
"""Prints its parameters when they change."""
import sys
import time

import OpenRTM_aist
import RTC

parameters_spec = ["implementation_id", "Parameters", "type_name", "Parameters", "description", "a test", "version", "1.0", "vendor", "rtm-sim", "category", "test",
    "activity_type", "DataFlowComponent", "max_instance", "10", "language", "Python", "lang_type", "script",
    "conf.default.int_param0", "0", "conf.default.double_param0", "0.11", "conf.default.str_param0", "hoge",
    "conf.default.vector_param0", "0.0,1.0,2.0,3.0,4.0", "conf.fast.int_param0", "7", "conf.__widget__.int_param0", "slider.1",
    "conf.__constraints__.int_param0", "0<=x<=150",
    ""]


class Heard:
    def __init__(self, kind):
        self._kind = kind

    def __call__(self, *args):
        print("heard", self._kind, *[one if isinstance(one, str) else type(one).__name__ for one in args], flush=True)


class Parameters(OpenRTM_aist.DataFlowComponentBase):
    def onInitialize(self):
        self._int_param0 = [0]
        self._double_param0 = [0.11]
        self._str_param0 = ["hoge"]
        self._vector_param0 = [[0.0, 1.0, 2.0, 3.0, 4.0]]
        self.bindParameter("int_param0", self._int_param0, "0")
        self.bindParameter("double_param0", self._double_param0, "0.11")
        self.bindParameter("str_param0", self._str_param0, "hoge")
        self.bindParameter("vector_param0", self._vector_param0, "0.0,1.0,2.0,3.0,4.0")
        self.addConfigurationParamListener(OpenRTM_aist.ConfigurationParamListenerType.ON_UPDATE_CONFIG_PARAM, Heard("parameter"))
        self.addConfigurationSetListener(OpenRTM_aist.ConfigurationSetListenerType.ON_SET_CONFIG_SET, Heard("set"))
        self.addConfigurationSetNameListener(OpenRTM_aist.ConfigurationSetNameListenerType.ON_ACTIVATE_CONFIG_SET, Heard("activate"))
        self._shown = None
        return RTC.RTC_OK

    def onExecute(self, ec_id):
        now = (self._int_param0[0], self._double_param0[0], self._str_param0[0], list(self._vector_param0[0]))
        if now != self._shown:
            self._shown = now
            print("parameters", *now, flush=True)
        return RTC.RTC_OK


def ParametersInit(manager):
    manager.registerFactory(OpenRTM_aist.Properties(defaults_str=parameters_spec), Parameters, OpenRTM_aist.Delete)


def MyModuleInit(manager):
    ParametersInit(manager)
    manager.createComponent("Parameters")


if __name__ == "__main__":
    mgr = OpenRTM_aist.Manager.init(sys.argv)
    mgr.setModuleInitProc(MyModuleInit)
    mgr.activateManager()
    mgr.runManager()
