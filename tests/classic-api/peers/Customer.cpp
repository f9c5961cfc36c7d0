// -*- C++ -*-
/*!
 * @file  Customer.cpp
 * @brief Uses an account, in the manner of the 1.2 generator
 */
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include "LedgerStub.h"

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/CorbaConsumer.h>

class Customer
  : public RTC::DataFlowComponentBase
{
 public:
  Customer(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_AccountPort("Account"),
      m_done(false)
  {
  }
  ~Customer() {}

  RTC::ReturnCode_t onInitialize()
  {
    m_AccountPort.registerConsumer("account", "Ledger::Account", m_account);
    addPort(m_AccountPort);
    bindParameter("amount", m_amount, "10.5");
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id)
  {
    if (m_done || CORBA::is_nil(m_account._ptr())) { return RTC::RTC_OK; }
    try
      {
        m_account->owner("me");
        m_account->deposit(Ledger::CASH, m_amount, "first");
        double now = m_account->deposit(Ledger::CARD, m_amount, "second");
        CORBA::String_var owner(m_account->owner());
        Ledger::Entries_var list;
        m_account->history(list.out());
        RTC::TimedDouble balance = m_account->balance();
        std::cout << owner << " has " << now << " after " << list->length() << " entries, last " << list[1].note
                  << ", balance " << balance.data << std::endl;
        m_done = true;
        m_account->deposit(Ledger::CASH, -1000.0, "too much");
      }
    catch (Ledger::Overdrawn& ex)
      {
        std::cout << "missing " << ex.missing << std::endl;
        m_account->forget();
      }
    catch (CORBA::OBJECT_NOT_EXIST&)
      {
        RTC_DEBUG(("the bank is closed"));
      }
    catch (const CORBA::SystemException& ex)
      {
        RTC_ERROR(("CORBA error %s", ex._name()));
        return RTC::RTC_ERROR;
      }
    return RTC::RTC_OK;
  }

 protected:
  double m_amount;
  RTC::CorbaPort m_AccountPort;
  RTC::CorbaConsumer<Ledger::Account> m_account;
  bool m_done;
};

static const char* customer_spec[] =
  {
    "implementation_id", "Customer",
    "type_name",         "Customer",
    "description",       "Uses an account",
    "version",           "1.2.0",
    "vendor",            "peer",
    "category",          "service",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "20",
    "conf.default.amount", "10.5",
    ""
  };

extern "C"
{
  DLL_EXPORT void CustomerInit(RTC::Manager* manager)
  {
    coil::Properties profile(customer_spec);
    manager->registerFactory(profile, RTC::Create<Customer>, RTC::Delete<Customer>);
  }
};
