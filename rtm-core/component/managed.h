// A component as its manager knows it: name, start, end, and the profile that others see. It keeps the component in memory as long as it
// lives, and deletes nothing. Any thread.
#pragma once

#include <coil/Properties.h>
#include <rtm/idl/RTCStub.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace RTC {

class PortBase;
class RTObject_impl;

class Managed {
 public:
  // A callback that runs on some thread.
  struct Callback {
    const char* name;
    std::chrono::steady_clock::time_point since;
    std::thread::id thread;
  };
  using Deadline = std::chrono::steady_clock::time_point;

  virtual ~Managed() = default;
  // What authors know it as.
  virtual RTObject_impl* object() const = 0;
  // A new reference; nil when the component has just been finalized.
  virtual RTObject_ptr reference() const = 0;
  virtual std::string instance_name() const = 0;
  virtual std::string type_name() const = 0;
  virtual std::string category() const = 0;
  virtual std::string vendor() const = 0;
  virtual std::string version() const = 0;
  // Under which naming services are to know it.
  virtual std::vector<std::string> naming_names() const = 0;
  // The caller owns it.
  virtual ComponentProfile* profile() const = 0;
  virtual std::vector<PortBase*> ports() const = 0;

  virtual void set_instance_name(const std::string& name) = 0;
  virtual void set_properties(const coil::Properties& properties) = 0;
  // Makes the component's own contexts unless it has some.
  virtual bool bind_contexts() = 0;
  virtual ReturnCode_t initialize() = 0;

  virtual ReturnCode_t exit() = 0;
  // The same with a deadline.
  virtual void exit_by(Deadline deadline) = 0;
  // Asks its contexts to calm it, and returns at once.
  virtual void ask_to_rest() = 0;
  virtual void come_to_rest(Deadline deadline) = 0;
  // Leaves contexts and organizations whose process has died.
  virtual void leave_the_dead() = 0;
  virtual std::vector<Callback> callbacks() const = 0;
  // After exit(): a thread is still in a callback; the component must not be deleted before it returns.
  virtual bool is_held_by_callback() const = 0;
};

// Null for a null pointer. The component must be in memory.
std::shared_ptr<Managed> manage(RTObject_impl* component);
std::shared_ptr<const Managed> manage(const RTObject_impl* component);

// Of one that never lived; does nothing to others.
void discard(RTObject_impl& component);

// Contexts of components that have gone, which a callback kept from ending. True when none is left.
bool destroy_left_contexts();

}  // namespace RTC
