#include "ParameterDemo.h"

// Module specification
// <rtc-template block="module_spec">
static const char* parameterdemo_spec[] =
  {
    "implementation_id", "ParameterDemo",
    "type_name",         "ParameterDemo",
    "description",       "Configuration example component",
    "version",           "1.2.0",
    "vendor",            "Somebody",
    "category",          "example.config",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "0",
    "language",          "C++",
    "lang_type",         "compile",
    // Configuration variables
    "conf.default.int_param0", "0",
    "conf.default.ushort_param", "17",
    "conf.default.double_param0", "0.11",
    "conf.default.float_param", "1.5",
    "conf.default.bool_param", "1",
    "conf.default.str_param0", "hoge",
    "conf.default.vector_param0", "0.0,1.0,2.0,3.0,4.0",
    "conf.default.names", "a,b",
    "conf.default.char_param", "c",
    "conf.default.position", "1.0 2.0",
    "conf.mode1.int_param0", "1",
    // Widget
    "conf.__widget__.int_param0", "spin",
    "conf.__widget__.double_param0", "slider.10",
    "conf.__widget__.str_param0", "radio",
    // Constraints
    "conf.__constraints__.int_param0", "0<=x<=150",
    "conf.__constraints__.str_param0", "(hoge,foo,bar)",
    "conf.__type__.int_param0", "int",
    ""
  };
// </rtc-template>

static bool toPosition(ParameterDemo_Position& position, const char* text);

ParameterDemo::ParameterDemo(RTC::Manager* manager)
  : RTC::DataFlowComponentBase(manager)
{
}

ParameterDemo::~ParameterDemo()
{
}

RTC::ReturnCode_t ParameterDemo::onInitialize()
{
  // <rtc-template block="bind_config">
  // Bind variables and configuration variable
  bindParameter("int_param0", m_int_param0, "0");
  bindParameter("ushort_param", m_ushort_param, "17");
  bindParameter("double_param0", m_double_param0, "0.11");
  bindParameter("float_param", m_float_param, "1.5");
  bindParameter("bool_param", m_bool_param, "1");
  bindParameter("str_param0", m_str_param0, "hoge");
  bindParameter("vector_param0", m_vector_param0, "0.0,1.0,2.0,3.0,4.0");
  bindParameter("names", m_names, "a,b");
  bindParameter("char_param", m_char_param, "c");
  bindParameter("position", m_position, "0 0", toPosition);
  // </rtc-template>

  this->addConfigurationParamListener(RTC::ON_UPDATE_CONFIG_PARAM, *this, &ParameterDemo::configUpdated);
  this->addConfigurationSetListener(RTC::ON_ADD_CONFIG_SET, *this, &ParameterDemo::setAdded);
  this->addConfigurationSetNameListener(RTC::ON_ACTIVATE_CONFIG_SET, *this, &ParameterDemo::setActivated);
  this->addPreComponentActionListener(RTC::PRE_ON_EXECUTE, *this, &ParameterDemo::preExecute);
  this->addPostComponentActionListener(RTC::POST_ON_EXECUTE, *this, &ParameterDemo::postExecute);
  this->addPortActionListener(RTC::ADD_PORT, *this, &ParameterDemo::portAdded);
  this->addExecutionContextActionListener(RTC::EC_ATTACHED, *this, &ParameterDemo::ecAttached);
  this->addPortConnectListener(RTC::ON_NOTIFY_CONNECT, *this, &ParameterDemo::portConnected);
  RTC::PortConnectRetListener* listener =
    this->addPortConnectRetListener(RTC::ON_CONNECTED, *this, &ParameterDemo::portConnectedRet);
  this->removePortConnectRetListener(RTC::ON_CONNECTED, listener);

  std::cout << "active set: " << m_configsets.getActiveId() << std::endl;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ParameterDemo::onExecute(RTC::UniqueId)
{
  static int c(0);
  const char* active = getConfigService().getActiveId();
  std::string id(active);
  coil::normalize(id);
  if (id == "default" && m_configsets.haveConfig("mode1") && c++ == 100)
    {
      m_configsets.activateConfigurationSet("mode1");
      m_configsets.update();
    }
  RTC_DEBUG(("int_param0: %d, str_param0: %s", m_int_param0, m_str_param0.c_str()));
  RTC_INFO_STR("vector: " << m_vector_param0.size());
  RTC_DEBUG_STR((m_properties));
  return RTC::RTC_OK;
}

void ParameterDemo::configUpdated(const char* config_set, const char* config_param)
{
  RTC_INFO(("updated %s.%s", config_set, config_param));
}
void ParameterDemo::setAdded(const coil::Properties& config_set)
{
  RTC_INFO(("added %s", config_set.getName()));
}
void ParameterDemo::setActivated(const char* config_set) { RTC_INFO(("activated %s", config_set)); }
void ParameterDemo::preExecute(RTC::UniqueId ec_id) { RTC_PARANOID(("before %d", ec_id)); }
void ParameterDemo::postExecute(RTC::UniqueId ec_id, RTC::ReturnCode_t ret) { RTC_PARANOID(("after %d: %d", ec_id, ret)); }
void ParameterDemo::portAdded(const RTC::PortProfile& profile) { RTC_TRACE(("port %s", static_cast<const char*>(profile.name))); }
void ParameterDemo::ecAttached(RTC::UniqueId ec_id) { RTC_TRACE(("ec %d", ec_id)); }
void ParameterDemo::portConnected(const char* portname, RTC::ConnectorProfile& profile)
{
  RTC_TRACE(("%s connects %s", portname, (const char*)profile.connector_id));
}
void ParameterDemo::portConnectedRet(const char* portname, RTC::ConnectorProfile&, RTC::ReturnCode_t ret)
{
  RTC_TRACE(("%s: %d", portname, ret));
}

static bool toPosition(ParameterDemo_Position& position, const char* text)
{
  return sscanf(text, "%lf %lf", &position.x, &position.y) == 2;
}

extern "C"
{
  DLL_EXPORT void ParameterDemoInit(RTC::Manager* manager)
  {
    coil::Properties profile(parameterdemo_spec);
    manager->registerFactory(profile,
                             RTC::Create<ParameterDemo>,
                             RTC::Delete<ParameterDemo>);
  }
};
