// Publishes the OutPorts of a running system as channels. Construct, use and destroy on one thread; samples arrive on the ORB's
// threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "channels/exchange.h"
#include "system/component_view.h"
#include "system/tap.h"

namespace recorder {

// The channel of a port: topic "/COMPONENT/PORT", the exact octets of the wire behind the four that say their order.
channels::Channel channel_of(const tools::ComponentView& component, const tools::PortView& port);

class PortSource final {
 public:
  // The exchange and the clock must live longer.
  PortSource(CORBA::ORB_ptr orb, channels::Exchange& exchange, const base::Clock& clock)
      : orb_(CORBA::ORB::_duplicate(orb)), exchange_(exchange), clock_(clock) {}

  // `extra` is added to the metadata of the channel.
  base::Result<void> add(const tools::ComponentView& component, const tools::PortView& port,
                         const std::map<std::string, std::string>& extra = {});
  // The channel of a port whose component was started again goes on with the new one. Nothing happens to others.
  base::Result<void> connect_again(const tools::ComponentView& component, const tools::PortView& port);
  std::size_t size() const { return tapped_.size(); }
  // How many samples came so far, by topic. Any thread.
  std::map<std::string, std::uint64_t> counts() const;

 private:
  struct Counter {
    std::string topic;
    std::atomic<std::uint64_t> samples{0};  // relaxed: says nothing but itself
  };
  struct Tapped {
    channels::ChannelId channel;
    RTC::PortService_var port;
    std::unique_ptr<Counter> counter;  // before the tap, which uses it
    std::unique_ptr<tools::Tap> tap;
  };
  base::Result<void> connect(Tapped& tapped, const tools::PortView& port);

  CORBA::ORB_var orb_;
  channels::Exchange& exchange_;
  const base::Clock& clock_;
  std::vector<Tapped> tapped_;
};

}  // namespace recorder
