#include "iface_component.h"

#include <base/text.h>

#include <string_view>

namespace iface {

IfaceComponent::IfaceComponent(RTC::Manager* manager, const Specification& specification, shm::IfaceType type, bool subscribe)
    : RTC::DataFlowComponentBase(manager), specification_(specification), subscribe_(subscribe), link_(type, say()) {}

Say IfaceComponent::say() {
  return [this](bool is_problem, const std::string& line) {
    if (is_problem) {
      RTC_WARN(("%s", line.c_str()));
    } else {
      RTC_INFO(("%s", line.c_str()));
    }
  };
}

void IfaceComponent::say_limited(bool is_problem, const std::string& line) {
  if (const auto said = limit_.next(line)) say()(is_problem, *said);
}

// Its own, unless port_names has another one; a pair that is none is skipped with a line.
std::string IfaceComponent::port_name(const std::string& own) {
  std::string name = own;
  for (const std::string& pair : base::split_list(getProperties().getProperty("conf.default.port_names"))) {
    const std::string_view words = base::trim(pair);
    const auto colon = words.find(':');
    if (words.empty()) continue;
    if (colon == std::string_view::npos || colon == 0 || colon + 1 == words.size()) {
      RTC_WARN(("port_names: expected OWN:OTHER, got \"%s\"", pair.c_str()));
    } else if (base::trim(words.substr(0, colon)) == own) {
      name = base::trim(words.substr(colon + 1));
    }
  }
  return name;
}

bool IfaceComponent::addInPort(const char* name, RTC::InPortBase& port) {
  return DataFlowComponentBase::addInPort(port_name(name).c_str(), port);
}
bool IfaceComponent::addOutPort(const char* name, RTC::OutPortBase& port) {
  return DataFlowComponentBase::addOutPort(port_name(name).c_str(), port);
}
bool IfaceComponent::addPort(RTC::PortBase& port) {
  port.setName(port_name(port.getName()).c_str());
  return DataFlowComponentBase::addPort(port);
}

void IfaceComponent::bindDevice() {
  bindParameter("server_id", server_id_, std::to_string(default_server()).c_str());
  bindParameter("device_id", device_id_, specification_.device);
}

bool IfaceComponent::attach() {
  const auto device = configured();
  if (const auto done = link_.attach(device, subscribe_); !done) {
    if (const auto line = limit_.next(done.error().message)) RTC_ERROR(("%s", line->c_str()));
    return false;
  }
  attached(device);
  describe_when_new();
  return true;
}

void IfaceComponent::describe_when_new() {
  if (described_ == link_.attachments()) return;
  const auto* iface = link_.live();
  if (iface == nullptr) return;
  described_ = link_.attachments();
  describe(*iface);
}

void IfaceComponent::detach() {
  detaching();
  link_.detach();
}

bool IfaceComponent::follow_configuration() {
  if (configured() == link_.device()) {
    describe_when_new();
    return true;
  }
  detach();
  return attach();
}

RTC::ReturnCode_t IfaceComponent::onActivated(RTC::UniqueId) { return attach() ? RTC::RTC_OK : RTC::RTC_ERROR; }

RTC::ReturnCode_t IfaceComponent::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  publish_newest();
  return RTC::RTC_OK;
}

void IfaceComponent::publish_newest() {
  const auto* device = link_.fresh(wait_limit());
  if (device != nullptr && device->sample<shm::Stamp>().valid != 0) publish(*device);
}

RTC::ReturnCode_t IfaceComponent::onDeactivated(RTC::UniqueId) {
  detach();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t IfaceComponent::onAborting(RTC::UniqueId) {
  detach();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t IfaceComponent::onFinalize() {
  detach();
  return RTC::RTC_OK;
}

}  // namespace iface
