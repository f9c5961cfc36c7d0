// -*-C++-*-
/*!
 * @file  AccountSVC_impl.cpp
 * @brief Service implementation code of Ledger.idl
 *
 */

#include "AccountSVC_impl.h"

AccountSVC_impl::AccountSVC_impl() : m_owner("nobody"), m_balance(0)
{
  // Please add extra constructor code here.
}

AccountSVC_impl::~AccountSVC_impl()
{
  // Please add extra destructor code here.
}

char* AccountSVC_impl::owner()
{
  std::lock_guard<std::mutex> guard(m_mutex);
  return CORBA::string_dup(m_owner.c_str());
}

void AccountSVC_impl::owner(const char* name)
{
  std::lock_guard<std::mutex> guard(m_mutex);
  m_owner = name;
}

CORBA::Double AccountSVC_impl::deposit(Ledger::Kind how, CORBA::Double amount, const char* note)
{
  std::lock_guard<std::mutex> guard(m_mutex);
  if (m_balance + amount < 0)
    {
      throw Ledger::Overdrawn(-(m_balance + amount));
    }
  m_balance += amount;
  CORBA::ULong len(m_entries.length());
  m_entries.length(len + 1);
  m_entries[len].how = how;
  m_entries[len].amount = amount;
  m_entries[len].note = CORBA::string_dup(note);
  return m_balance;
}

void AccountSVC_impl::history(Ledger::Entries_out list)
{
  std::lock_guard<std::mutex> guard(m_mutex);
  list = new Ledger::Entries(m_entries);
}

RTC::TimedDouble AccountSVC_impl::balance()
{
  std::lock_guard<std::mutex> guard(m_mutex);
  RTC::TimedDouble result;
  result.tm.sec = 0;
  result.tm.nsec = 0;
  result.data = m_balance;
  return result;
}

void AccountSVC_impl::forget()
{
  std::lock_guard<std::mutex> guard(m_mutex);
  m_entries.length(0);
}
