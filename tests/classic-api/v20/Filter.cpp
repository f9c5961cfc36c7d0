// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Filter.cpp
 */
// </rtc-template>

#include "Filter.h"

// Module specification
// <rtc-template block="module_spec">
#if RTM_MAJOR_VERSION >= 2
static const char* const filter_spec[] =
#else
static const char* filter_spec[] =
#endif
  {
    "implementation_id", "Filter",
    "type_name",         "Filter",
    "description",       "ModuleDescription",
    "version",           "1.0.0",
    "vendor",            "VenderName",
    "category",          "Category",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    // Configuration variables
    "conf.default.gain", "1.0",
    "conf.default.coefficients", "1,2,3",

    // Widget
    "conf.__widget__.gain", "slider.0.1",
    // Constraints
    "conf.__constraints__.gain", "0.0<=x<=10.0",

    "conf.__type__.gain", "double",

    ""
  };
// </rtc-template>

namespace
{
  class Counting : public RTC::ConnectorDataListenerT<RTC::TimedVelocity2D>
  {
    USE_CONNLISTENER_STATUS;
  public:
    ReturnCode operator()(RTC::ConnectorInfo& info, RTC::TimedVelocity2D& data) override
    {
      data.data.vx += 1.0;
      info.properties["seen"] = "yes";
      return BOTH_CHANGED;
    }
  };

  class Watching : public RTC::ConnectorDataListenerT<RTC::RangeData>
  {
    USE_CONNLISTENER_STATUS;
  public:
    Watching() : m_count(0) {}
    ~Watching() override = default;
    ReturnCode operator()(RTC::ConnectorInfo& /*info*/, RTC::RangeData& data) override
    {
      m_count += data.ranges.length();
      return ConnectorListenerStatus::NO_CHANGE;
    }
  private:
    size_t m_count;
  };

  class RawBytes : public RTC::ConnectorDataListener
  {
    USE_CONNLISTENER_STATUS;
  public:
    ReturnCode operator()(RTC::ConnectorInfo& info, RTC::ByteData& data, const std::string& marshalingtype) override
    {
      std::cout << info.name << " " << data.getDataLength() << " " << marshalingtype << std::endl;
      return NO_CHANGE;
    }
  };

  class Connecting : public RTC::ConnectorListener
  {
    USE_CONNLISTENER_STATUS;
  public:
    ReturnCode operator()(RTC::ConnectorInfo& info) override
    {
      for (auto const& port : info.ports) std::cout << port << std::endl;
      return ConnectorListenerStatus::NO_CHANGE;
    }
  };

  class Before : public RTC::PreComponentActionListener
  {
  public:
    void operator()(RTC::UniqueId ec_id) override { std::cout << "before " << ec_id << std::endl; }
  };

  class After : public RTC::PostComponentActionListener
  {
  public:
    void operator()(RTC::UniqueId ec_id, RTC::ReturnCode_t ret) override { std::cout << ec_id << ret << std::endl; }
  };

  class Halve : public RTC::OnWriteConvert<RTC::TimedVelocity2D>
  {
  public:
    RTC::TimedVelocity2D operator()(const RTC::TimedVelocity2D& value) override
    {
      RTC::TimedVelocity2D half(value);
      half.data.vx /= 2;
      return half;
    }
  };

  class Noted : public RTC::OnRead<RTC::TimedVelocity2D>
  {
  public:
    void operator()() override { ++m_reads; }
    int m_reads{0};
  };

  Halve halve;
  Noted noted;
}

/*!
 * @brief constructor
 * @param manager Maneger Object
 */
Filter::Filter(RTC::Manager* manager)
    // <rtc-template block="initializer">
  : RTC::DataFlowComponentBase(manager),
    m_inIn("in", m_in),
    m_rangeIn("range", m_range),
    m_outOut("out", m_out)
    // </rtc-template>
{
}

/*!
 * @brief destructor
 */
Filter::~Filter()
{
}


RTC::ReturnCode_t Filter::onInitialize()
{
  // Registration: InPort/OutPort/Service
  // <rtc-template block="registration">
  // Set InPort buffers
  addInPort("in", m_inIn);
  addInPort("range", m_rangeIn);

  // Set OutPort buffer
  addOutPort("out", m_outOut);

  // </rtc-template>

  // <rtc-template block="bind_config">
  // Bind variables and configuration variable
  bindParameter("gain", m_gain, "1.0");
  bindParameter("coefficients", m_coefficients, "1,2,3");
  // </rtc-template>

  using RTC::ConnectorDataListenerType;
  m_inIn.addConnectorDataListener(ConnectorDataListenerType::ON_BUFFER_WRITE, new Counting());
  m_rangeIn.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, new Watching());
  m_outOut.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_SEND, new RawBytes(), true);
  m_outOut.addConnectorListener(RTC::ConnectorListenerType::ON_CONNECT, new Connecting());
  m_outOut.setOnWriteConvert(&halve);
  m_inIn.setOnRead(&noted);
  addPreComponentActionListener(RTC::PreComponentActionListenerType::PRE_ON_ACTIVATED, new Before());
  addPostComponentActionListener(RTC::PostComponentActionListenerType::POST_ON_ACTIVATED, new After());
  m_outOut.properties()["description"] = "filtered velocity";
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onFinalize()
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onStartup(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onShutdown(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onActivated(RTC::UniqueId ec_id)
{
  RTC_INFO(("activated, rate %f", getExecutionRate(ec_id)));
  if (isOwnExecutionContext(ec_id)) setExecutionRate(ec_id, 50.0);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onDeactivated(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onExecute(RTC::UniqueId /*ec_id*/)
{
  if (m_inIn.isNew())
    {
      m_inIn.read();
      m_out.data = m_in.data;
      m_out.data.vx *= m_gain;
    }
  coil::vstring names;
  if (m_rangeIn.isNew(names))
    {
      for (auto& name : names)
        {
          m_rangeIn.read(name);
          if (m_rangeIn.getStatus(0) != RTC::DataPortStatus::PORT_OK) continue;
        }
      for (CORBA::ULong i = 0; i < m_range.ranges.length(); ++i)
        {
          double angle = m_range.config.minAngle + i * m_range.config.angularRes;
          if (std::abs(angle) < 0.5 && m_range.ranges[i] < 0.3) m_out.data.vx = 0;
        }
    }
  setTimestamp(m_out);
  if (!m_outOut.write())
    {
      RTC::DataPortStatusList status = m_outOut.getStatusList();
      for (size_t i = 0; i < status.size(); ++i)
        {
          if (status[i] == RTC::DataPortStatus::CONNECTION_LOST) RTC_WARN(("lost: %s", toString(status[i])));
        }
    }
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onAborting(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onError(RTC::UniqueId ec_id)
{
  return reset(ec_id);
}

RTC::ReturnCode_t Filter::onReset(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onStateUpdate(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Filter::onRateChanged(RTC::UniqueId /*ec_id*/)
{
  return RTC::RTC_OK;
}



extern "C"
{

  void FilterInit(RTC::Manager* manager)
  {
    coil::Properties profile(filter_spec);
    manager->registerFactory(profile,
                             RTC::Create<Filter>,
                             RTC::Delete<Filter>);
  }

}
