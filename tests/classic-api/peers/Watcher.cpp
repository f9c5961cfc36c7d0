// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Watcher.cpp
 * @brief Listens to everything
 */
// </rtc-template>

#include "Watcher.h"

// Module specification
// <rtc-template block="module_spec">
static const char* const watcher_spec[] =
  {
    "implementation_id", "Watcher",
    "type_name",         "Watcher",
    "description",       "Listens to everything",
    "version",           "2.0.0",
    "vendor",            "peer",
    "category",          "demo",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "100",
    // Configuration variables
    "conf.default.folder", "/",
    "conf.default.limit", "100",
    // Widget
    "conf.__widget__.folder", "text",
    "conf.__type__.folder", "string",
    "conf.__type__.limit", "int",
    ""
  };
// </rtc-template>

Watcher::Watcher(RTC::Manager* manager)
    // <rtc-template block="initializer">
  : RTC::DataFlowComponentBase(manager),
    m_inIn("in", m_in),
    m_outOut("out", m_out)
    // </rtc-template>
{
}

Watcher::~Watcher()
{
}

RTC::ReturnCode_t Watcher::onInitialize()
{
  addPortActionListener(RTC::PortActionListenerType::ADD_PORT, *this, &Watcher::portAdded);
  addPortConnectRetListener(RTC::PortConnectRetListenerType::ON_CONNECTED, *this, &Watcher::connected);

  // <rtc-template block="registration">
  // Set InPort buffers
  addInPort("in", m_inIn);
  // Set OutPort buffer
  addOutPort("out", m_outOut);
  // </rtc-template>

  m_outOut.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_BUFFER_WRITE, new Doubler());
  m_inIn.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, new RawCounter(m_octets));
  m_inIn.addConnectorListener(RTC::ConnectorListenerType::ON_CONNECT, new Links("linked"));
  m_inIn.addConnectorListener(RTC::ConnectorListenerType::ON_DISCONNECT, new Links("unlinked"));
  m_inIn.setOnReadConvert(&m_convert);
  m_outOut.setOnWrite(&m_before);

  m_pre = addPreComponentActionListener(RTC::PreComponentActionListenerType::PRE_ON_EXECUTE, *this, &Watcher::beforeExecute);
  addPostComponentActionListener(RTC::PostComponentActionListenerType::POST_ON_EXECUTE, *this, &Watcher::afterExecute);

  // <rtc-template block="bind_config">
  // Bind variables and configuration variable
  bindParameter("folder", m_folder, "/");
  bindParameter("limit", m_limit, "100");
  // </rtc-template>

  coil::UUID_Generator generator;
  generator.init();
  std::unique_ptr<coil::UUID> uuid(generator.generateUUID(2, 0x01));
  m_id = uuid->to_string();

  m_task.reset(new coil::PeriodicTask());
  m_task->setTask(this, &Watcher::beat);
  m_task->setPeriod(std::chrono::milliseconds(5));
  m_task->activate();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Watcher::onFinalize()
{
  m_task->finalize();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Watcher::onActivated(RTC::UniqueId /*ec_id*/)
{
  m_convert.m_max = m_limit;
  coil::vstring parts = coil::split(std::string("x = 1 , y=2"), ",");
  coil::mapstring url = coil::urlparam2map("some?a=1&b=2");
  std::string shout = coil::toUpper(std::string("done"));
  std::string same("  As It Is ");
  std::string trimmed = coil::eraseBothEndsBlank(same);
  RTC_INFO(("%s: %d parts, b is %s, %s", m_id.c_str(), static_cast<int>(parts.size()), url["b"].c_str(), shout.c_str()));
  std::cout << m_id.size() << " " << parts.size() << " " << url["b"] << " " << shout << " [" << trimmed << "] [" << same << "] "
            << coil::basename("/a/b.c") << " " << coil::toBool("yes please", "YES", "NO", false) << std::endl;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Watcher::onDeactivated(RTC::UniqueId /*ec_id*/)
{
  removePreComponentActionListener(RTC::PreComponentActionListenerType::PRE_ON_EXECUTE, m_pre);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Watcher::onExecute(RTC::UniqueId /*ec_id*/)
{
  m_out.data = 21;
  setTimestamp(m_out);
  m_outOut.write();
  if (m_inIn.isNew() && m_beats > 0)
    {
      m_inIn.read();
      if (++m_executions == 3)
        {
          std::cout << "read " << m_in.data << ", written " << (m_before.m_count > 0) << ", octets " << (m_octets > 0) << std::endl;
        }
    }
  return RTC::RTC_OK;
}

void Watcher::beforeExecute(RTC::UniqueId /*ec_id*/) { m_measure.tick(); }
void Watcher::afterExecute(RTC::UniqueId /*ec_id*/, RTC::ReturnCode_t /*ret*/) { m_measure.tack(); }
void Watcher::portAdded(const RTC::PortProfile& profile) { std::cout << "port " << profile.name << std::endl; }
void Watcher::connected(const char* portname, RTC::ConnectorProfile& profile, RTC::ReturnCode_t ret)
{
  std::cout << portname << " connected " << (ret == RTC::RTC_OK) << std::endl;
}
int Watcher::beat() { return ++m_beats; }

extern "C"
{

  void WatcherInit(RTC::Manager* manager)
  {
    coil::Properties profile(watcher_spec);
    manager->registerFactory(profile, RTC::Create<Watcher>, RTC::Delete<Watcher>);
  }

}
