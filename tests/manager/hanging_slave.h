// A manager for tests that hangs when it is asked for its components, until end(). Any thread.
#pragma once

#include <rtm/idl/ManagerSkel.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>

namespace manager_test {

// A slave that answers what a master asks of one, and then nothing.
class HangingSlave final : public POA_RTM::Manager, public PortableServer::RefCountServantBase {
 public:
  RTC::RTCList* get_components() override {
    ++asked;
    if (on_asked) on_asked();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_over_; });
    return new RTC::RTCList();
  }
  RTC::ReturnCode_t remove_master_manager(RTM::Manager_ptr) override {
    std::unique_lock lock(mutex_);
    if (hangs_at_the_end) changed_.wait(lock, [&] { return is_over_; });
    return ++told, RTC::RTC_OK;
  }
  std::function<void()> on_asked;
  bool hangs_at_the_end = false;
  void end() {
    const std::scoped_lock lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }
  std::atomic<int> asked{0};
  std::atomic<int> told{0};

  RTC::ReturnCode_t load_module(const char*, const char*) override { return RTC::RTC_ERROR; }
  RTC::ReturnCode_t unload_module(const char*) override { return RTC::RTC_ERROR; }
  RTM::ModuleProfileList* get_loadable_modules() override { return new RTM::ModuleProfileList(); }
  RTM::ModuleProfileList* get_loaded_modules() override { return new RTM::ModuleProfileList(); }
  RTM::ModuleProfileList* get_factory_profiles() override { return new RTM::ModuleProfileList(); }
  RTC::RTObject_ptr create_component(const char*) override { return RTC::RTObject::_nil(); }
  RTC::ReturnCode_t delete_component(const char*) override { return RTC::RTC_ERROR; }
  RTC::ComponentProfileList* get_component_profiles() override { return new RTC::ComponentProfileList(); }
  RTC::RTCList* get_components_by_name(const char*) override { return new RTC::RTCList(); }
  RTM::ManagerProfile* get_profile() override { return new RTM::ManagerProfile(); }
  RTM::NVList* get_configuration() override { return new RTM::NVList(); }
  RTC::ReturnCode_t set_configuration(const char*, const char*) override { return RTC::RTC_ERROR; }
  CORBA::Boolean is_master() override { return false; }
  RTM::ManagerList* get_master_managers() override { return new RTM::ManagerList(); }
  RTC::ReturnCode_t add_master_manager(RTM::Manager_ptr) override { return RTC::RTC_OK; }
  RTM::ManagerList* get_slave_managers() override { return new RTM::ManagerList(); }
  RTC::ReturnCode_t add_slave_manager(RTM::Manager_ptr) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t remove_slave_manager(RTM::Manager_ptr) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t fork() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t shutdown() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t restart() override { return RTC::RTC_OK; }
  CORBA::Object_ptr get_service(const char*) override { return CORBA::Object::_nil(); }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_over_ = false;
};

}  // namespace manager_test
