// The devices that one port shows. One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device.h"
#include "mapping.h"

namespace gateway {

// Finds the iface of a device, shared with other devices that show the same one; nothing when it is not there.
using FindSource = std::function<std::shared_ptr<Source>(shm::IfaceType type, const std::string& name)>;

class Robot {
 public:
  Robot(std::uint32_t port, Services services) : port_(port), services_(services) {}

  std::uint32_t port() const { return port_; }
  const std::string& name() const { return name_; }

  // Devices of the plan that were there before keep their clients; others that have clients stay, with nothing to show, as long as they
  // have.
  void arrange(const PortPlan& plan, const FindSource& find_source);
  // The simulator has gone.
  void detach();

  // Nothing for what was never there.
  Device* find(const player::Address& address) const;
  // What there is to show now.
  std::vector<player::Address> devices() const;
  // "laser:0=robot::laser": the same with the ifaces, for people.
  std::vector<std::string> shown() const;
  const std::vector<std::unique_ptr<Device>>& all() const { return devices_; }
  // The client has gone.
  void leave(Client& client);

 private:
  const std::uint32_t port_;
  const Services services_;
  std::string name_;
  std::vector<std::unique_ptr<Device>> devices_;
};

}  // namespace gateway
