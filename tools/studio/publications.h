// Publishes what viewers send to InPorts: a connection for each channel that a viewer has advertised and used. The loop's thread only;
// workers connect and send, the samples of a channel in their order. A channel keeps at most 64 samples that wait; older ones are dropped.
#pragma once

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "studio/signals.h"
#include "system/tap.h"

namespace studio {

class Publications {
 public:
  // One line for a viewer: its samples do not arrive. Once until they do again.
  using Fail = std::function<void(std::uint64_t viewer, const std::string& line)>;
  Publications(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, Fail fail);
  ~Publications();

  // Topics are /INSTANCE/PORT of InPorts in `system`, the event of that name.
  base::Result<void> open(std::uint64_t viewer, const Publication& channel, const Json& system);
  base::Result<void> close(std::uint64_t viewer, std::uint32_t channel);
  void close_all(std::uint64_t viewer);
  base::Result<void> publish(std::uint64_t viewer, std::uint32_t channel, std::string_view payload);

 private:
  struct Target {
    std::string path, type, encoding;
  };
  struct Line {
    Target target;
    std::deque<std::string> waiting;
    std::shared_ptr<tools::Tap> tap;
    bool is_sending = false;
    std::string problem;
  };
  struct Sent {
    std::shared_ptr<tools::Tap> tap;  // nullptr: connect again for the next sample
    std::string problem;
  };
  using Key = std::pair<std::uint64_t, std::uint32_t>;
  static Sent send_all(const SignalSettings& settings, const Target& target, std::shared_ptr<tools::Tap> tap,
                       const std::deque<std::string>& samples);
  void send(const Key& key, Line& line);
  void have_sent(const Key& key, Sent sent);
  void drop(std::shared_ptr<tools::Tap> tap);

  boost::asio::io_context& loop_;
  const SignalSettings settings_;
  Workers& workers_;
  const Fail fail_;
  std::map<Key, Line> lines_;
  std::shared_ptr<bool> lives_ = std::make_shared<bool>(true);  // what workers post to the loop may come later than our end
};

}  // namespace studio
