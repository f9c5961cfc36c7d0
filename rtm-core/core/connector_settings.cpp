#include "core/connector_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace rt {
namespace {

constexpr std::size_t longest_buffer = 1 << 20;
constexpr double longest_timeout = 1e6;    // [s]
constexpr double fastest_push_rate = 1e6;  // [Hz]

template <class Value>
using Words = std::initializer_list<std::pair<std::string_view, Value>>;

// The values of one side over those of both.
class Reader {
 public:
  Reader(const KeyValues& properties, Side side, ConnectorSettingsOutcome& outcome)
      : properties_(properties), own_(side == Side::in ? "dataport.inport." : "dataport.outport."), outcome_(outcome) {}

  std::string_view text(std::string_view key) const {
    for (const std::string_view prefix : {std::string_view(own_), std::string_view("dataport.")}) {
      const auto it = properties_.find(std::string(prefix) + std::string(key));
      if (it != properties_.end() && !base::trim(it->second).empty()) return base::trim(it->second);
    }
    return {};
  }

  template <class Value>
  void word(std::string_view key, Value& value, Words<Value> words) const {
    const auto given = text(key);
    if (given.empty()) return;
    for (const auto& [name, meaning] : words) {
      if (base::equal_ignoring_case(name, given)) {
        value = meaning;
        return;
      }
    }
    std::string expected;
    for (const auto& [name, meaning] : words) expected += (expected.empty() ? "" : ", ") + std::string(name);
    warn(key, given, "one of " + expected);
  }

  void timeout(std::string_view key, std::chrono::nanoseconds& value) const {
    const auto given = text(key);
    if (given.empty()) return;
    const auto seconds = base::parse_number(given);
    if (!seconds || *seconds < 0) return warn(key, given, "seconds, not negative");
    value = std::chrono::nanoseconds(std::llround(std::min(*seconds, longest_timeout) * 1e9));
  }

  void count(std::string_view key, std::size_t& value, std::size_t min, std::size_t max) const {
    const auto given = text(key);
    if (given.empty()) return;
    const auto number = base::parse_integer(given);
    if (!number || *number < static_cast<std::int64_t>(min)) return warn(key, given, "an integer from " + std::to_string(min));
    value = std::min(static_cast<std::size_t>(*number), max);
  }

  void flag(std::string_view key, bool& value) const {
    const auto given = text(key);
    if (given.empty()) return;
    if (const auto is_set = base::parse_bool(given)) {
      value = *is_set;
    } else {
      warn(key, given, "YES or NO");
    }
  }

  void refuse(ReturnCode code, std::string_view key, std::string_view expected) const {
    if (outcome_.refusal.code != ReturnCode::ok) return;
    outcome_.refusal = {code, "dataport." + std::string(key) + " must be " + std::string(expected) + ", got " + base::in_quotes(text(key))};
  }

  void warn(std::string_view key, std::string_view given, std::string_view expected) const {
    outcome_.warnings.push_back("dataport." + std::string(key) + " must be " + std::string(expected) + ", got " + base::in_quotes(given));
  }

 private:
  const KeyValues& properties_;
  std::string own_;
  ConnectorSettingsOutcome& outcome_;
};

std::string without_blanks(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c != ' ' && c != '\t') result += c;
  }
  return result;
}

