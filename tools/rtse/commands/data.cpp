// print, inject.
#include <atomic>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "base/clock.h"
#include "base/command_line.h"
#include "base/descriptors.h"
#include "base/guarded.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/output.h"
#include "system/tap.h"
#include "system/typed_value.h"
#include "system/value_codec.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

std::atomic<bool> ended_by_user{false};
void end_by_user(int) { ended_by_user.store(true, std::memory_order_relaxed); }

struct Sample {
  std::size_t port;
  std::vector<unsigned char> payload;
  bool little_endian;
};

// From the ORB's threads to the printing one. When the printer cannot follow, the oldest samples are dropped and counted.
struct Queue {
  static constexpr std::size_t longest = 1000;
  struct Content {
    std::deque<Sample> samples;
    std::size_t dropped = 0;
  };
  base::Guarded<Content, base::Rank::samples> content;
  std::condition_variable arrived;
};

std::string as_text(const Json& value) {
  if (!value.is_object() || !value.contains("tm") || value.size() != 2) return value.dump();
  const auto& time = value["tm"];
  char stamp[40];
  std::snprintf(stamp, sizeof stamp, "[%u.%09u]", time["sec"].get<unsigned>(), time["nsec"].get<unsigned>());
  return std::string(stamp) + " " + (++value.begin()).value().dump();
}

constexpr std::chrono::seconds long_silence{2};  // after it a port that has sent nothing is named

// "port A0:out: no sample in 2 s, print waits; A0 is Inactive".
std::string silence_text(const Session& session, const std::string& path, const std::string& port) {
  const auto component = session.component(path.substr(0, path.rfind(':')), {.contexts = true});
  const auto why = !component                                ? component.error().message
                   : component->state() != RTC::ACTIVE_STATE ? component->instance + " is " + state_text(component->state())
                                                             : std::string();
  return "port " + port + ": no sample in " + std::to_string(long_silence.count()) + " s, print waits" + (why.empty() ? "" : "; " + why);
}

struct PrintOptions {
  std::vector<std::string> ports;
  int count = 0;         // 0: until stopped
  double timeout_s = 0;  // 0: none
  double rate = 0;       // at most so many lines a second; 0: all
};

void print_ports(const Session& session, Console& console, const PrintOptions& options) {
  Queue queue;
  std::vector<Session::Port> ports;
  std::vector<CORBA::TypeCode_ptr> types;
  std::vector<std::unique_ptr<Tap>> taps;
  for (const auto& path : options.ports) {
    auto port = session.port(path);
    if (!port) return console.fail(port.error());
    if (port->port.port_type() != "DataOutPort")
      return console.fail({"port " + port->port.full_name + ": is a " + port->port.port_type() + ", print reads OutPorts"});
    types.push_back(type_code_of(port->port.data_type()));
    if (CORBA::is_nil(types.back()))
      return console.fail({"port " + port->port.full_name + ": carries " + port->port.data_type() + ", which rtse does not know"});
    ports.push_back(std::move(*port));
  }
  for (std::size_t i = 0; i < ports.size(); ++i) {
    auto tap = Tap::connect(session.orb(), ports[i].port, {}, [&queue, i](std::span<const unsigned char> payload, bool little_endian) {
      auto content = queue.content.lock();
      if (content->samples.size() >= Queue::longest) {
        content->samples.pop_front();
        ++content->dropped;
      }
      content->samples.push_back({i, {payload.begin(), payload.end()}, little_endian});
      queue.arrived.notify_one();
    });
    if (!tap) return console.fail(tap.error());
    taps.push_back(std::move(*tap));
  }
  std::signal(SIGINT, end_by_user);
  std::signal(SIGTERM, end_by_user);
  const auto end = options.timeout_s > 0
                       ? Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_s))
                       : Clock::time_point::max();
  auto next_line = Clock::now();
  const auto began = next_line;
  std::set<std::size_t> silent;
  for (std::size_t i = 0; i < ports.size(); ++i) silent.insert(i);
  int printed = 0;
  const auto is_over = [] { return ended_by_user.load(std::memory_order_relaxed) || base::output_is_closed() || !std::cout; };
  while (!is_over() && Clock::now() < end && (options.count <= 0 || printed < options.count)) {
    if (!silent.empty() && Clock::now() - began > long_silence) {
      for (const auto i : silent) console.warn(silence_text(session, options.ports[i], ports[i].port.full_name));
      silent.clear();
    }
    Sample sample;
    {
      auto content = queue.content.lock();
      // Wakes now and then to see an interrupt, or that nobody reads any more.
      if (!content.wait_until(queue.arrived, std::min(end, Clock::now() + std::chrono::milliseconds(100)),
                              [&] { return !content->samples.empty(); }))
        continue;
      sample = std::move(content->samples.front());
      content->samples.pop_front();
    }
    silent.erase(sample.port);
    if (options.rate > 0) {
      if (Clock::now() < next_line) continue;
      next_line = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / options.rate));
    }
    const auto value = decode(types[sample.port], sample.payload, sample.little_endian);
    ++printed;
    if (!value) {
      console.fail({"port " + ports[sample.port].port.full_name + ": " + value.error().message});
    } else if (console.json()) {
      std::cout << Json{{"port", ports[sample.port].port.full_name}, {"value", *value}}.dump() << std::endl;
    } else {
      std::cout << (ports.size() > 1 ? ports[sample.port].port.full_name + " " : "") << as_text(*value) << std::endl;
    }
  }
  taps.clear();
  if (const auto dropped = queue.content.lock()->dropped; dropped > 0)
    console.fail({"print: " + std::to_string(dropped) + " samples were dropped: they arrived faster than they could be written"});
  if (options.count > 0 && printed < options.count && !is_over()) {
    console.fail({"print: got " + std::to_string(printed) + " of " + std::to_string(options.count) + " samples in " +
                  base::format_number(options.timeout_s) + " s"});
  }
}

