#include "run/foreign_links.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "base/tick.h"
#include "shm/lockstep.h"
#include "value_codec.h"

namespace editor {

namespace {

constexpr std::size_t stamp_size = 8;  // [octets] of an RTC::Time

bool begins_with_stamp(CORBA::TypeCode_ptr type) {
  const auto whole = resolved(type);
  if (whole->kind() != CORBA::tk_struct || whole->member_count() == 0) return false;
  const CORBA::TypeCode_var first = whole->member_type(0);
  const auto member = resolved(first);
  return member->kind() == CORBA::tk_struct && std::string_view(member->id()) == "IDL:RTC/Time:1.0";
}

Result<std::optional<base::HashLogWriter>> begin_log(const std::string& file) {
  auto log = base::HashLogWriter::create(file);
  if (!log) return log.error();
  return std::optional(std::move(*log));
}

// "Alien.out" as people write it.
std::string colon_name(std::string name) {
  if (const auto dot = name.rfind('.'); dot != std::string::npos) name[dot] = ':';
  return name;
}

// The OutPorts that send to another component of others.
std::vector<std::string> ports_between(const SavedSystem& system, const ForeignProcesses& foreign) {
  std::vector<std::string> names;
  for (const auto& connector : system.connectors) {
    if (!connector.is_data || !foreign.has(connector.source.instance) || !foreign.has(connector.target.instance)) continue;
    const auto name = colon_name(connector.source.port_name);
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::uint32_t phase_of(const ForeignProcesses& foreign, const std::string& instance) {
  const auto member = std::ranges::find(foreign.members(), instance, &TimeMember::instance);
  return member == foreign.members().end() ? 0 : static_cast<std::uint32_t>(member->phase);
}

}  // namespace

Result<std::vector<std::string>> ForeignLinks::listen(CORBA::ORB_ptr orb, const Editor& editor, const SavedSystem& system,
                                                      const ForeignProcesses& foreign, const std::string& simulator,
                                                      const std::string& log) {
  std::vector<std::string> silent;
  const auto names = ports_between(system, foreign);
  if (names.empty()) return silent;
  auto simulation =
      shm::Iface::open(static_cast<std::uint32_t>(base::parse_integer(simulator).value_or(0)), shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  auto writer = log.empty() ? Result<std::optional<base::HashLogWriter>>(std::nullopt) : begin_log(log);
  if (!writer) return writer.error();
  {
    auto data = data_.lock();
    data->simulation.emplace(std::move(*simulation));
    data->log = std::move(*writer);
  }
  for (const auto& name : names) {
    if (const auto listening = listen_on(orb, editor, foreign, name); !listening) silent.push_back(listening.error().message);
  }
  return silent;
}

Result<void> ForeignLinks::listen_on(CORBA::ORB_ptr orb, const Editor& editor, const ForeignProcesses& foreign, const std::string& name) {
  const auto port = editor.port(name);
  if (!port) return port.error();
  const auto type_name = port->port.data_type();
  const auto type = type_code_of(type_name);
  // Where its stamp stands nobody knows.
  if (CORBA::is_nil(type)) return Error{"port " + name + ": what it sends is not compared, as nobody here knows its type " + type_name};
  std::size_t place = 0;
  {
    auto data = data_.lock();
    place = data->ports.size();
    auto& one = data->ports.emplace_back();
    one.name = name;
    one.has_stamp = begins_with_stamp(type);
    if (data->log) one.key = data->log->key({base::HashKey::Kind::out_port, phase_of(foreign, port->component.instance), name, type_name});
  }
  auto tap = Tap::connect(orb, port->port, {{"dataport.allow_dup_connection", "YES"}},
                          [this, place](std::span<const unsigned char> payload, bool little) { take(place, payload, little); });
  if (!tap) return Error{"port " + name + ": what it sends is not compared: " + tap.error().message};
  taps_.push_back(std::move(*tap));
  return {};
}

void ForeignLinks::write(Data& data) {
  if (!data.log) return;
  const bool is_empty = std::ranges::all_of(data.ports, [](const Port& port) { return port.samples == 0; });
  if (is_empty) return;
  data.log->begin_tick(data.resets, data.time);
  for (Port& port : data.ports) {
    if (port.samples > 0) data.log->add(port.key, port.hash, std::as_bytes(std::span(port.value)));
    port.samples = 0;
  }
  data.log->end_tick();
}

void ForeignLinks::take(std::size_t place, std::span<const unsigned char> payload, bool is_little_endian) {
  auto data = data_.lock();
  if (!data->simulation || !data->simulation->read()) return;
  const auto& sample = data->simulation->sample<shm::SimulationSample>();
  const std::chrono::nanoseconds now(sample.stamp.sim_time_ns);
  Port& port = data->ports[place];
  const bool is_standing = sample.paused != 0 || sample.waiting_for != 0;
  if (!is_standing && !port.between_ticks && !base::is_in_phase(shm::moment_of(*data->simulation))) port.between_ticks = now;
  if (!data->log) return;
  if (data->resets != sample.stamp.resets || data->time != now) {
    write(*data);
    data->resets = sample.stamp.resets;
    data->time = now;
  }
  std::string octets(payload.begin(), payload.end());
  if (port.has_stamp) std::fill_n(octets.begin(), std::min(stamp_size, octets.size()), '\0');
  base::Hash64 hash;
  hash.add(std::uint64_t{octets.size()});
  hash.add(octets);
  port.hash = port.samples++ == 0 ? hash.value() : base::chained(port.hash, hash.value());
  // Values of a log are little-endian.
  const bool is_kept = is_little_endian && octets.size() <= base::longest_hash_value;
  port.value = is_kept ? std::move(octets) : std::string();
}

std::vector<std::string> ForeignLinks::chances(const PlacesInTime& places) const {
  std::vector<std::string> found;
  for (const Port& port : data_.lock()->ports) {
    if (!port.between_ticks) continue;
    const auto what =
        "port " + port.name + " sent between two ticks at " + base::format_number(base::to_seconds(*port.between_ticks)) + " s";
    found.push_back(with_tick(what, places));
  }
  return found;
}

void ForeignLinks::end() {
  taps_.clear();
  auto data = data_.lock();
  write(*data);
  if (data->log) data->log->finish();  // a full disk is told by who reads it
  data->log.reset();
}

}  // namespace editor
