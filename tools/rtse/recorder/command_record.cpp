// record.
#include <fcntl.h>
#include <fnmatch.h>
#include <omnithread.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include "base/clock.h"
#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/output_name.h"
#include "base/text.h"
#include "channels/views/world_source.h"
#include "recording/component_source.h"
#include "recording/hash_channel.h"
#include "recording/mcap/file.h"
#include "recording/mcap_sink.h"
#include "recording/port_source.h"
#include "recording/recorder_line.h"
#include "recording/ring.h"
#include "recording/run_clock.h"
#include "recording/sample_filters.h"
#include "rtse/command.h"
#include "rtse/recorder/attachments.h"
#include "rtse/recorder/recorder_commands.h"
#include "shm/client.h"
#include "shm/lockstep.h"
#include "system/remote.h"

namespace recorder {

namespace {

using tools::Console;
using tools::Session;

// How long a port waits for the recorder. In lock step time waits with it, so that nothing is lost; in real time a sample is dropped.
constexpr std::chrono::seconds lockstep_timeout{10};
constexpr std::chrono::seconds hashes_limit{60};

struct RecordOptions {
  std::vector<std::string> ports;
  bool all = false;
  bool views = false;       // of the simulator, too
  bool components = false;  // what they say of themselves, too
  bool only_ports = false;  // with `all`: no views, and nothing of components but their ports
  bool raw_pictures = false;
  std::vector<std::string> excluded;
  std::vector<std::string> attached;  // NAME=FILE
  std::vector<std::string> notes;     // KEY=VALUE
  std::string file;
  double duration_s = 0;  // of the wall clock; 0: until stopped
  Split split;
  double rate = 0;    // [Hz] of each channel at most; 0: all
  double last_s = 0;  // only so much before the end; 0: all
  bool until_error = false;
  std::string hashes;       // hash log of the run that controls this recorder
  bool controlled = false;  // standard input is the line to that run, see recording/recorder_line.h
  std::string compression = "zstd";
  int server_id = static_cast<int>(default_server_id());
  bool quiet = false;
};

// Readable when there is a reason to end. Any thread.
class EndHandle {
 public:
  EndHandle() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  ~EndHandle() { ::close(descriptor_); }
  EndHandle(const EndHandle&) = delete;
  EndHandle& operator=(const EndHandle&) = delete;
  int descriptor() const { return descriptor_; }
  bool is_raised() const { return is_raised_.load(std::memory_order_relaxed); }
  void raise() {
    is_raised_.store(true, std::memory_order_relaxed);
    (void)::eventfd_write(descriptor_, 1);
  }

