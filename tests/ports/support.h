// What tests of ports share: an ORB for the process, connection profiles, and a peer process. One thread at a time.
#pragma once

#include <rtm/CORBA_SeqUtil.h>
#include <rtm/CorbaPort.h>
#include <rtm/InPort.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <initializer_list>
#include <string>
#include <thread>
#include <utility>

#include "base/tick.h"
#include "corba/orb/orb.h"
#include "support/paths.h"
#include "support/process.h"

namespace ports {

// A tick without a lock step, for those who look at what passes in it.
class LookingTick : public base::Tick {
 public:
  std::chrono::nanoseconds time() const override { return std::chrono::nanoseconds(0); }
  std::uint64_t phase_counter() const override { return 0; }
  void at_end(std::function<void(Tick&)>) override {}
  bool keeps_data() const override { return true; }
};

using Pairs = std::initializer_list<std::pair<const char*, std::string>>;

inline std::unique_ptr<corba::Orb> start_orb() {
  auto orb = corba::Orb::start();
  if (!orb) throw std::runtime_error(orb.error().message);
  (*orb)->activate();
  return std::move(orb).value();
}

// A connection among the ports; `dataport.` comes before every key.
inline RTC::ConnectorProfile profile(std::initializer_list<RTC::PortService_ptr> members, Pairs properties = {}, const char* id = "") {
  RTC::ConnectorProfile made;
  made.name = "test";
  made.connector_id = id;
  for (auto* port : members) {
    CORBA_SeqUtil::push_back(made.ports, RTC::PortService::_duplicate(port));
  }
  NVUtil::setStringValue(made.properties, "dataport.interface_type", "corba_cdr");
  NVUtil::setStringValue(made.properties, "dataport.dataflow_type", "push");
  for (const auto& [key, value] : properties)
    NVUtil::setStringValue(made.properties, ("dataport." + std::string(key)).c_str(), value.c_str());
  return made;
}

// A servant on the stack, out of reach before it dies.
template <class Servant>
class Local final : public Servant {
 public:
  using Servant::Servant;
  ~Local() override {
    try {
      const PortableServer::POA_var poa = this->_default_POA();
      const PortableServer::ObjectId_var id = poa->servant_to_id(this);
      poa->deactivate_object(id);
    } catch (const CORBA::Exception&) {
      return;  // nobody has asked for its reference
    }
    // A caller has its answer a little before the POA is done with the call.
    while (holders_ > 1) std::this_thread::yield();
  }
  void _add_ref() override { ++holders_; }
  void _remove_ref() override { --holders_; }

 private:
  std::atomic<int> holders_{1};
};

// Waits for what another thread or process does; false when the watchdog bites.
template <class Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + support::watchdog;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

// The program ports_peer with its ports, in a process of its own.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments = {}) : process_(command(std::move(arguments))) {
    if (!process_.wait_for_output("ready\n")) throw std::runtime_error("the peer does not start: " + process_.output());
  }
  RTC::PortService_var port(const std::string& name) {
    const CORBA::Object_var object = reference(name);
    return RTC::PortService::_narrow(object);
  }
  CORBA::Object_var reference(const std::string& name) {
    const std::string output = process_.output();
    const auto at = output.find(name + " IOR:") + name.size() + 1;
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    return orb->string_to_object(output.substr(at, output.find('\n', at) - at).c_str());
  }
  support::Process& process() { return process_; }

 private:
  static std::vector<std::string> command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), std::string(paths::bin_dir) + "/ports_peer");
    return arguments;
  }
  support::Process process_;
};

}  // namespace ports