struct InjectOptions {
  std::string port;
  std::vector<std::string> values;
  double rate = 1;  // of repeated values [Hz]
  int count = 1;    // how often the values are sent
};

void inject(const Session& session, Console& console, const InjectOptions& options) {
  auto port = session.port(options.port);
  if (!port) return console.fail(port.error());
  if (port->port.port_type() != "DataInPort")
    return console.fail({"port " + port->port.full_name + ": is a " + port->port.port_type() + ", inject writes to InPorts"});
  const auto type = type_code_of(port->port.data_type());
  if (CORBA::is_nil(type))
    return console.fail({"port " + port->port.full_name + ": carries " + port->port.data_type() + ", which rtse does not know"});
  std::vector<std::vector<unsigned char>> payloads;
  for (const auto& text : options.values) {
    const auto value = parse_value(type, text, base::SystemClock().now().count());
    if (!value) return console.reject({"port " + port->port.full_name + ": " + value.error().message});
    auto payload = encode(type, *value);
    if (!payload) return console.reject({"port " + port->port.full_name + ": " + payload.error().message});
    payloads.push_back(std::move(*payload));
  }
  auto tap = Tap::connect(session.orb(), port->port, {}, {});
  if (!tap) return console.fail(tap.error());
  std::signal(SIGINT, end_by_user);
  const CallLimit limited(session.call_timeout());
  auto next = Clock::now();
  bool is_first = true;
  for (int i = 0; (options.count <= 0 || i < options.count) && !ended_by_user.load(std::memory_order_relaxed); ++i) {
    for (const auto& payload : payloads) {
      if (std::exchange(is_first, false) == false) {
        next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / options.rate));
        std::this_thread::sleep_until(next);
      }
      if (ended_by_user.load(std::memory_order_relaxed)) break;
      const auto sent = (*tap)->put(payload);
      if (!sent) return console.fail({"port " + port->port.full_name + ": " + sent.error().message});
    }
  }
}

}  // namespace

void add_data(base::Command& app, Chosen& chosen) {
  auto* print = app.add_subcommand("print", "Print the samples of OutPorts");
  auto options = std::make_shared<PrintOptions>();
  print->add_option("PORT", options->ports, "OutPorts")->required();
  print->add_option("-n,--count", options->count, "Stop after N samples")->check(base::number_between(0, 1e9));
  print->add_option("-t,--timeout", options->timeout_s, "Stop after N seconds")->check(base::number_between(0.0, 1e9));
  print->add_option("-r,--rate", options->rate, "Maximum number of samples per second")->check(base::number_between(0.0, 1e6));
  print->callback([&chosen, options] {
    chosen.work = [options](const Session& session, Console& console) { tools::print_ports(session, console, *options); };
  });

  auto* inject = app.add_subcommand("inject", "Write values to an InPort");
  auto values = std::make_shared<InjectOptions>();
  inject->add_option("PORT", values->port, "InPort")->required();
  inject->add_option("VALUE", values->values, "JSON, or RTC.TimedLong({time}, 42)")->required();
  inject->add_option("-n,--count", values->count, "Number of samples; 0: until stopped")
      ->check(base::number_between(0, 1e9))
      ->capture_default_str();
  inject->add_option("-r,--rate", values->rate, "Samples per second")->check(base::number_between(1e-3, 1e5))->capture_default_str();
  inject->callback([&chosen, values] {
    chosen.work = [values](const Session& session, Console& console) { tools::inject(session, console, *values); };
  });
}

}  // namespace tools