 private:
  const int descriptor_;
  std::atomic<bool> is_raised_{false};  // relaxed: says nothing but itself
};

bool is_excluded(const RecordOptions& options, const std::string& name) {
  return std::any_of(options.excluded.begin(), options.excluded.end(),
                     [&](const std::string& pattern) { return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

std::chrono::nanoseconds nanoseconds(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

// OutPorts that the command line names, or all there are.
base::Result<std::vector<Session::Port>> chosen_ports(const Session& session, Console& console, const RecordOptions& options) {
  std::vector<Session::Port> ports;
  std::size_t excluded = 0;
  if (!options.all) {
    for (const auto& path : options.ports) {
      auto port = session.port(path, true);
      if (!port) return port.error();
      if (port->port.port_type() != "DataOutPort") {
        return base::Error{"port " + port->port.full_name + ": is a " + port->port.port_type() + ", record reads OutPorts"};
      }
      ports.push_back(std::move(*port));
    }
    return ports;
  }
  const auto tree = session.tree();
  if (!tree) return tree.error();
  for (const auto& component : tools::read_components(*tree, {.connectors = true}, session.call_timeout())) {
    if (!component.problem.empty()) console.fail({"component " + component.instance + ": " + component.problem});
    for (const auto& port : component.ports) {
      if (port.port_type() != "DataOutPort") continue;
      if (is_excluded(options, component.instance + ":" + port.name))
        ++excluded;
      else
        ports.push_back({component, port});
    }
  }
  if (ports.empty() && excluded > 0)
    return base::Error{"record: --exclude leaves none of the " + std::to_string(excluded) + " OutPorts of the name server " +
                       session.server()};
  if (ports.empty()) return base::Error{"record: the name server " + session.server() + " has no component with an OutPort"};
  return ports;
}

// Those whose ports are recorded, or all.
std::vector<tools::ComponentView> chosen_components(const Session& session, const RecordOptions& options,
                                                    const std::vector<Session::Port>& ports) {
  if (!options.components && !options.until_error && (!options.all || options.only_ports)) return {};
  std::vector<tools::ComponentView> chosen;
  const auto tree = session.tree();
  if (!tree) return chosen;
  for (auto& component : tools::read_components(*tree, {.contexts = true, .configuration = true}, session.call_timeout())) {
    const bool is_meant = options.all || std::ranges::any_of(ports, [&](const auto& one) { return one.component.path == component.path; });
    if (is_meant && component.problem.empty()) chosen.push_back(std::move(component));
  }
  return chosen;
}

// Of the components that take part in the lock step: with its phase a sample can be sent again in its place.
std::map<std::string, std::map<std::string, std::string>> lockstep_facts(const RecordOptions& options) {
  std::map<std::string, std::map<std::string, std::string>> facts;
  auto simulation = shm::Iface::open(static_cast<std::uint32_t>(options.server_id), shm::IfaceType::simulation, "world");
  if (!simulation) return facts;
  if (const auto there = shm::read_participants(*simulation)) {
    for (const auto& one : *there) facts[one.name] = {{"phase", std::to_string(one.phase)}, {"period_ns", std::to_string(one.period_ns)}};
  }
  return facts;
}

// Components that were killed and are there again go on in their channels. Who is not there need not be.
void look_again(const Session& session, Console& console, PortSource& source, ComponentSource& components) {
  if (const auto tree = session.tree()) {
    const tools::Detail all{.contexts = true, .connectors = true, .configuration = true};
    for (const auto& component : tools::read_components(*tree, all, session.call_timeout())) {
      if (!component.problem.empty()) continue;
      for (const auto& port : component.ports) {
        if (const auto done = source.connect_again(component, port); !done) console.fail(done.error());
      }
      components.attach_again(component);
    }
  }
}

// What a run tells its recorder; without one nothing ever comes.
class Orders {
 public:
  explicit Orders(bool controlled) {
    if (controlled) line_.emplace(base::FileHandle(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)));
  }
  int descriptor() const { return line_ ? line_->descriptor() : -1; }
  // A run that has exited hears nothing, and needs not.
  void tell(RecorderMessage message) {
    if (line_) static_cast<void>(line_->send(message));
  }
  // The next one; a line that is closed is a stop.
  std::optional<RecorderMessage> next(std::chrono::milliseconds timeout) {
    if (!line_) return std::nullopt;
    const auto received = line_->receive(timeout);
    is_closed_ = !received;
    return received ? *received : std::optional(RecorderMessage::stop);
  }
  bool is_closed() const { return is_closed_; }

 private:
  std::optional<RecorderLine> line_;
  bool is_closed_ = false;
};

// An interrupt, the end of the time that was asked for, or a file that takes no more: which announces itself here.
void wait_for_end(const RecordOptions& options, channels::Exchange& exchange, const std::shared_ptr<EndHandle>& handle, Orders& orders,
                  const std::function<void()>& look) {
  exchange.on_failure([handle] { handle->raise(); });
  const auto start = std::chrono::steady_clock::now();
  while (!base::is_interrupted() && !exchange.failure() && !handle->is_raised()) {
    int wait_ms = -1;
    if (options.duration_s > 0) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      if (passed.count() >= options.duration_s) return;
      wait_ms = static_cast<int>(std::clamp((options.duration_s - passed.count()) * 1000 + 1, 0.0, 1e9));
    }
    pollfd handles[3] = {{base::interrupt_handle(), POLLIN, 0}, {handle->descriptor(), POLLIN, 0}, {orders.descriptor(), POLLIN, 0}};
    (void)::poll(handles, 3, wait_ms);
    const auto order = orders.next(std::chrono::milliseconds(0));
    if (order == RecorderMessage::stop) return;
    if (order != RecorderMessage::look_again) continue;
    look();
    orders.tell(RecorderMessage::looked);
  }
}

// The views of the simulator; nothing when none are wanted, or there is no simulator and nobody named them.
base::Result<std::unique_ptr<channels::WorldSource>> open_views(channels::Exchange& exchange, const RecordOptions& options,
                                                                const RunClock& clock, std::function<void(channels::Time)> each_second,
                                                                const std::shared_ptr<EndHandle>& end) {
  if (!options.views && (!options.all || options.only_ports || !clock.is_simulated())) return std::unique_ptr<channels::WorldSource>();
  return channels::WorldSource::open(exchange, {.server_id = static_cast<std::uint32_t>(options.server_id),
                                                .pictures = options.raw_pictures ? channels::Pictures::raw : channels::Pictures::jpeg,
                                                .wants_all = true,
                                                .excluded = options.excluded,
                                                .each_second = std::move(each_second),
                                                .gone = [end] { end->raise(); }});
}

// A file with what makes the run again.
base::Result<mcap::Writer> new_file(const std::string& path, const RecordOptions& options, const RunClock& clock) {
  const auto compression = options.compression == "zstd"  ? mcap::Compression::zstd
                           : options.compression == "lz4" ? mcap::Compression::lz4
                                                          : mcap::Compression::none;
  auto writer = mcap::Writer::create(path, {.profile = "", .compression = compression});
  if (!writer) return writer.error();
  attach_run(*writer, {static_cast<std::uint32_t>(options.server_id), clock.is_simulated(), options.notes});
  if (const auto attached = attach_files(*writer, options.attached); !attached) return attached.error();
  return writer;
}

// What is wanted of what comes, on its way into the file.
struct Sinks {
  std::shared_ptr<McapSink> file;
  std::shared_ptr<channels::Sink> first;
};

// A ring keeps nothing of the one before it, as every file that is written anew.
base::Result<std::vector<RingSegment>> make_room_for_ring(const std::string& file) {
  if (const auto good = mcap::File::check_name(file); !good) return good.error();
  if (mcap::File::is_being_written(file)) return base::Error{base::in_quotes(file) + ": is being written by another process"};
  auto stale = ring_segments(file);
  if (const auto at_rest = check_not_recording(stale); !at_rest) return at_rest.error();
  if (const auto free = check_names(file); !free) return free.error();
  remove_ring_segments(stale);
  remove_empty_segments(file);
  std::remove(file.c_str());
  return stale;
}

base::Result<Sinks> open_sinks(const RecordOptions& options, const RunClock& clock) {
  Split split = options.split;
  if (options.last_s > 0) split = {.time = nanoseconds(options.last_s), .is_ring = true, .compression = options.compression};
  auto file = McapSink::create(options.file, split, [&](const std::string& path) { return new_file(path, options, clock); });
  if (!file) return file.error();
  Sinks sinks{*file, *file};
  if (options.rate > 0) sinks.first = std::make_shared<RateSink>(sinks.first, options.rate);
  return sinks;
}

// From all sources into the sink, until it is to end. False when there is nothing to record.
bool record_into(const Session& session, Console& console, const RecordOptions& options, const RunClock& clock,
                 const std::vector<Session::Port>& ports, channels::Exchange& exchange, const std::vector<RingSegment>& stale,
                 Orders& orders) {
  const auto end = std::make_shared<EndHandle>();
  PortSource source(session.orb(), exchange, clock);
  ComponentSource components(session.orb(), exchange, clock);
  auto facts = lockstep_facts(options);
  for (const auto& [component, port] : ports) {
    if (base::is_interrupted()) return false;
    if (const auto added = source.add(component, port, facts[component.instance]); !added) console.fail(added.error());
  }
  if (options.until_error) {
    components.on_event([end](const std::string&, const ComponentEvent& event) {
      if (event.kind == "RTC_STATUS" && event.event.starts_with("ERROR:")) end->raise();
    });
  }
  for (const auto& component : chosen_components(session, options, ports)) {
    if (base::is_interrupted()) return false;
    if (const auto added = components.add(component); !added) console.fail(added.error());
  }
  // On the thread of the views, which end before the others.
  const auto diagnose = [&](channels::Time now) {
    const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
    const tools::CallLimit limited(session.call_timeout());
    components.diagnose(now, source);
  };
  const auto views =
      open_views(exchange, options, clock, components.size() > 0 ? std::function<void(channels::Time)>(diagnose) : nullptr, end);
  if (!views) {
    console.fail(views.error());
    return false;
  }
  if (source.size() == 0 && components.size() == 0 && !*views) return false;
  if (!options.quiet)
    std::cerr << "recording " << source.size() << " ports" << (*views ? " and the simulator" : "") << " into "
              << base::in_quotes(options.file) << "; Ctrl-C ends it\n";
  if (!stale.empty() && !options.quiet) console.warn(segment_names(stale) + ": of an earlier ring that was not put together, replaced");
  orders.tell(RecorderMessage::recording);
  wait_for_end(options, exchange, end, orders, [&] { look_again(session, console, source, components); });
  if (exchange.failure() || !end->is_raised()) return true;
  if (*views && !(*views)->is_live())
    console.fail({"record: the simulator has ended, and the recording with it"});
  else if (!options.quiet)
    std::cerr << "a component is in its error state\n";
  return true;
}

// Who made the run says when its hash log is there.
base::Result<void> keep_hashes(channels::Exchange& exchange, const std::string& file, Orders& orders) {
  (void)exchange.drain(lockstep_timeout);
  orders.tell(RecorderMessage::stopped);
  const auto deadline = std::chrono::steady_clock::now() + hashes_limit;
  std::optional<RecorderMessage> order;
  // A recorder that has stopped by itself is told to stop all the same.
  while (order != RecorderMessage::hashes_ready && !orders.is_closed() && std::chrono::steady_clock::now() < deadline)
    order = orders.next(std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()));
  if (order != RecorderMessage::hashes_ready)
    return base::Error{"record: the hash log " + base::in_quotes(file) + " was not reported complete"};
  return put_hashes(exchange, file);
}

// The names of the files that a split made, and are there.
std::string files_of(const RecordOptions& options, const McapSink& sink) {
  if (options.split.is_one()) return base::in_quotes(options.file);
  const std::string first = base::in_quotes(numbered_path(options.file, 1));
  return sink.files() == 1 ? first : first + " to " + base::in_quotes(numbered_path(options.file, sink.files()));
}

void report(const RecordOptions& options, std::uint64_t samples, std::uint32_t channels, const std::string& files) {
  if (!options.quiet) std::cerr << "recorded " << samples << " samples of " << channels << " channels in " << files << '\n';
}

// The end of a file that was written to the end, or why it was not.
void finish_file(Console& console, const RecordOptions& options, const McapSink& sink, const base::Result<void>& written) {
  if (!written) return console.fail({written.error().message + "; earlier samples are in it"});
  report(options, sink.samples(), sink.channels(), files_of(options, sink));
}

// What is in the segments stays there until it is in the file.
void finish_ring(Console& console, const RecordOptions& options, const base::Result<void>& written) {
  const auto segments = ring_segments(options.file);
  const auto fail = [&](const base::Error& error) {
    console.fail({error.message + "; " +
                  (segments.empty() ? "nothing was recorded"
                                    : "earlier samples are in " + segment_names(segments) + ", rtse recording repair " + options.file +
                                          " puts it together")});
  };
  if (!written) return fail(written.error());
  const auto joined = merge_ring(segments, options.file, options.file);
  if (!joined) return fail(joined.error());
  for (const auto& line : joined->losses) console.fail({line});
  if (joined->losses.empty()) remove_ring_segments(segments);
  report(options, joined->samples, joined->channels, base::in_quotes(options.file));
}

void record(const Session& session, Console& console, const RecordOptions& options) {
  const RunClock clock(static_cast<std::uint32_t>(options.server_id));
  const auto ports = chosen_ports(session, console, options);
  if (!ports) return console.fail(ports.error());
  // Before the file is made: one that was there before stays.
  if (options.views && !clock.is_simulated()) {
    const auto simulation = shm::Iface::open(static_cast<std::uint32_t>(options.server_id), shm::IfaceType::simulation, "world");
    if (!simulation) return console.fail(simulation.error());
  }
  const bool is_ring = options.last_s > 0;
  if (const auto free = check_no_live_ring(options.file); !free) return console.fail(free.error());
  const auto stale = is_ring ? make_room_for_ring(options.file) : std::vector<RingSegment>();
  if (!stale) return console.fail(stale.error());
  auto sinks = open_sinks(options, clock);
  if (!sinks) return console.fail(sinks.error());
  base::catch_interrupts();
  Orders orders(options.controlled);
  base::Result<void> written;
  {
    channels::Exchange exchange;
    exchange.attach(sinks->first, {.timeout = clock.is_lockstep() ? lockstep_timeout : std::chrono::seconds(0)});
    if (!record_into(session, console, options, clock, *ports, exchange, *stale, orders)) {
      if (is_ring) remove_ring_segments(ring_segments(options.file));
      return;
    }
    if (!options.hashes.empty()) {
      if (const auto kept = keep_hashes(exchange, options.hashes, orders); !kept) console.fail(kept.error());
    }
    if (!exchange.drain(std::chrono::seconds(30))) console.fail({"record: the file took no more samples for 30 s; the last ones are lost"});
    if (const auto failure = exchange.failure()) written = *failure;
    for (const auto& [topic, count] : written ? exchange.dropped() : decltype(exchange.dropped())()) {
      console.fail(
          {"record: " + std::to_string(count) + " samples of " + topic + " were dropped: they arrived faster than they could be written"});
    }
  }
  if (const auto closed = sinks->file->close(); !closed && written) written = closed;
  if (is_ring)
    finish_ring(console, options, written);
  else
    finish_file(console, options, *sinks->file, written);
}

}  // namespace

void add_record(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("record", "Record the samples of ports into an MCAP file");
  auto options = std::make_shared<RecordOptions>();
  command->add_option("PORT", options->ports, "OutPorts to record");
  command->add_flag("--all", options->all, "Record all OutPorts of the name server");
  command->add_flag("--views", options->views,
                    "Also record the simulator's view: poses, sensors, cameras, as ROS 2 messages (implied by --all)");
  command->add_flag("--components", options->components,
                    "Also record states, configuration, events and logs of components (implied by --all)");
  command->add_flag("--only-ports", options->only_ports, "With --all: record ports only")->needs("--all");
  command->add_flag("--raw-pictures", options->raw_pictures, "Record camera images uncompressed (default: JPEG)");
  command->add_option("--exclude", options->excluded, "Leave out the ports and topics that match, e.g. 'RTCCamera*:*', '/sim/camera/*'");
  command->add_option("--attach", options->attached, "Attach a file to the recording: NAME=FILE")->check(attachment_problem);
  command->add_option("--note", options->notes, "Add KEY=VALUE to the metadata of the recording")
      ->allow_extra_args(false)
      ->check([](const std::string& text) { return text.find('=') == std::string::npos ? "expected KEY=VALUE" : ""; });
  command->add_option("-o,--output", options->file, "Output file")->required()->check(base::output_name());
  command->add_option("-t,--duration", options->duration_s, "Stop after this time [wall-clock s]")->seconds_between(0.0, 1e9);
  auto split = std::make_shared<std::string>();
  auto* splitting = command->add_option("--split", *split, "Start a new file after this size (500M) or duration (10m)")
                        ->check([](const std::string& text) {
                          const auto parsed = parse_split(text);
                          return parsed ? std::string() : parsed.error().message;
                        });
  command->add_option("--rate", options->rate, "Maximum number of samples per channel and second")->check(base::number_between(1e-3, 1e6));
  command->add_option("--last", options->last_s, "Keep only the last N seconds")->seconds_between(0.1, 1e6)->excludes(splitting);
  command->add_flag("--until-error", options->until_error, "Stop when a component goes to the ERROR state");
  command->add_flag("--controlled", options->controlled)->group("");                   // of rtse run alone
  command->add_option("--hashes", options->hashes)->group("")->needs("--controlled");  // the same
  command->add_option("--compression", options->compression, "Compression: zstd, lz4 or none")
      ->check(base::one_of({"zstd", "lz4", "none"}))
      ->capture_default_str();
  command->add_option("-s,--server-id", options->server_id, "Simulator ID, for the time (default: $RTMSIM_SERVER_ID, else 0)")
      ->check(base::number_between(0, 9999));
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->callback([&chosen, options, split] {
    if (!split->empty()) options->split = *parse_split(*split);
    tools::require(options->all ? options->ports.empty() : options->views || !options->ports.empty(), "record",
                   "name OutPorts, or --all, or --views");
    chosen.work = [options](const Session& session, Console& console) { record(session, console, *options); };
  });
}

}  // namespace recorder
