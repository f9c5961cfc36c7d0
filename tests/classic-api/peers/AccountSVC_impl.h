// -*-C++-*-
/*!
 * @file  AccountSVC_impl.h
 * @brief Service implementation header of Ledger.idl
 *
 */

#include "BasicDataTypeSkel.h"

#include "LedgerSkel.h"

#ifndef ACCOUNTSVC_IMPL_H
#define ACCOUNTSVC_IMPL_H

#include <mutex>
#include <string>

/*!
 * @class AccountSVC_impl
 * Example class implementing IDL interface Ledger::Account
 */
class AccountSVC_impl
 : public virtual POA_Ledger::Account,
   public virtual PortableServer::RefCountServantBase
{
 private:
   // Make sure all instances are built on the heap by making the
   // destructor non-public
   //virtual ~AccountSVC_impl();

 public:
  AccountSVC_impl();
  virtual ~AccountSVC_impl();

  // attributes and operations
  char* owner();
  void owner(const char* name);
  CORBA::Double deposit(Ledger::Kind how, CORBA::Double amount, const char* note);
  void history(Ledger::Entries_out list);
  RTC::TimedDouble balance();
  void forget();

 private:
  std::mutex m_mutex;
  std::string m_owner;
  Ledger::Entries m_entries;
  double m_balance;
};

#endif // ACCOUNTSVC_IMPL_H
