// The manager as tools see it: RTM::Manager over CORBA. Any thread.
#pragma once

#include <rtm/RTC.h>

#include <rtm/idl/ManagerSkel.h>

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

namespace RTC {
class Manager;
}

namespace RTM {

class ManagerServant final : public POA_RTM::Manager {
 public:
  explicit ManagerServant(RTC::Manager& manager) : manager_(manager) {}

  // Activates the servant in the root POA and under the manager's name in the INS POA.
  void activate();
  void deactivate();
  // The same as activate() for hosts of components that find no reference; false when it is of no use.
  bool createINSManager();
  // Borrowed; nil before activate.
  RTM::Manager_ptr getObjRef() const { return reference_.in(); }

  RTC::ReturnCode_t load_module(const char* pathname, const char* initfunc) override;
  RTC::ReturnCode_t unload_module(const char* pathname) override;
  RTM::ModuleProfileList* get_loadable_modules() override;
  RTM::ModuleProfileList* get_loaded_modules() override;
  RTM::ModuleProfileList* get_factory_profiles() override;
  RTC::RTObject_ptr create_component(const char* module_name) override;
  RTC::ReturnCode_t delete_component(const char* instance_name) override;
  RTC::RTCList* get_components() override;
  RTC::ComponentProfileList* get_component_profiles() override;
  RTC::RTCList* get_components_by_name(const char* name) override;
  RTM::ManagerProfile* get_profile() override;
  RTM::NVList* get_configuration() override;
  RTC::ReturnCode_t set_configuration(const char* name, const char* value) override;
  CORBA::Boolean is_master() override;
  RTM::ManagerList* get_master_managers() override;
  RTC::ReturnCode_t add_master_manager(RTM::Manager_ptr mgr) override;
  RTC::ReturnCode_t remove_master_manager(RTM::Manager_ptr mgr) override;
  RTM::ManagerList* get_slave_managers() override;
  RTC::ReturnCode_t add_slave_manager(RTM::Manager_ptr mgr) override;
  RTC::ReturnCode_t remove_slave_manager(RTM::Manager_ptr mgr) override;
  RTC::ReturnCode_t fork() override;
  RTC::ReturnCode_t shutdown() override;
  RTC::ReturnCode_t restart() override;
  CORBA::Object_ptr get_service(const char* name) override;

  // As a slave: says hello to the master of corba.master_manager if it is not in the list yet. On the timer.
  void greet_master();
  // Slaves that were dropped because they hung are told when they wake, so that they can come back. On the timer.
  void tell_dropped_slaves();
  void leave_masters();

 private:
  // A slave that has taken the time-out of a call. It may come back, later each time.
  struct Dropped {
    RTM::Manager_var manager;
    int times = 0;
    bool is_told = false;
    std::chrono::steady_clock::time_point may_return{};
  };
  // For callers of other accounts and hosts: manager.remote_rights.
  bool may_do_everything() const;
  bool may_change(const std::string& what, bool needs_everything = false) const;
  bool may_set(const std::string& key, const std::string& value, const std::string& what) const;
  bool may_load(const std::string& module, const std::string& what) const;
  void refuse(const std::string& what, const std::string& why) const;
  RTC::ReturnCode_t add_master(RTM::Manager_ptr mgr);
  RTC::ReturnCode_t remove_master(RTM::Manager_ptr mgr);
  std::vector<RTM::Manager_var> living_slaves();
  void drop(RTM::Manager_ptr slave, bool hangs);
  RTM::Manager_var manager_at(const std::string& address);
  template <class List, class Ask>
  void append_from_slaves(List& list, Ask ask);

  RTC::Manager& manager_;
  RTM::Manager_var reference_;
  std::mutex mutex_;  // guards the three lists
  std::vector<RTM::Manager_var> masters_;
  std::vector<RTM::Manager_var> slaves_;
  std::vector<Dropped> dropped_;
  RTM::Manager_var greeted_;  // the master of corba.master_manager; the timer's thread only
};

}  // namespace RTM
