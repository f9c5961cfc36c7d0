#include "run/foreign_links.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "base/tick.h"
#include "shm/lockstep.h"
#include "system/remote.h"
#include "system/value_codec.h"

namespace tools {

namespace {

constexpr std::size_t stamp_size = 8;  // [bytes] of an RTC::Time

bool begins_with_stamp(CORBA::TypeCode_ptr type) {
  const auto whole = resolved(type);
  if (whole->kind() != CORBA::tk_struct || whole->member_count() == 0) return false;
  const CORBA::TypeCode_var first = whole->member_type(0);
  const auto member = resolved(first);
  return member->kind() == CORBA::tk_struct && std::string_view(member->id()) == "IDL:RTC/Time:1.0";
}

// The OutPorts that send to another component of others.
std::vector<SavedTarget> ports_between(const SavedSystem& system, const ForeignProcesses& foreign) {
  std::vector<SavedTarget> ports;
  for (const auto& connector : system.connectors) {
    if (!connector.is_data || !foreign.has(connector.source.instance) || !foreign.has(connector.target.instance)) continue;
    const auto is_same = [&](const SavedTarget& one) {
      return one.instance == connector.source.instance && one.port_name == connector.source.port_name;
    };
    if (std::ranges::none_of(ports, is_same)) ports.push_back(connector.source);
  }
  return ports;
}

std::uint32_t phase_of(const ForeignProcesses& foreign, const std::string& instance) {
  const auto member = std::ranges::find(foreign.members(), instance, &TimeMember::instance);
  return member == foreign.members().end() ? 0 : static_cast<std::uint32_t>(member->phase);
}

}  // namespace

Result<std::vector<std::string>> ForeignLinks::listen(CORBA::ORB_ptr orb, const Session& session, const SavedSystem& system,
                                                      const ForeignProcesses& foreign, const std::string& simulator,
                                                      const std::string& log) {
  std::vector<std::string> silent;
  const auto ports = ports_between(system, foreign);
  if (ports.empty()) return silent;
  auto simulation =
      shm::Iface::open(static_cast<std::uint32_t>(base::parse_integer(simulator).value_or(0)), shm::IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  simulation_.emplace(std::move(*simulation));
  if (!log.empty()) {
    auto writer = base::HashLogWriter::create(log);
    if (!writer) return writer.error();
    log_.emplace(std::move(*writer));
  }
  for (const auto& port : ports) {
    if (const auto listening = listen_on(orb, session, foreign, port); !listening) silent.push_back(listening.error().message);
  }
  return silent;
}

Result<void> ForeignLinks::listen_on(CORBA::ORB_ptr orb, const Session& session, const ForeignProcesses& foreign,
                                     const SavedTarget& target) {
  const auto fail = [&](const std::string& why) { return Error{"port " + target.port_name + ": what it sends is not compared: " + why}; };
  const auto component = session.component(target.instance + ".rtc", {.connectors = true});
  if (!component) return fail(component.error().message);
  const auto prefix = target.instance + ".";
  const auto* view = component->port(target.port_name.starts_with(prefix) ? target.port_name.substr(prefix.size()) : target.port_name);
  if (!view) return fail("the component has no such port");
  if (view->port_type() != "DataOutPort") return fail("it is a " + view->port_type());
  const auto type = type_code_of(view->data_type());
  if (CORBA::is_nil(type)) return fail("its type " + view->data_type() + " is not known here, nor where in it a stamp stands");
  const auto name = target.instance + ":" + view->name;
  const base::HashKey key{base::HashKey::Kind::out_port, phase_of(foreign, target.instance), name, view->data_type()};
  Port* port = nullptr;
  {
    const auto mine = turn_.take();
    port = &ports_.emplace_back(Port{name, corba::Shape(type), begins_with_stamp(type), log_ ? log_->key(key) : 0, 0, 0, {}, {}});
  }
  auto tap = Tap::connect(orb, *view, {{"dataport.allow_dup_connection", "YES"}},
                          [this, port](std::span<const unsigned char> payload, bool is_little) { take(*port, payload, is_little); });
  if (!tap) return fail(tap.error().message);
  taps_.push_back(std::move(*tap));
  return {};
}

void ForeignLinks::write() {
  if (std::ranges::all_of(ports_, [](const Port& port) { return port.samples == 0; })) return;
  log_->begin_tick(resets_, time_);
  for (Port& port : ports_) {
    if (port.samples > 0) log_->add(port.key, port.hash, std::as_bytes(std::span(port.value)));
    port.samples = 0;
  }
  log_->end_tick();
}

void ForeignLinks::take(Port& port, std::span<const unsigned char> payload, bool is_little_endian) {
  std::vector<std::byte> octets(payload.size());
  std::ranges::copy(std::as_bytes(payload), octets.begin());
  port.shape.clear_leftovers(octets, is_little_endian ? rt::ByteOrder::little : rt::ByteOrder::big);
  if (port.has_stamp) std::fill_n(octets.begin(), std::min(stamp_size, octets.size()), std::byte{0});
  base::Hash64 hash;
  hash.add(std::uint64_t{octets.size()});
  hash.add(octets);

  const auto mine = turn_.take();
  auto resets = resets_;
  auto now = time_;  // a time that cannot be read is that of the last sample
  if (simulation_->read()) {
    const auto& stamp = simulation_->sample<shm::SimulationSample>().stamp;
    resets = stamp.resets;
    now = std::chrono::nanoseconds(stamp.sim_time_ns);
  }
  const auto phase_counter = shm::phase_counter_of(*simulation_);
  if (phase_counter != 0 && !base::is_in_phase(phase_counter) && !port.between_ticks) port.between_ticks = now;
  if (!log_) return;
  if (resets_ != resets || time_ != now) write();
  resets_ = resets;
  time_ = now;
  port.hash = port.samples++ == 0 ? hash.value() : base::chained(port.hash, hash.value());
  // Values of a log are little-endian.
  port.value.clear();
  if (is_little_endian && octets.size() <= base::longest_hash_value)
    port.value.assign(reinterpret_cast<const char*>(octets.data()), octets.size());
}

std::vector<std::string> ForeignLinks::nondeterministic_events() {
  const auto mine = turn_.take();
  std::vector<std::string> found;
  for (const Port& port : ports_) {
    if (port.between_ticks)
      found.push_back("port " + port.name + " sent between two ticks at " + base::format_number(base::to_seconds(*port.between_ticks)) +
                      " s");
  }
  return found;
}

Result<void> ForeignLinks::end() {
  {
    constexpr std::chrono::seconds for_each{1};
    const CallLimit limited(for_each);
    taps_.clear();
  }
  const auto mine = turn_.take();
  if (!log_) return {};
  write();
  const bool is_whole = log_->finish();
  log_.reset();
  return is_whole ? Result<void>() : Error{"the samples between third-party components could not be written"};
}

}  // namespace tools
