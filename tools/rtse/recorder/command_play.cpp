// play.
#include <poll.h>

#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "channels/idl_text.h"
#include "recording/mcap/mcap.h"
#include "recording/ring.h"
#include "recording/run_clock.h"
#include "recording/sample_text.h"
#include "rtse/command.h"
#include "rtse/recorder/recorder_commands.h"
#include "shm/lockstep.h"
#include "system/tap.h"

namespace recorder {

namespace {

using tools::Console;
using tools::Session;
using WallClock = std::chrono::steady_clock;

struct PlayOptions {
  std::string file;
  std::vector<std::string> links;  // "COMPONENT:PORT=INPORT"; none: the InPorts that the recorded connections had
  double rate = 1;
  bool loop = false;
  double from_s = 0;
  double to_s = 0;
  bool by_simulation = false;
  int server_id = static_cast<int>(default_server_id());
};

// A channel of the recording, and the InPorts that get it.
struct Route {
  std::vector<std::unique_ptr<tools::Tap>> targets;
  std::uint64_t sent = 0;
};
using Routes = std::map<std::uint16_t, Route>;

std::optional<std::uint16_t> channel_of(const mcap::Reader& reader, const std::string& name) {
  const std::string topic = name.starts_with("/") ? name : "/" + name.substr(0, name.find(':')) + "/" + name.substr(name.find(':') + 1);
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.topic == topic) return id;
  }
  return std::nullopt;
}

// "" when the recording does not say it.
std::string type_of(const mcap::Reader& reader, const mcap::Channel& channel) {
  if (const auto said = channel.metadata.find("data_type"); said != channel.metadata.end()) return said->second;
  const auto schema = reader.schemas().find(channel.schema);
  return schema != reader.schemas().end() ? schema->second.name : "";
}

base::Result<void> add_route(const Session& session, const mcap::Reader& reader, const std::string& link, Routes& routes) {
  const auto equals = link.find('=');
  if (equals == std::string::npos) return base::Error{"link " + base::in_quotes(link) + ": expected COMPONENT:PORT=INPORT"};
  const std::string source = link.substr(0, equals);
  const auto channel = channel_of(reader, source);
  if (!channel) {
    std::vector<std::string> topics;
    for (const auto& [id, one] : reader.channels()) topics.push_back(one.topic);
    return base::Error{"recording: has no channel " + base::in_quotes(source) + "; channels: " + base::join(topics, ", ")};
  }
  const auto port = session.port(link.substr(equals + 1));
  if (!port) return port.error();
  if (port->port.port_type() != "DataInPort") {
    return base::Error{"port " + port->port.full_name + ": is a " + port->port.port_type() + ", play writes to InPorts"};
  }
  const mcap::Channel& recorded = reader.channels().at(*channel);
  const std::string type = type_of(reader, recorded);
  if (!type.empty() && channels::scoped_name(type) != channels::scoped_name(port->port.data_type())) {
    return base::Error{"port " + port->port.full_name + ": takes " + port->port.data_type() + ", " + recorded.topic + " was " + type};
  }
  auto tap = tools::Tap::connect(session.orb(), port->port, {{"rtmsim.play.topic", recorded.topic}}, {});
  if (!tap) return tap.error();
  routes[*channel].targets.push_back(std::move(*tap));
  return {};
}

// "COMPONENT:PORT=INPORT" for each InPort that a recorded port was connected to, once.
std::set<std::string> recorded_links(const mcap::Reader& reader) {
  std::set<std::string> links;
  for (const auto& [id, channel] : reader.channels()) {
    for (const auto& [key, value] : channel.metadata) {
      if (!key.starts_with("connector") || !key.ends_with(".inports")) continue;
      for (const auto& inport : base::split_list(value)) links.insert(channel.topic + "=" + inport);
    }
  }
  return links;
}

// Without links each recorded port goes where it went; InPorts that are not there now are told.
base::Result<void> add_recorded_routes(const Session& session, Console& console, const mcap::Reader& reader, Routes& routes) {
  const auto links = recorded_links(reader);
  if (links.empty())
    return base::Error{"recording: does not list the InPorts to which its channels were connected; expected COMPONENT:PORT=INPORT"};
  for (const auto& link : links) {
    if (const auto added = add_route(session, reader, link, routes); !added) console.warn(base::printable(added.error().message));
  }
  if (routes.empty()) return base::Error{"recording: none of the InPorts to which its channels were connected exists"};
  return {};
}

// When what was recorded is sent: at moments since the start.
class Pace {
 public:
  virtual ~Pace() = default;
  // True when the time has come, false after an interrupt, or when time has ended.
  virtual bool wait(std::chrono::nanoseconds moment) = 0;
};

bool wait_until(WallClock::time_point due) {
  while (!base::is_interrupted()) {
    const auto left = due - WallClock::now();
    if (left <= WallClock::duration::zero()) return true;
    pollfd handle{base::interrupt_handle(), POLLIN, 0};
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
    const timespec limit{ns / 1'000'000'000, ns % 1'000'000'000};
    (void)::ppoll(&handle, 1, &limit, nullptr);
  }
  return false;
}

class WallPace final : public Pace {
 public:
  bool wait(std::chrono::nanoseconds moment) override { return wait_until(start_ + moment); }

 private:
  const WallClock::time_point start_ = WallClock::now();
};

