#include "studio/channel_book.h"

#include <boost/asio/post.hpp>

#include "base/clock.h"
#include "channels/idl_text.h"
#include "system/session.h"
#include "system/value_codec.h"

namespace studio {

// Hands on to the loop what the exchange gives.
class ChannelBook::Inlet final : public channels::Sink {
 public:
  Inlet(boost::asio::io_context& loop, ChannelBook& book, std::shared_ptr<bool> lives)
      : loop_(loop), book_(book), lives_(std::move(lives)) {}

  base::Result<void> open(channels::ChannelId id, const channels::Channel& channel) override {
    post([id, channel](ChannelBook& book) { book.has_opened(id, channel); });
    return {};
  }
  base::Result<void> take(const channels::Sample& sample) override {
    post([sample](ChannelBook& book) { book.tell_.sample(sample); });
    return {};
  }
  base::Result<void> close(channels::ChannelId id) override {
    post([id](ChannelBook& book) { book.has_closed(id); });
    return {};
  }

 private:
  template <class Deed>
  void post(Deed deed) {
    boost::asio::post(loop_, [this, deed = std::move(deed), lives = lives_] {
      if (*lives) deed(book_);
    });
  }

  boost::asio::io_context& loop_;
  ChannelBook& book_;
  std::shared_ptr<bool> lives_;  // read on the loop's thread, where it is written
};

ChannelBook::ChannelBook(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, Tellers tell)
    : loop_(loop), settings_(settings), workers_(workers), tell_(std::move(tell)) {
  exchange_->attach(std::make_shared<Inlet>(loop, *this, lives_));
}

ChannelBook::~ChannelBook() {
  *lives_ = false;
  for (auto& [path, port] : ports_) drop_tap(port);
}

void ChannelBook::has_opened(channels::ChannelId id, channels::Channel channel) {
  const auto& kept = open_[id] = std::move(channel);
  tell_.opened(id, kept);
}

void ChannelBook::has_closed(channels::ChannelId id) {
  if (open_.erase(id) > 0) tell_.closed(id);
  wanted_.erase(id);
}

void ChannelBook::want(channels::ChannelId channel, bool is_wanted) {
  if (is_wanted ? !wanted_.insert(channel).second : wanted_.erase(channel) == 0) return;
  for (auto& [path, port] : ports_) {
    if (port.channel != channel) continue;
    port.is_wanted = is_wanted;
    if (is_wanted) return connect(port);
    return drop_tap(port);
  }
  if (world_) world_->want(channel, is_wanted);
}

void ChannelBook::connect(Port& port) {
  if (port.tap || port.is_connecting) return;
  port.is_connecting = true;
  const auto work = [this, &loop = loop_, lives = lives_, settings = settings_, exchange = exchange_, now = now_, path = port.path,
                     channel = port.channel] {
    std::shared_ptr<tools::Tap> tap;
    const tools::CallLimit limited(settings.call_limit);
    const auto found = tools::Session(settings.orb, settings.name_server, settings.call_limit).port(path);
    if (found) {
      auto made = tools::Tap::connect(settings.orb, found->port, {{"dataport.subscription_type", "new"}},
                                      [exchange, now, channel](std::span<const unsigned char> payload, bool is_little_endian) {
                                        const auto time = now->snapshot();
                                        exchange->put(channel, time.count() > 0 ? time : base::SystemClock().now(),
                                                      channels::cdr_head(is_little_endian),
                                                      {reinterpret_cast<const char*>(payload.data()), payload.size()});
                                      });
      if (made) tap = std::move(*made);
    }
    boost::asio::post(loop, [this, lives, path, tap = std::move(tap)]() mutable {
      const auto known = *lives ? ports_.find(path) : decltype(ports_.find(path))();
      if (!*lives || known == ports_.end()) return;
      known->second.is_connecting = false;
      known->second.tap = std::move(tap);
      if (!known->second.is_wanted) drop_tap(known->second);
    });
  };
  if (!workers_.give(work)) port.is_connecting = false;
}

// Ended by a worker: the component may hang.
void ChannelBook::drop_tap(Port& port) {
  if (!port.tap) return;
  (void)workers_.give([tap = std::move(port.tap), limit = settings_.call_limit]() mutable {
    const tools::CallLimit limited(limit);
    tap.reset();
  });
  port.tap.reset();
}

void ChannelBook::take_system(const Json& system) {
  std::map<std::string, channels::Channel> now;
  for (const Json& component : system.value("components", Json::array())) {
    for (const Json& port : component.value("ports", Json::array())) {
      if (port.value("kind", "") != "out") continue;
      const auto type = port.value("data_type", "");
      channels::Channel channel;
      channel.topic = "/" + component.value("instance", "") + "/" + port.value("name", "");
      channel.encoding = "cdr";
      channel.schema.name = channels::scoped_name(type);
      if (const auto code = tools::type_code_of(type); !CORBA::is_nil(code)) {
        channel.schema.encoding = "omgidl";
        channel.schema.text = channels::idl_text(code);
      }
      now[component.value("path", "") + ":" + port.value("name", "")] = std::move(channel);
    }
  }
  for (auto port = ports_.begin(); port != ports_.end();) {
    if (now.contains(port->first)) {
      ++port;
      continue;
    }
    drop_tap(port->second);
    exchange_->close(port->second.channel);
    port = ports_.erase(port);
  }
  for (auto& [path, channel] : now) {
    if (ports_.contains(path)) continue;
    if (const auto id = exchange_->open(std::move(channel))) ports_[path] = Port{path, *id, nullptr, false, false};
  }
}

void ChannelBook::tend() {
  for (auto& [path, port] : ports_) {
    if (port.is_wanted) connect(port);
  }
  if (world_ && !world_->is_live()) world_.reset();
  if (world_ || is_opening_) return;
  is_opening_ = workers_.give([this, &loop = loop_, lives = lives_, exchange = exchange_, id = settings_.server_id] {
    channels::WorldSourceOptions options;
    options.server_id = id;
    options.takes_part = false;  // nothing waits for viewers
    auto opened = channels::WorldSource::open(*exchange, options);
    auto world = std::make_shared<std::unique_ptr<channels::WorldSource>>(opened ? std::move(*opened) : nullptr);
    boost::asio::post(loop, [this, lives, exchange, world] {  // the exchange lives as long as its source
      if (!*lives) return;
      is_opening_ = false;
      world_ = std::move(*world);
      for (const auto channel : wanted_) {
        if (world_) world_->want(channel, true);  // also what was subscribed to in between
      }
    });
  });
}

void ChannelBook::rest() { world_.reset(); }

}  // namespace studio
