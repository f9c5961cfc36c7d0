// The masters and slaves of a manager. Slaves in a circle, which would ask each other without end, are rejected, as is what does not answer
// as a manager. One that hangs is dropped, and may come back after a while.
#include <algorithm>

#include "base/log.h"
#include "base/own_account.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "core/remote_rights.h"
#include "manager/at_once.h"
#include "manager/manager_impl.h"
#include "rtm/Manager.h"
#include "rtm/ManagerServant.h"

namespace RTM {
namespace {

constexpr std::chrono::seconds peer_timeout{2};
constexpr std::chrono::milliseconds ping_timeout{300};  // of a slave that has hung
constexpr std::chrono::seconds shortest_absence{10};    // of a slave that has hung; twice as long each time
constexpr int max_doublings = 6;
constexpr std::size_t max_managers = 256;  // of each list

// A manager answers there. Also: a reference by object key (corbaloc) is equivalent to one by IOR only after its first call has been sent
// on.
bool answers(RTM::Manager_ptr manager) {
  try {
    RTM::Manager_var brief = RTM::Manager::_duplicate(manager);
    corba::set_call_timeout(brief, peer_timeout);
    brief->is_master();
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

// Adds the reference unless an equivalent one is there or there are too many.
bool add_unique(std::vector<RTM::Manager_var>& list, RTM::Manager_ptr manager) {
  if (list.size() >= max_managers) return false;
  for (const auto& known : list) {
    if (known->_is_equivalent(manager)) return false;
  }
  list.emplace_back(RTM::Manager::_duplicate(manager));
  return true;
}

// `wanted` is the manager, or one of its slaves, or of theirs.
bool is_below(RTM::Manager_ptr manager, RTM::Manager_ptr wanted) {
  constexpr std::size_t most = 100;
  std::vector<RTM::Manager_var> family{RTM::Manager_var(RTM::Manager::_duplicate(manager))};
  const corba::ChainDeadline deadline(peer_timeout);
  for (std::size_t i = 0; i < family.size() && family.size() < most; ++i) {
    if (deadline.is_over()) return true;  // nobody waits for a family that hangs
    try {
      deadline.limit(family[i]);
      RTM::ManagerList_var slaves = family[i]->get_slave_managers();
      for (CORBA::ULong k = 0; k < slaves->length(); ++k) {
        if (!CORBA::is_nil(slaves[k])) add_unique(family, slaves[k]);
      }
    } catch (const CORBA::Exception&) {  // gone, with its slaves
    }
    if (family[i]->_is_equivalent(wanted)) return true;  // once it has been called: see answers()
  }
  return family.size() >= most;
}

RTM::ManagerList* to_list(const std::vector<RTM::Manager_var>& managers) {
  auto list = std::make_unique<RTM::ManagerList>();
  list->length(static_cast<CORBA::ULong>(managers.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) (*list)[i] = RTM::Manager::_duplicate(managers[i].in());
  return list.release();
}

}  // namespace

CORBA::Boolean ManagerServant::is_master() { return manager_.impl_->is_master(); }

RTM::ManagerList* ManagerServant::get_master_managers() {
  const std::scoped_lock lock(mutex_);
  return to_list(masters_);
}

RTC::ReturnCode_t ManagerServant::add_master_manager(RTM::Manager_ptr mgr) {
  return may_change("another master") ? add_master(mgr) : RTC::RTC_ERROR;
}

RTC::ReturnCode_t ManagerServant::add_master(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr) || !corba::may_keep(mgr) || !answers(mgr) || mgr->_is_equivalent(reference_)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return add_unique(masters_, mgr) ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTC::ReturnCode_t ManagerServant::remove_master_manager(RTM::Manager_ptr mgr) {
  return may_change("a master to be forgotten") ? remove_master(mgr) : RTC::RTC_ERROR;
}

RTC::ReturnCode_t ManagerServant::remove_master(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr)) return RTC::BAD_PARAMETER;
  answers(mgr);  // one that has died may go as well
  const std::scoped_lock lock(mutex_);
  return std::erase_if(masters_, [&](const auto& known) { return known->_is_equivalent(mgr); }) > 0 ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTM::ManagerList* ManagerServant::get_slave_managers() { return to_list(living_slaves()); }

// A manager asks its slaves for theirs: one that is above this one already would be asked without end.
RTC::ReturnCode_t ManagerServant::add_slave_manager(RTM::Manager_ptr mgr) {
  if (!may_change("another slave")) return RTC::RTC_ERROR;
  if (CORBA::is_nil(mgr)) return RTC::BAD_PARAMETER;
  {
    const std::scoped_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    for (const auto& dropped : dropped_) {
      if (dropped.manager->_is_equivalent(mgr) && now < dropped.may_return) return RTC::BAD_PARAMETER;
    }
  }
  if (!corba::may_keep(mgr) || !answers(mgr) || is_below(mgr, reference_)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return add_unique(slaves_, mgr) ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTC::ReturnCode_t ManagerServant::remove_slave_manager(RTM::Manager_ptr mgr) {
  if (!may_change("a slave to be forgotten")) return RTC::RTC_ERROR;
  if (CORBA::is_nil(mgr)) return RTC::BAD_PARAMETER;
  answers(mgr);  // one that has died may go as well
  const std::scoped_lock lock(mutex_);
  return std::erase_if(slaves_, [&](const auto& known) { return known->_is_equivalent(mgr); }) > 0 ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

void ManagerServant::drop(RTM::Manager_ptr slave, bool hangs) {
  std::chrono::seconds absence{};
  {
    const std::scoped_lock lock(mutex_);
    std::erase_if(slaves_, [&](const auto& known) { return known->_is_equivalent(slave); });
    if (!hangs) return;
    auto found = std::find_if(dropped_.begin(), dropped_.end(), [&](const auto& known) { return known.manager->_is_equivalent(slave); });
    if (found == dropped_.end()) {
      if (dropped_.size() >= max_managers) dropped_.erase(dropped_.begin());
      found = dropped_.insert(dropped_.end(), Dropped{RTM::Manager_var(RTM::Manager::_duplicate(slave))});
    }
    absence = shortest_absence * (1 << std::min(found->times, max_doublings));
    ++found->times;
    found->is_told = false;
    found->may_return = std::chrono::steady_clock::now() + absence;
  }
  base::log(base::Level::warn, "manager", "a slave manager does not answer: it is dropped, and may come back after {} s", absence.count());
}

void ManagerServant::tell_dropped_slaves() {
  std::vector<RTM::Manager_var> untold;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& dropped : dropped_) {
      if (!dropped.is_told) untold.push_back(dropped.manager);
    }
  }
  const corba::ChainDeadline deadline(ping_timeout);
  for (const auto& slave : untold) {
    if (deadline.is_over()) return;
    bool is_told = true;
    try {
      deadline.limit(slave);
      slave->remove_master_manager(reference_);
    } catch (const CORBA::Exception& e) {  // gone, or still hanging
      is_told = !corba::is_time_out(e);
    }
    const std::scoped_lock lock(mutex_);
    for (auto& dropped : dropped_) {
      if (dropped.manager->_is_equivalent(slave)) dropped.is_told = is_told;
    }
  }
}

// The slaves that answer; the others are forgotten. All are asked at the same time: however many hang, it takes the time of one.
std::vector<RTM::Manager_var> ManagerServant::living_slaves() {
  std::vector<RTM::Manager_var> slaves;
  {
    const std::scoped_lock lock(mutex_);
    slaves = slaves_;
  }
  std::vector<char> is_living(slaves.size());
  at_once(slaves.size(), [&](std::size_t i) {
    try {
      corba::set_call_timeout(slaves[i], peer_timeout);
      is_living[i] = slaves[i]->_non_existent() ? 0 : 1;
      if (is_living[i] == 0) drop(slaves[i], false);
    } catch (const CORBA::NO_PERMISSION&) {  // it does not let in for whom we ask
    } catch (const CORBA::Exception& e) {    // as good as gone
      drop(slaves[i], corba::is_time_out(e));
    }
  });
  std::vector<RTM::Manager_var> living;
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    if (is_living[i] != 0) living.push_back(slaves[i]);
  }
  return living;
}

// Nil if nothing that is a manager answers there.
RTM::Manager_var ManagerServant::manager_at(const std::string& address) {
  const auto url = "corbaloc:iiop:" + base::with_numeric_host(address) + "/" + manager_.configValue("manager.name");
  try {
    CORBA::Object_var object = manager_.getORB()->string_to_object(url.c_str());
    corba::set_call_timeout(object, peer_timeout);
    RTM::Manager_var manager = RTM::Manager::_narrow(object);
    if (!CORBA::is_nil(manager)) corba::set_call_timeout(manager, peer_timeout);
    return manager;
  } catch (const CORBA::Exception&) {
    return RTM::Manager::_nil();
  }
}

void ManagerServant::greet_master() {
  RTM::Manager_var master = manager_at(manager_.configValue("corba.master_manager"));
  try {
    // A manager that is no master has that address because the port was free; it may be this one.
    if (!CORBA::is_nil(master) && master->is_master()) {
      add_master(master);                     // BAD_PARAMETER: it is in the list
      master->add_slave_manager(reference_);  // BAD_PARAMETER: it knows us
      greeted_ = master;
      return;
    }
  } catch (const CORBA::Exception&) {  // gone meanwhile
  }
  if (!CORBA::is_nil(greeted_)) remove_master(greeted_);
  greeted_ = RTM::Manager::_nil();
}

void ManagerServant::leave_masters() {
  std::vector<RTM::Manager_var> masters;
  std::vector<RTM::Manager_var> slaves;
  {
    const std::scoped_lock lock(mutex_);
    masters.swap(masters_);
    slaves.swap(slaves_);
  }
  const auto quietly = [](auto&& call) {
    try {
      call();
    } catch (const CORBA::Exception&) {  // it has gone before us
    }
  };
  at_once(masters.size() + slaves.size(), [&](std::size_t i) {
    auto& other = i < masters.size() ? masters[i] : slaves[i - masters.size()];
    corba::set_call_timeout(other, peer_timeout);
    quietly([&] { i < masters.size() ? other->remove_slave_manager(reference_) : other->remove_master_manager(reference_); });
  });
}

}  // namespace RTM
