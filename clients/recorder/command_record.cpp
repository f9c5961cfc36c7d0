// record.
#include <fnmatch.h>
#include <poll.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>

#include "base/clock.h"
#include "base/command_line.h"
#include "base/text.h"
#include "command.h"
#include "mcap_sink.h"
#include "port_source.h"
#include "recorder_commands.h"
#include "run/interrupt.h"
#include "run_clock.h"
#include "shm/client.h"

namespace recorder {

namespace {

using editor::Editor;

// How long a port waits for the recorder. In lock step time waits with it, so that nothing is lost; in real time a sample is dropped.
constexpr std::chrono::seconds lockstep_patience{10};
constexpr std::size_t largest_world = 64 << 20;  // [octets] that are attached

struct RecordOptions {
  std::vector<std::string> ports;
  bool all = false;
  std::vector<std::string> excluded;
  std::vector<std::string> attached;  // NAME=FILE
  std::string file;
  double duration_s = 0;  // of the wall clock; 0: until stopped
  std::string compression = "zstd";
  int server_id = static_cast<int>(default_server_id());
  bool quiet = false;
};

bool is_excluded(const RecordOptions& options, const std::string& name) {
  return std::any_of(options.excluded.begin(), options.excluded.end(),
                     [&](const std::string& pattern) { return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

// OutPorts that the command line names, or all there are.
base::Result<std::vector<Editor::Port>> chosen_ports(Editor& editor, const RecordOptions& options) {
  std::vector<Editor::Port> ports;
  if (!options.all) {
    for (const auto& path : options.ports) {
      auto port = editor.port(path, true);
      if (!port) return port.error();
      if (port->port.port_type() != "DataOutPort") {
        return base::Error{"port " + port->port.full_name + ": is a " + port->port.port_type() + ", record reads OutPorts"};
      }
      ports.push_back(std::move(*port));
    }
    return ports;
  }
  const auto tree = editor.tree();
  if (!tree) return tree.error();
  for (const auto& component : editor::read_components(*tree, {.connectors = true}, editor.limit())) {
    if (!component.problem.empty()) editor.fail({"component " + component.instance + ": " + component.problem});
    for (const auto& port : component.ports) {
      if (port.port_type() == "DataOutPort" && !is_excluded(options, component.instance + ":" + port.name))
        ports.push_back({component, port});
    }
  }
  if (ports.empty()) return base::Error{"record: the naming service " + editor.server() + " has no component with an OutPort"};
  return ports;
}

std::string file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  return text.size() > largest_world ? std::string() : text;
}

base::Result<void> attach_files(mcap::Writer& writer, const RecordOptions& options) {
  for (const std::string& one : options.attached) {
    const auto equals = one.find('=');
    const std::string path = one.substr(equals + 1);
    std::ifstream in(path, std::ios::binary);
    if (!in) return base::Error{"attachment " + base::in_quotes(one) + ": cannot be read"};
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    if (const auto done = writer.attach({mcap::Time(0), mcap::Time(0), one.substr(0, equals), "application/octet-stream", text}); !done)
      return done;
  }
  return {};
}

// What makes the run again: the world, its seed, the programs.
void attach_run(mcap::Writer& writer, const RecordOptions& options, const RunClock& clock) {
  mcap::Texts run = {{"clock", clock.is_simulated() ? "simulated" : "wall"}, {"version", RTMSIM_VERSION}};
  auto simulation = shm::Iface::open(static_cast<std::uint32_t>(options.server_id), shm::IfaceType::simulation, "world");
  if (simulation) {
    const auto& info = simulation->info<shm::SimulationInfo>();
    const auto text = [](const auto& field) { return std::string(field, ::strnlen(field, sizeof field)); };
    run["world"] = text(info.world);
    run["world_file"] = text(info.file);
    run["seed"] = std::to_string(info.seed);
    run["step_ns"] = std::to_string(info.step_ns);
    run["lockstep"] = info.lockstep != 0 ? "yes" : "no";
    run["simulator"] = text(info.version);
    const std::string world = file_text(text(info.file));
    if (!world.empty()) (void)writer.attach({mcap::Time(0), mcap::Time(0), "world.sdf", "application/xml", world});
  }
  (void)writer.add_metadata({"run", run});
}

void report(Editor& editor, const RecordOptions& options, const mcap::Writer& writer, const channels::Exchange& exchange) {
  for (const auto& [topic, count] : exchange.dropped()) {
    editor.fail(
        {"record: " + std::to_string(count) + " samples of " + topic + " were dropped, they came faster than they could be written"});
  }
  if (!options.quiet) {
    std::cerr << "recorded " << writer.statistics().messages << " samples of " << writer.statistics().channels << " channels in "
              << base::in_quotes(options.file) << '\n';
  }
}

void wait_for_end(const RecordOptions& options, const channels::Exchange& exchange) {
  const auto start = std::chrono::steady_clock::now();
  const auto is_over = [&] {
    return options.duration_s > 0 && std::chrono::steady_clock::now() - start >= std::chrono::duration<double>(options.duration_s);
  };
  while (!editor::is_interrupted() && !exchange.failure() && !is_over()) {
    pollfd handle{editor::interrupt_handle(), POLLIN, 0};
    double wait_ms = 200;  // a sink's failure announces itself to nobody
    if (options.duration_s > 0) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      wait_ms = std::clamp((options.duration_s - passed.count()) * 1000 + 1, 0.0, wait_ms);
    }
    (void)::poll(&handle, 1, static_cast<int>(wait_ms));
  }
}

void record(Editor& editor, const RecordOptions& options) {
  const auto ports = chosen_ports(editor, options);
  if (!ports) return editor.fail(ports.error());
  const RunClock clock(static_cast<std::uint32_t>(options.server_id));
  const auto compression = options.compression == "zstd"  ? mcap::Compression::zstd
                           : options.compression == "lz4" ? mcap::Compression::lz4
                                                          : mcap::Compression::none;
  auto writer = mcap::Writer::create(options.file, {.profile = "", .compression = compression});
  if (!writer) return editor.fail(writer.error());
  attach_run(*writer, options, clock);
  if (const auto attached = attach_files(*writer, options); !attached) return editor.fail(attached.error());
  const auto sink = std::make_shared<McapSink>(std::move(*writer));
  editor::catch_interrupts();
  {
    channels::Exchange exchange;
    exchange.attach(sink, {.patience = clock.is_lockstep() ? lockstep_patience : std::chrono::seconds(0)});
    {
      PortSource source(editor.orb(), exchange, clock);
      for (const auto& [component, port] : *ports) {
        if (const auto added = source.add(component, port); !added) editor.fail(added.error());
      }
      if (source.size() == 0) return;
      if (!options.quiet)
        std::cerr << "recording " << source.size() << " ports into " << base::in_quotes(options.file) << "; Ctrl-C ends it\n";
      wait_for_end(options, exchange);
    }
    if (!exchange.drain(std::chrono::seconds(30))) editor.fail({"record: the file took no more samples for 30 s; the last ones are lost"});
    if (const auto failure = exchange.failure()) editor.fail(*failure);
    report(editor, options, sink->writer(), exchange);
  }
  if (const auto closed = sink->writer().close(); !closed) editor.fail(closed.error());
}

}  // namespace

void add_record(CLI::App& app, editor::Chosen& chosen) {
  auto* command = app.add_subcommand("record", "Record what ports send into an MCAP file");
  auto options = std::make_shared<RecordOptions>();
  command->add_option("PORT", options->ports, "OutPorts");
  command->add_flag("--all", options->all, "All OutPorts of the naming service");
  command->add_option("--exclude", options->excluded, "With --all: not the ports that the pattern fits, e.g. 'RTCCamera*:*'");
  command->add_option("--attach", options->attached, "NAME=FILE: a file that the recording is to hold, too")
      ->check([](const std::string& text) { return text.find('=') == std::string::npos ? "expected NAME=FILE" : ""; });
  command->add_option("-o,--output", options->file, "The file to write")->required();
  command->add_option("-t,--duration", options->duration_s, "End after so many seconds of real time")
      ->check(base::number_between(0.0, 1e9));
  command->add_option("--compression", options->compression, "zstd, lz4 or none")
      ->check(CLI::IsMember({"zstd", "lz4", "none"}))
      ->capture_default_str();
  command->add_option("-s,--server-id", options->server_id, "The simulator whose time counts; default: $RTMSIM_SERVER_ID, else 0")
      ->check(base::number_between(0, 9999));
  command->add_flag("-q,--quiet", options->quiet, "Say nothing but errors");
  command->callback([&chosen, options] {
    editor::require(options->all != !options->ports.empty(), "record", "name OutPorts, or --all");
    chosen.work = [options](Editor& editor) { record(editor, *options); };
  });
}

}  // namespace recorder
