// The channels for viewers with foxglove.websocket.v1: the simulator's view as ROS 2 messages, and every OutPort. A source works while it
// has a subscriber. The loop's thread only.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "channels/exchange.h"
#include "channels/views/world_source.h"
#include "studio/signals.h"
#include "system/tap.h"

namespace studio {

class ChannelBook {
 public:
  struct Tellers {
    std::function<void(channels::ChannelId, const channels::Channel&)> opened;
    std::function<void(channels::ChannelId)> closed;
    std::function<void(const channels::Sample&)> sample;
  };

  ChannelBook(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, Tellers tell);
  ~ChannelBook();

  const std::map<channels::ChannelId, channels::Channel>& open_channels() const { return open_; }
  void want(channels::ChannelId channel, bool is_wanted);
  // The event "system": OutPorts come and go.
  void take_system(const Json& system);
  // About once a second while somebody may subscribe: finds the simulator again.
  void tend();
  // Nobody may subscribe: the simulator is left alone.
  void rest();
  // Of the simulation: what ports send is stamped with it.
  void set_time(std::chrono::nanoseconds now) { *now_->lock() = now; }

 private:
  class Inlet;  // the sink of the exchange
  struct Port {
    std::string path;
    channels::ChannelId channel = 0;
    std::shared_ptr<tools::Tap> tap;
    bool is_wanted = false;
    bool is_connecting = false;
  };
  void has_opened(channels::ChannelId id, channels::Channel channel);
  void has_closed(channels::ChannelId id);
  void connect(Port& port);
  void drop_tap(Port& port);

  boost::asio::io_context& loop_;
  const SignalSettings settings_;
  Workers& workers_;
  const Tellers tell_;
  std::map<channels::ChannelId, channels::Channel> open_;
  std::map<std::string, Port> ports_;  // by path
  std::set<channels::ChannelId> wanted_;
  bool is_opening_ = false;
  using Now = base::Guarded<std::chrono::nanoseconds, base::Rank::noted>;
  std::shared_ptr<Now> now_ = std::make_shared<Now>();
  std::shared_ptr<bool> lives_ = std::make_shared<bool>(true);  // what workers post to the loop may come later than our end
  std::shared_ptr<channels::Exchange> exchange_ = std::make_shared<channels::Exchange>();
  std::unique_ptr<channels::WorldSource> world_;
};

}  // namespace studio