void read_transport(const Reader& reader, const std::vector<std::string>& foreign, ConnectorSettings& settings) {
  const auto dataflow = base::to_lower(without_blanks(reader.text("dataflow_type")));
  if (dataflow == "push") {
    settings.dataflow = Dataflow::push;
  } else if (dataflow == "pull") {
    settings.dataflow = Dataflow::pull;
  } else {
    reader.refuse(ReturnCode::bad_parameter, "dataflow_type", "push or pull");
  }

  constexpr std::array interfaces = {
      std::pair{std::string_view("corba_cdr"), Interface::corba_cdr}, std::pair{std::string_view("data_service"), Interface::data_service},
      std::pair{std::string_view("shared_memory"), Interface::shared_memory}, std::pair{std::string_view("direct"), Interface::direct}};
  const std::string_view interface = reader.text("interface_type");
  if (const auto it = std::ranges::find(interfaces, interface, [](const auto& entry) { return entry.first; }); it != interfaces.end()) {
    settings.interface = it->second;
  } else if (std::ranges::find(foreign, interface) != foreign.end()) {
    settings.interface = Interface::foreign;
    settings.foreign_interface = interface;
  } else {
    std::string expected = "corba_cdr, data_service, shared_memory";
    for (const std::string& name : foreign) expected += ", " + name;
    reader.refuse(ReturnCode::bad_parameter, "interface_type", expected + " or direct");
  }

  if (const auto marshaling = reader.text("marshaling_type"); !marshaling.empty()) settings.marshaling = marshaling;

  if (const auto buffer = reader.text("buffer_type"); !buffer.empty() && buffer != "ring_buffer") {
    reader.refuse(ReturnCode::error, "buffer_type", "ring_buffer, the only one there is");
  }

  const auto orders = base::split_list(base::to_lower(reader.text("serializer.cdr.endian")));
  if (orders.empty() || orders.front() == "little") {
    settings.order = ByteOrder::little;
  } else if (orders.front() == "big") {
    settings.order = ByteOrder::big;
  } else {
    reader.refuse(ReturnCode::unsupported, "serializer.cdr.endian", "a list of little and big");
  }
}

void read_subscription(const Reader& reader, ConnectorSettings& settings) {
  const auto words = {std::pair{std::string_view("flush"), Subscription::flush}, std::pair{std::string_view("new"), Subscription::newest},
                      std::pair{std::string_view("periodic"), Subscription::periodic},
                      std::pair{std::string_view("block"), Subscription::flush},
                      std::pair{std::string_view("nonblock"), Subscription::newest}};
  // io_mode is the newer name and counts.
  const std::string_view key = reader.text("io_mode").empty() ? "subscription_type" : "io_mode";
  const auto given = base::to_lower(without_blanks(reader.text(key)));
  if (!given.empty()) {
    const auto it = std::ranges::find(words, std::string_view(given), [](const auto& entry) { return entry.first; });
    if (it == words.end()) return reader.refuse(ReturnCode::bad_parameter, key, "flush, new or periodic");
    settings.subscription = it->second;
  }

  reader.word<PushPolicy>("publisher.push_policy", settings.publisher.policy,
                          {{"all", PushPolicy::all}, {"fifo", PushPolicy::fifo}, {"skip", PushPolicy::skip}, {"new", PushPolicy::newest}});
  reader.count("publisher.skip_count", settings.publisher.skip_count, 0, longest_buffer);
  const bool is_old_name = reader.text("publisher.push_rate").empty() && !reader.text("push_rate").empty();
  const std::string_view rate_key = is_old_name ? "push_rate" : "publisher.push_rate";
  const std::string_view rate_text = reader.text(rate_key);
  const auto rate = base::parse_number(rate_text);
  if (settings.subscription != Subscription::periodic || settings.dataflow != Dataflow::push) {
    // This connection does not use the rate; tools write 0.
    if (!rate_text.empty() && !(rate && *rate >= 0)) reader.warn(rate_key, rate_text, "a rate [Hz]");
    return;
  }
  if (!rate || *rate <= 0 || *rate > fastest_push_rate || *rate < 1e-6) {
    return reader.refuse(ReturnCode::bad_parameter, rate_key, "a rate above 0 [Hz] for periodic subscriptions");
  }
  settings.publisher.period = std::chrono::nanoseconds(std::llround(1e9 / *rate));
}

void read_empty_policy(const Reader& reader, EmptyPolicy& policy) {
  reader.word<EmptyPolicy>("buffer.read.empty_policy", policy,
                           {{"readback", EmptyPolicy::readback}, {"do_nothing", EmptyPolicy::do_nothing}, {"block", EmptyPolicy::block}});
}

}  // namespace

