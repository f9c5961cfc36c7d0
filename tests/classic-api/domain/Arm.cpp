// A manipulator with the common interface, and a joint controller in the manner of humanoid controllers: vectors of ports, nodes of the
// component's own properties, the naming service by hand, m_profile in every message.
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/CorbaNaming.h>
#include <rtm/CorbaConsumer.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/ext/ManipulatorCommonInterface_CommonSkel.h>
#include <coil/stringutil.h>

#include <cmath>
#include <map>
#include <vector>

class CommonSVC_impl : public virtual POA_JARA_ARM::ManipulatorCommonInterface_Common, public virtual PortableServer::RefCountServantBase
{
public:
  JARA_ARM::RETURN_ID* clearAlarms() { return answer(JARA_ARM::OK, ""); }
  JARA_ARM::RETURN_ID* getActiveAlarm(JARA_ARM::AlarmSeq_out alarms)
  {
    JARA_ARM::AlarmSeq_var list = new JARA_ARM::AlarmSeq();
    list->length(1);
    list[CORBA::ULong(0)].type = JARA_ARM::WARNING;
    list[CORBA::ULong(0)].description = CORBA::string_dup("none");
    alarms = list._retn();
    return answer(JARA_ARM::OK, "");
  }
  JARA_ARM::RETURN_ID* getFeedbackPosJoint(JARA_ARM::JointPos_out pos)
  {
    pos = new JARA_ARM::JointPos;
    pos->length(6);
    for (CORBA::ULong i = 0; i < 6; ++i) (*pos)[i] = 0.1 * i;
    return answer(JARA_ARM::OK, "");
  }
  JARA_ARM::RETURN_ID* getManipInfo(JARA_ARM::ManipInfo_out mInfo)
  {
    mInfo = new JARA_ARM::ManipInfo;
    mInfo->axisNum = 6;
    return answer(JARA_ARM::OK, "");
  }
  JARA_ARM::RETURN_ID* getSoftLimitJoint(JARA_ARM::LimitSeq_out softLimit)
  {
    softLimit = new JARA_ARM::LimitSeq;
    return answer(JARA_ARM::NOT_IMPLEMENTED, "later");
  }
  JARA_ARM::RETURN_ID* getState(JARA_ARM::ULONG& state)
  {
    state = JARA_ARM::CONST_BINARY_00000001;
    return answer(JARA_ARM::OK, "");
  }
  JARA_ARM::RETURN_ID* servoOFF() { return answer(JARA_ARM::OK, ""); }
  JARA_ARM::RETURN_ID* servoON() { return answer(JARA_ARM::OK, ""); }
  JARA_ARM::RETURN_ID* setSoftLimitJoint(const JARA_ARM::LimitSeq&) { return answer(JARA_ARM::OK, ""); }

private:
  JARA_ARM::RETURN_ID* answer(CORBA::Long id, const char* comment)
  {
    JARA_ARM::RETURN_ID_var result(new JARA_ARM::RETURN_ID);
    result->id = id;
    result->comment = CORBA::string_dup(comment);
    return result._retn();
  }
};

