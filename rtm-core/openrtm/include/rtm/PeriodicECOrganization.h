// The organization behind a PeriodicECSharedComposite: its members leave their own contexts, join the composite's, and lend it their ports.
// Any thread; one change at a time, members are called without a lock.
#pragma once

#include <rtm/SdoOrganization.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "rtm/idl/RTCStub.h"

namespace RTC {
class RTObject_impl;
}

namespace SDOPackage {

class PeriodicECOrganization : public Organization_impl {
 public:
  // The composite must live until close().
  explicit PeriodicECOrganization(RTC::RTObject_impl& composite);
  ~PeriodicECOrganization() override;

  // InvalidParameter, and nothing changes, when the composite would be a member of itself, also by way of other composites, as far as these
  // answer; it takes 5 s at most to find out, twice.
  CORBA::Boolean add_members(const SDOList& sdo_list) override;
  CORBA::Boolean set_members(const SDOList& sdos) override;
  CORBA::Boolean remove_member(const char* id) override;

  // Makes the ports of that comma list (`<member>.<port>`), and no others, ports of the composite.
  void export_ports(const std::string& list);
  // Gives every member back its own life. Later calls from outside find nobody.
  void close();

  // Asks the composite's context for the members' transitions; without a wait, because that context is the one that would do them.
  void activate_members();
  void deactivate_members();
  void reset_members();

 private:
  bool take_in(const std::vector<Member>& joining, bool others_leave);
  bool join(const Member& member);
  void leave(const Member& member);
  void update_ports();
  template <class Function>
  void for_each_member(Function function);

  RTC::RTObject_impl& composite_;
  class Turns;
  const std::unique_ptr<Turns> turns_;
  bool closed_ = false;  // inside a turn only, as everything below
  std::set<std::string> wanted_ports_;
  std::map<std::string, RTC::PortService_var> exported_;  // by full name
};

}  // namespace SDOPackage