EmptyPolicy read_empty_policy(const KeyValues& properties, Side side) {
  ConnectorSettingsOutcome outcome;
  read_empty_policy(Reader(properties, side, outcome), outcome.settings.buffer.empty);
  return outcome.settings.buffer.empty;
}

ConnectorSettingsOutcome read_connector_settings(const KeyValues& properties, Side side, const std::vector<std::string>& foreign) {
  ConnectorSettingsOutcome outcome;
  ConnectorSettings& settings = outcome.settings;
  const Reader reader(properties, side, outcome);
  read_transport(reader, foreign, settings);
  read_subscription(reader, settings);

  reader.count("buffer.length", settings.buffer.length, 1, longest_buffer);
  reader.word<FullPolicy>("buffer.write.full_policy", settings.buffer.full,
                          {{"overwrite", FullPolicy::overwrite}, {"do_nothing", FullPolicy::do_nothing}, {"block", FullPolicy::block}});
  read_empty_policy(reader, settings.buffer.empty);
  reader.timeout("buffer.write.timeout", settings.buffer.write_timeout);
  reader.timeout("buffer.read.timeout", settings.buffer.read_timeout);

  reader.word<StampPolicy>("timestamp_policy", settings.stamp,
                           {{"on_write", StampPolicy::on_write},
                            {"on_send", StampPolicy::on_send},
                            {"on_received", StampPolicy::on_received},
                            {"on_read", StampPolicy::on_read},
                            {"none", StampPolicy::none}});
  reader.flag("allow_dup_connection", settings.allows_duplicate);
  reader.flag("sync_readwrite", settings.is_rendezvous);
  reader.flag("looks_on", settings.is_of_tool);
  reader.flag("reconnect", settings.comes_back);
  reader.count("fan_out", settings.fan_out, 1, longest_buffer);
  std::chrono::nanoseconds call_timeout{};
  reader.timeout("call_timeout", call_timeout);
  if (call_timeout.count() > 0) {
    settings.call_timeout = std::max(std::chrono::milliseconds(1), std::chrono::duration_cast<std::chrono::milliseconds>(call_timeout));
  }
  if (const auto size = reader.text("shem_default_size"); !size.empty()) {
    if (const auto octets = parse_size(size)) {
      settings.shared_memory_size = *octets;
    } else {
      reader.warn("shem_default_size", size, "a size like 8M or 64k");
    }
  }
  return outcome;
}

std::optional<std::size_t> parse_size(std::string_view text) {
  text = base::trim(text);
  std::size_t unit = 1;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) unit = std::size_t{1} << 10;
  if (!text.empty() && (text.back() == 'm' || text.back() == 'M')) unit = std::size_t{1} << 20;
  if (unit > 1) text.remove_suffix(1);
  const auto number = base::parse_integer(text);
  constexpr std::int64_t max = std::int64_t{1} << 40;
  if (!number || *number <= 0 || *number > max / static_cast<std::int64_t>(unit)) return std::nullopt;
  return static_cast<std::size_t>(*number) * unit;
}

bool are_compatible_types(std::string_view a, std::string_view b) {
  // "IDL:omg.org/RTC/X:1.0" -> "omg.org", "RTC", "X".
  const auto parts_of = [](std::string_view id) {
    std::string text(base::trim(id));
    if (text.starts_with("IDL:")) {
      text.erase(0, 4);
      if (const auto version = text.rfind(':'); version != std::string::npos) text.erase(version);
    }
    for (std::size_t at; (at = text.find("::")) != std::string::npos;) text.replace(at, 2, "/");
    return base::split_list(text, '/');
  };
  const auto left = parts_of(a);
  const auto right = parts_of(b);
  const auto fits_all = [](const std::vector<std::string>& parts) {
    return parts.empty() || (parts.size() == 1 && base::equal_ignoring_case(parts.front(), "any"));
  };
  if (fits_all(left) || fits_all(right)) return true;
  // As far as both names go, from the end.
  return std::equal(left.rbegin(), left.rbegin() + static_cast<std::ptrdiff_t>(std::min(left.size(), right.size())), right.rbegin());
}

}  // namespace rt
