#include "component/managed.h"

#include <rtm/RTObject.h>

#include "component/runtime_access.h"

namespace RTC {

class ManagedComponent final : public Managed {
 public:
  explicit ManagedComponent(RTObject_impl& component) : component_(component) { component_._add_ref(); }
  ~ManagedComponent() override { component_._remove_ref(); }
  ManagedComponent(const ManagedComponent&) = delete;
  ManagedComponent& operator=(const ManagedComponent&) = delete;

  RTObject_impl* object() const override { return &component_; }
  RTObject_ptr reference() const override { return component_.getObjRef(); }
  std::string instance_name() const override { return component_.getInstanceNameString(); }
  std::string type_name() const override { return component_.getTypeName(); }
  std::string category() const override { return component_.getCategory(); }
  std::string vendor() const override { return component_.getVendor(); }
  std::string version() const override { return component_.getVersion(); }
  std::vector<std::string> naming_names() const override { return component_.getNamingNames(); }
  ComponentProfile* profile() const override { return component_.get_component_profile(); }
  std::vector<PortBase*> ports() const override { return RuntimeAccess::local_ports(component_); }

  void set_instance_name(const std::string& name) override { component_.setInstanceName(name.c_str()); }
  void set_properties(const coil::Properties& properties) override { component_.setProperties(properties); }
  bool bind_contexts() override {
    return !RuntimeAccess::own_contexts(component_).empty() || RuntimeAccess::create_contexts(component_) == RTC_OK;
  }
  ReturnCode_t initialize() override { return component_.initialize(); }

  ReturnCode_t exit() override { return component_.exit(); }
  void exit_by(Deadline deadline) override { RuntimeAccess::exit_by(component_, deadline); }
  void ask_to_rest() override { RuntimeAccess::ask_to_rest(component_); }
  void come_to_rest(Deadline deadline) override { RuntimeAccess::come_to_rest(component_, deadline); }
  void leave_the_dead() override { RuntimeAccess::leave_the_dead(component_); }
  std::vector<Callback> callbacks() const override {
    std::vector<Callback> all;
    for (const auto& one : RuntimeAccess::running_callbacks(component_)) all.push_back({one.callback, one.since, one.thread});
    return all;
  }
  bool is_held_by_callback() const override { return RuntimeAccess::is_held_by_callback(component_); }

 private:
  RTObject_impl& component_;
};

std::shared_ptr<Managed> manage(RTObject_impl* component) { return component ? std::make_shared<ManagedComponent>(*component) : nullptr; }

std::shared_ptr<const Managed> manage(const RTObject_impl* component) { return manage(const_cast<RTObject_impl*>(component)); }

bool destroy_left_contexts() { return RuntimeAccess::destroy_left_contexts(); }

void discard(RTObject_impl& component) { RuntimeAccess::discard(component); }

}  // namespace RTC