class Arm : public RTC::DataFlowComponentBase
{
public:
  Arm(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      // <rtc-template block="initializer">
      m_qRefIn("qRef", m_qRef),
      m_rpyIn("rpy", m_rpy),
      m_qOut("q", m_q),
      m_CommonPort("ManipulatorCommonInterface_Common"),
      // </rtc-template>
      m_debugLevel(0),
      dummy(0)
  {
  }
  virtual ~Arm()
  {
    for (size_t i = 0; i < m_force.size(); ++i) delete m_forceIn[i];
  }

  virtual RTC::ReturnCode_t onInitialize()
  {
    std::cerr << "[" << m_profile.instance_name << "] onInitialize()" << std::endl;
    bindParameter("debugLevel", m_debugLevel, "0");
    addInPort("qRef", m_qRefIn);
    addInPort("rpy", m_rpyIn);
    addOutPort("q", m_qOut);
    m_CommonPort.registerProvider("common", "JARA_ARM::ManipulatorCommonInterface_Common", m_common);
    addPort(m_CommonPort);

    RTC::Properties& prop = getProperties();
    coil::stringTo(m_dt, prop["dt"].c_str());

    RTC::Manager& rtcManager = RTC::Manager::instance();
    std::string nameServer = rtcManager.getConfig()["corba.nameservers"];
    int comPos = nameServer.find(",");
    if (comPos < 0)
      {
        comPos = nameServer.length();
      }
    nameServer = nameServer.substr(0, comPos);
    try
      {
        RTC::CorbaNaming naming(rtcManager.getORB(), nameServer.c_str());
        CORBA::Object_var object = naming.resolve("ModelLoader");
      }
    catch (...)
      {
        std::cerr << "no naming service" << std::endl;
      }

    coil::vstring sensors = coil::split(prop["sensors"], ",");
    m_force.resize(sensors.size());
    m_forceIn.resize(sensors.size());
    for (unsigned int i = 0; i < sensors.size(); i++)
      {
        m_forceIn[i] = new RTC::InPort<RTC::TimedDoubleSeq>(sensors[i].c_str(), m_force[i]);
        m_force[i].data.length(6);
        registerInPort(sensors[i].c_str(), *m_forceIn[i]);
      }
    m_q.data.length(6);
    for (unsigned int i = 0; i < m_q.data.length(); i++) m_q.data[i] = 0.0;
    return RTC::RTC_OK;
  }

  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id)
  {
    coil::TimeValue coiltm(coil::gettimeofday());
    RTC::Time tm;
    tm.sec = coiltm.sec();
    tm.nsec = coiltm.usec() * 1000;
    if (ec_id == 0 && m_debugLevel > 0) std::cerr << m_profile.instance_name << ": " << m_debugLevel << std::endl;
    for (unsigned int i = 0; i < m_forceIn.size(); i++)
      {
        if (m_forceIn[i]->isNew())
          {
            m_forceIn[i]->read();
          }
      }
    if (m_qRefIn.isNew())
      {
        m_qRefIn.read();
        for (unsigned int i = 0; i < m_qRef.data.length(); i++) m_q.data[i] = m_qRef.data[i];
      }
    if (m_rpyIn.isNew()) m_rpyIn.read();
    m_q.tm = tm;
    m_q.data[0] += m_rpy.data.y;
    m_qOut.write();
    return RTC::RTC_OK;
  }

protected:
  RTC::TimedDoubleSeq m_qRef;
  RTC::InPort<RTC::TimedDoubleSeq> m_qRefIn;
  RTC::TimedOrientation3D m_rpy;
  RTC::InPort<RTC::TimedOrientation3D> m_rpyIn;
  RTC::TimedDoubleSeq m_q;
  RTC::OutPort<RTC::TimedDoubleSeq> m_qOut;
  RTC::CorbaPort m_CommonPort;
  CommonSVC_impl m_common;
  std::vector<RTC::TimedDoubleSeq> m_force;
  std::vector<RTC::InPort<RTC::TimedDoubleSeq>*> m_forceIn;

private:
  double m_dt;
  unsigned int m_debugLevel;
  int dummy;
};

static const char* arm_spec[] =
  {
    "implementation_id", "Arm",
    "type_name",         "Arm",
    "description",       "joint controller",
    "version",           "1.0",
    "vendor",            "Somebody",
    "category",          "example",
    "activity_type",     "DataFlowComponent",
    "max_instance",      "10",
    "language",          "C++",
    "lang_type",         "compile",
    "conf.default.debugLevel", "0",
    "sensors", "lfsensor,rfsensor",
    "dt", "0.005",
    ""
  };

extern "C"
{
  void ArmInit(RTC::Manager* manager)
  {
    RTC::Properties profile(arm_spec);
    manager->registerFactory(profile, RTC::Create<Arm>, RTC::Delete<Arm>);
  }
};