// By the clock of a simulator: as a component of phase 0, whose tick lasts until all that is due has been sent.
class SimulatedPace final : public Pace {
 public:
  explicit SimulatedPace(shm::Participant participant) : participant_(std::move(participant)) {}
  static base::Result<std::unique_ptr<Pace>> join(int server_id) {
    auto participant =
        shm::Participant::join(static_cast<std::uint32_t>(server_id), {.name = "play", .phase = 0, .period = std::chrono::milliseconds(1)});
    if (!participant) return participant.error();
    return std::unique_ptr<Pace>(new SimulatedPace(std::move(*participant)));
  }
  bool wait(std::chrono::nanoseconds moment) override {
    while (!start_ || now_ - *start_ < moment) {
      if (base::is_interrupted()) return false;
      shm::Tick tick;
      const auto what = participant_.wait(tick, std::chrono::milliseconds(100));
      if (what == shm::Participant::State::timed_out) continue;
      if (what != shm::Participant::State::tick) return false;
      now_ = tick.now;
      if (!start_ || now_ < *start_) start_ = now_;
    }
    return true;
  }

 private:
  shm::Participant participant_;
  std::optional<std::chrono::nanoseconds> start_;
  std::chrono::nanoseconds now_{0};
};

// Plain CDR in the order that the connections of taps announce.
std::optional<std::span<const unsigned char>> payload_of(const mcap::Message& message) {
  if (message.data.size() < 4 || message.data[1] != 1) return std::nullopt;
  return std::span(reinterpret_cast<const unsigned char*>(message.data.data()) + 4, message.data.size() - 4);
}

// False when it was interrupted, or failed.
bool play_once(Console& console, mcap::Reader& reader, const PlayOptions& options, Routes& routes, Pace& pace) {
  mcap::Query query;
  for (const auto& [channel, route] : routes) query.channels.push_back(channel);
  query.from = mcap::Time(static_cast<std::uint64_t>(options.from_s * 1e9));
  if (options.to_s > 0) query.to = mcap::Time(static_cast<std::uint64_t>(options.to_s * 1e9));
  reader.seek(std::move(query));
  std::optional<mcap::Time> first;
  for (;;) {
    const auto message = reader.next();
    if (!message) {
      console.fail(message.error());
      continue;
    }
    if (!message->has_value()) return true;
    if (!first) first = (*message)->log_time;
    const std::chrono::duration<double> offset(static_cast<double>(((*message)->log_time - *first).count()) * 1e-9 / options.rate);
    if (!pace.wait(std::chrono::duration_cast<std::chrono::nanoseconds>(offset))) return false;
    const auto payload = payload_of(**message);
    Route& route = routes.at((*message)->channel);
    const std::string& topic = reader.channels().at((*message)->channel).topic;
    if (!payload) {
      console.fail({"channel " + topic + ": its samples are not in little-endian CDR"});
      return false;
    }
    for (const auto& target : route.targets) {
      if (const auto sent = target->put(*payload); !sent) {
        console.fail({"channel " + topic + ": " + sent.error().message});
        return false;
      }
      ++route.sent;
    }
  }
}

void play(const Session& session, Console& console, const PlayOptions& options) {
  auto reader = open_recording(options.file);
  if (!reader) return console.fail(reader.error());
  if (reader->damage()) console.warn(*reader->damage());
  Routes routes;
  for (const auto& link : options.links) {
    if (const auto added = add_route(session, *reader, link, routes); !added) return console.fail(added.error());
  }
  if (options.links.empty()) {
    if (const auto added = add_recorded_routes(session, console, *reader, routes); !added) return console.fail(added.error());
  }
  base::catch_interrupts();
  const tools::CallLimit limited(session.call_timeout());
  const auto sent = [&] {
    std::uint64_t sum = 0;
    for (const auto& [channel, route] : routes) sum += route.sent;
    return sum;
  };
  for (bool goes_on = true; goes_on;) {
    auto pace =
        options.by_simulation ? SimulatedPace::join(options.server_id) : base::Result<std::unique_ptr<Pace>>(std::make_unique<WallPace>());
    if (!pace) return console.fail(pace.error());
    const bool is_over = play_once(console, *reader, options, routes, **pace);
    if (is_over && sent() == 0) return console.fail({"recording: has no sample of these channels in the time that is to be played"});
    goes_on = is_over && options.loop;
  }
  if (console.json())
    console.print(Json{{"sent", sent()}});
  else
    std::cout << "sent " << sent() << " samples\n";
}

}  // namespace

void add_play(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("play", "Send a recording to InPorts of a running system");
  auto options = std::make_shared<PlayOptions>();
  command->add_option("FILE", options->file, "Recording")->required()->check(base::valid_file(recording_format_problem));
  command->add_option("LINK", options->links,
                      "Receiver of a channel: COMPONENT:PORT=INPORT, e.g. RTCLaser0:range=MyFilter0:in (default: as recorded)");
  command->add_option("-r,--rate", options->rate, "Playback speed (1: as recorded)")
      ->check(base::number_between(1e-3, 1e6))
      ->capture_default_str();
  command->add_flag("--loop", options->loop, "Start over at the end, until stopped");
  command->add_option("--from", options->from_s, "Start time [s]")->seconds_between(0.0, 1e10);
  command->add_option("--to", options->to_s, "End time [s]")->seconds_between(0.0, 1e10);
  command->add_flag("--sim-time", options->by_simulation, "Use simulated time; in lock step, simulated time waits for playback");
  command->add_option("-s,--server-id", options->server_id, "With --sim-time: simulator ID (default: $RTMSIM_SERVER_ID, else 0)")
      ->check(base::number_between(0, 9999));
  command->callback(
      [&chosen, options] { chosen.work = [options](const Session& session, Console& console) { play(session, console, *options); }; });
}

}  // namespace recorder
