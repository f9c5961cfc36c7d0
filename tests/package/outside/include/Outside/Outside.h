#ifndef OUTSIDE_H
#define OUTSIDE_H

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include "OutsideServiceSkel.h"

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

class ServiceSVC_impl : public virtual POA_OutsideDemo::Service, public virtual PortableServer::RefCountServantBase
{
public:
  void take(const OutsideDemo::Note& what)
    throw (CORBA::SystemException);
  OutsideDemo::Note* last() throw (CORBA::SystemException, PortableServer::POA::WrongPolicy);

private:
  OutsideDemo::Note m_last;
};

class Outside : public RTC::DataFlowComponentBase
{
public:
  Outside(RTC::Manager* manager);
  ~Outside();
  virtual RTC::ReturnCode_t onInitialize();
  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id);

protected:
  int m_gain;
  RTC::TimedLong m_in;
  RTC::InPort<RTC::TimedLong> m_inIn;
  OutsideDemo::Note m_note;
  RTC::OutPort<OutsideDemo::Note> m_noteOut;
  RTC::CorbaPort m_servicePort;
  ServiceSVC_impl m_service;
};

extern "C"
{
  DLL_EXPORT void OutsideInit(RTC::Manager* manager);
};

#endif
