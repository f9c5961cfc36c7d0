# -*- Python -*-

import sys
import time
sys.path.append(".")

# Import RTM module
import OpenRTM_aist
import RTC

# Import Service implementation class
# <rtc-template block="service_impl">

# </rtc-template>

# Import Service stub modules
# <rtc-template block="consumer_import">
# </rtc-template>


# This module's spesification
# <rtc-template block="module_spec">
template10_spec = ["implementation_id", "Template10",
		 "type_name",         "Template10",
		 "description",       "ModuleDescription",
		 "version",           "1.0.0",
		 "vendor",            "VenderName",
		 "category",          "Category",
		 "activity_type",     "STATIC",
		 "max_instance",      "1",
		 "language",          "Python",
		 "lang_type",         "SCRIPT",
		 "conf.default.gain", "1.0",
		 "conf.default.count", "3",
		 "conf.default.name", "abc",
		 "conf.default.list", "1,2,3",
		 "conf.__widget__.gain", "slider.0.01",
		 "conf.__constraints__.gain", "0.0<x<2.0",
		 ""]
# </rtc-template>

class Template10(OpenRTM_aist.DataFlowComponentBase):

	"""
	@class Template10
	@brief ModuleDescription

	"""
	def __init__(self, manager):
		"""
		@brief constructor
		@param manager Maneger Object
		"""
		OpenRTM_aist.DataFlowComponentBase.__init__(self, manager)

		self._d_in = RTC.TimedLong(RTC.Time(0,0),0)
		"""
		"""
		self._inIn = OpenRTM_aist.InPort("in", self._d_in, OpenRTM_aist.RingBuffer(8))
		self._d_out = RTC.TimedLong(RTC.Time(0,0),0)
		self._outOut = OpenRTM_aist.OutPort("out", self._d_out, OpenRTM_aist.RingBuffer(8))

		# Set InPort buffers
		self.registerInPort("in",self._inIn)

		# Set OutPort buffers
		self.registerOutPort("out",self._outOut)

		# initialize of configuration-data.
		# <rtc-template block="init_conf_param">
		self._gain = [1.0]
		self._count = [3]
		self._name = ['abc']
		self._list = [[0]]
		# </rtc-template>

	def onInitialize(self):
		# Bind variables and configuration variable
		# <rtc-template block="bind_config">
		self.bindParameter("gain", self._gain, "1.0")
		self.bindParameter("count", self._count, "3")
		self.bindParameter("name", self._name, "abc")
		self.bindParameter("list", self._list, "1,2,3")
		# </rtc-template>
		return RTC.RTC_OK

	#def onFinalize(self, ec_id):
	#	return RTC.RTC_OK

	def onActivated(self, ec_id):
		self.n = 0
		return RTC.RTC_OK

	def onExecute(self, ec_id):
		if self._inIn.isNew():
			data = self._inIn.read()
			self._d_in = data
		self._d_out.data = self.n
		self._outOut.write()
		self.n += 1
		if self.n == 5: print("OK Template10", self._gain, self._count, self._name, self._list)
		time.sleep(0.01)
		return RTC.RTC_OK


def Template10Init(manager):
    profile = OpenRTM_aist.Properties(defaults_str=template10_spec)
    manager.registerFactory(profile,
                            Template10,
                            OpenRTM_aist.Delete)

def MyModuleInit(manager):
    Template10Init(manager)

    # Create a component
    comp = manager.createComponent("Template10")
    print("Component created", comp)



def main():
	mgr = OpenRTM_aist.Manager.init(len(sys.argv), sys.argv)
	mgr.setModuleInitProc(MyModuleInit)
	mgr.activateManager()
	mgr.runManager()

if __name__ == "__main__":
	main()
