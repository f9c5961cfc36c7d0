// -*- C++ -*-
/*!
 * @file  Bank.cpp
 * @brief Keeps an account, in the manner of the 1.2 generator
 */
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include "AccountSVC_impl.h"

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

class Bank
  : public RTC::DataFlowComponentBase
{
 public:
  Bank(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_AccountPort("Account")
  {
  }
  ~Bank() {}

  virtual RTC::ReturnCode_t onInitialize()
  {
    // Set service provider to Ports
    m_AccountPort.registerProvider("account", "Ledger::Account", m_account);
    // Set CORBA Service Ports
    addPort(m_AccountPort);
    return RTC::RTC_OK;
  }

  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id)
  {
    std::cout << "the bank is open" << std::endl;
    return RTC::RTC_OK;
  }

 protected:
  RTC::CorbaPort m_AccountPort;
  AccountSVC_impl m_account;
};

static const char* bank_spec[] =
  {
    "implementation_id", "Bank",
    "type_name",         "Bank",
    "description",       "Keeps an account",
    "version",           "1.2.0",
    "vendor",            "peer",
    "category",          "service",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };

extern "C"
{
  DLL_EXPORT void BankInit(RTC::Manager* manager)
  {
    coil::Properties profile(bank_spec);
    manager->registerFactory(profile, RTC::Create<Bank>, RTC::Delete<Bank>);
  }
};
