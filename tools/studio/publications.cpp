#include "studio/publications.h"

#include <boost/asio/post.hpp>
#include <cstdint>
#include <iterator>
#include <span>

#include "base/clock.h"
#include "base/text.h"
#include "channels/idl_text.h"
#include "system/remote.h"
#include "system/session.h"
#include "system/typed_value.h"
#include "system/value_codec.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::size_t max_waiting = 64;     // samples of a channel
constexpr std::size_t max_of_viewer = 256;  // channels

// Plain CDR, little endian, of a sample in one of the encodings.
Result<std::vector<unsigned char>> encoded(CORBA::TypeCode_ptr type, const std::string& encoding, const std::string& payload) {
  if (encoding == "json") {
    if (!is_flat_enough(payload)) return Error{"its brackets are more than 24 deep"};
    const auto value = tools::parse_value(type, payload, base::SystemClock().now().count());
    if (!value) return value.error();
    return tools::encode(type, *value);
  }
  // Four bytes in front say how it is encoded: 0, then 0 big endian or 1 little endian.
  constexpr std::size_t head = 4;
  if (payload.size() < head || payload[0] != 0 || static_cast<unsigned char>(payload[1]) > 1)
    return Error{"expected CDR with its four bytes of encapsulation"};
  const std::span octets(reinterpret_cast<const unsigned char*>(payload.data()) + head, payload.size() - head);
  const auto value = tools::decode(type, octets, payload[1] == 1, payload.size());
  if (!value) return value.error();
  return tools::encode(type, *value);
}

}  // namespace

Publications::Publications(boost::asio::io_context& loop, const SignalSettings& settings, Workers& workers, Fail fail)
    : loop_(loop), settings_(settings), workers_(workers), fail_(std::move(fail)) {}

Publications::~Publications() {
  *lives_ = false;
  for (auto& [key, line] : lines_) drop(std::move(line.tap));
}

Result<void> Publications::open(std::uint64_t viewer, const Publication& channel, const Json& system) {
  const Key key{viewer, channel.id};
  const auto what = "channel " + std::to_string(channel.id) + " (" + channel.topic + "): ";
  if (lines_.contains(key)) return Error{what + "is advertised already"};
  const auto first = lines_.lower_bound({viewer, 0}), last = lines_.upper_bound({viewer, UINT32_MAX});
  if (static_cast<std::size_t>(std::distance(first, last)) >= max_of_viewer) return Error{what + "256 channels are advertised already"};
  if (channel.encoding != "json" && channel.encoding != "cdr")
    return Error{what + "encoding " + base::in_quotes(channel.encoding) + ", expected json or cdr"};
  for (const Json& component : list_in(system, "components")) {
    for (const Json& port : list_in(component, "ports")) {
      const auto name = port.value("name", ""), type = port.value("data_type", "");
      if (port.value("kind", "") != "in" || channel.topic != "/" + component.value("instance", "") + "/" + name) continue;
      const auto carried = channels::scoped_name(type);
      if (channel.encoding == "cdr" && !channel.schema.empty() && channel.schema != carried)
        return Error{what + "has the schema " + channel.schema + ", the port takes " + carried};
      lines_[key].target = {component.value("path", "") + ":" + name, type, channel.encoding};
      return {};
    }
  }
  return Error{what + "no InPort has this topic, expected /INSTANCE/PORT"};
}

Result<void> Publications::close(std::uint64_t viewer, std::uint32_t channel) {
  auto line = lines_.extract(Key{viewer, channel});
  if (line.empty()) return Error{"channel " + std::to_string(channel) + ": is not advertised"};
  drop(std::move(line.mapped().tap));
  return {};
}

void Publications::close_all(std::uint64_t viewer) {
  const auto first = lines_.lower_bound({viewer, 0}), last = lines_.upper_bound({viewer, UINT32_MAX});
  for (auto line = first; line != last; ++line) drop(std::move(line->second.tap));
  lines_.erase(first, last);
}

Result<void> Publications::publish(std::uint64_t viewer, std::uint32_t channel, std::string_view payload) {
  const auto found = lines_.find({viewer, channel});
  if (found == lines_.end()) return Error{"channel " + std::to_string(channel) + ": is not advertised"};
  Line& line = found->second;
  line.waiting.emplace_back(payload);
  if (line.waiting.size() > max_waiting) line.waiting.pop_front();
  send(found->first, line);
  return {};
}

// On a worker.
Publications::Sent Publications::send_all(const SignalSettings& settings, const Target& target, std::shared_ptr<tools::Tap> tap,
                                          const std::deque<std::string>& samples) {
  const auto failed = [&](const std::string& why) { return Sent{nullptr, "port " + target.path + ": " + why}; };
  const auto type = tools::type_code_of(target.type);
  if (CORBA::is_nil(type)) return failed("carries " + target.type + ", which rtm-studio does not know");
  const tools::CallLimit limited(settings.call_limit);
  if (!tap) {
    tools::Session session(settings.orb, settings.name_server, settings.call_limit);
    const auto port = session.port(target.path);
    if (!port) return failed(port.error().message);
    auto connected = tools::Tap::connect(settings.orb, port->port, {}, {});
    if (!connected) return failed(connected.error().message);
    tap = std::move(*connected);
  }
  std::string problem;
  for (const std::string& sample : samples) {
    const auto octets = encoded(type, target.encoding, sample);
    if (!octets) {
      problem = failed(octets.error().message).problem;
      continue;
    }
    if (const auto sent = tap->put(*octets); !sent) return failed(sent.error().message);
  }
  return {std::move(tap), problem};
}

void Publications::send(const Key& key, Line& line) {
  if (line.is_sending || line.waiting.empty()) return;
  auto work = [this, key, &loop = loop_, lives = lives_, settings = settings_, target = line.target, tap = line.tap,
               samples = line.waiting]() mutable {
    Sent sent;
    try {
      sent = send_all(settings, target, std::move(tap), samples);
    } catch (const std::exception& e) {
      sent.problem = "port " + target.path + ": " + e.what();
    } catch (const CORBA::Exception& e) {
      sent.problem = "port " + target.path + ": " + tools::describe(e);
    }
    boost::asio::post(loop, [this, key, lives, sent = std::move(sent)]() mutable {
      if (*lives) have_sent(key, std::move(sent));
    });
  };
  if (!workers_.give(std::move(work))) return;
  line.is_sending = true;
  line.waiting.clear();
  line.tap.reset();
}

void Publications::have_sent(const Key& key, Sent sent) {
  const auto found = lines_.find(key);
  if (found == lines_.end()) return drop(std::move(sent.tap));
  Line& line = found->second;
  line.is_sending = false;
  line.tap = std::move(sent.tap);
  if (sent.problem != line.problem && !sent.problem.empty()) fail_(key.first, sent.problem);
  line.problem = sent.problem;
  send(key, line);
}

// Ended by a worker: the component may hang.
void Publications::drop(std::shared_ptr<tools::Tap> tap) {
  if (!tap) return;
  (void)workers_.give([tap = std::move(tap), limit = settings_.call_limit]() mutable {
    const tools::CallLimit limited(limit);
    tap.reset();
  });
}

}  // namespace studio
