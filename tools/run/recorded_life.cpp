#include "run/recorded_life.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "recording/mcap/mcap.h"
#include "recording/ring.h"
#include "system/remote.h"

namespace recorder {

namespace {

using Json = nlohmann::ordered_json;
using Kind = RecordedChange::Kind;

std::chrono::nanoseconds time_of(const mcap::Message& message) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(message.log_time.count()));
}

void add_state(RecordedLife& life, std::string& state, const mcap::Message& message, const Json& json) {
  const auto before = std::exchange(state, json.value("state", ""));
  RecordedChange change{.time = time_of(message), .is_in_tick = json.value("is_in_tick", true)};
  if (before.empty()) {
    life.state = state;
  } else if (state == "Active" && before != "Active") {
    change.kind = Kind::activate;
    life.changes.push_back(std::move(change));
  } else if (state == "Inactive" && before != "Inactive") {
    change.kind = before == "Error" ? Kind::reset : Kind::deactivate;
    life.changes.push_back(std::move(change));
  }
}

// Parameters that took effect in one tick are one change. A part of a recording may begin with a change, which says all values then.
void add_values(RecordedLife& life, const mcap::Message& message, const Json& json) {
  RecordedChange change{.time = time_of(message), .is_in_tick = json.value("is_in_tick", true), .set = json.value("set", "")};
  const bool is_first = !json.value("is_change", true) || (!life.configuration && json.contains("all"));
  const auto values = json.value(is_first && json.contains("all") ? "all" : "values", Json::object());
  for (const auto& [name, value] : values.items()) {
    if (value.is_string()) change.values.emplace_back(name, value.get<std::string>());
  }
  if (is_first) {
    life.configuration = std::move(change);
    return;
  }
  auto* last = life.changes.empty() ? nullptr : &life.changes.back();
  if (last != nullptr && last->kind == Kind::configure && last->time == change.time && last->set == change.set) {
    last->values.insert(last->values.end(), change.values.begin(), change.values.end());
  } else {
    life.changes.push_back(std::move(change));
  }
}

const char* text_of(Kind kind) {
  static constexpr const char* texts[] = {"configuration", "activation", "deactivation", "reset"};
  return texts[static_cast<std::size_t>(kind)];
}

}  // namespace

namespace {

// That in which the component worked: one of others, which it has joined, before its own. Nothing when no state was recorded.
base::Result<std::optional<int>> working_context(mcap::Reader& reader, std::uint16_t states) {
  std::optional<int> highest;
  reader.seek({.channels = {0, states}});
  for (;;) {
    const auto message = reader.next();
    if (!message) return message.error();
    if (!message->has_value()) return highest;
    const auto json = Json::parse((*message)->data, nullptr, false);
    const auto context = json.is_object() ? json.find("context") : json.end();
    if (context != json.end() && context->is_number_integer()) highest = std::max(highest.value_or(0), context->get<int>());
  }
}

}  // namespace

base::Result<RecordedLife> RecordedLife::read(const std::string& file, const std::string& component) {
  auto reader = open_recording(file);
  if (!reader) return reader.error();
  RecordedLife life;
  mcap::Query query{.channels = {0}};  // none but these
  std::uint16_t states = 0, configurations = 0;
  for (const auto& [id, channel] : reader->channels()) {
    if (channel.topic == "/rtc/" + component + "/state") states = id;
    if (channel.topic == "/rtc/" + component + "/configuration") configurations = id;
  }
  life.is_recorded = states != 0 && configurations != 0;
  query.channels.insert(query.channels.end(), {states, configurations});
  const auto context = working_context(*reader, states);
  if (!context) return context.error();
  reader->seek(std::move(query));
  for (std::string state;;) {
    const auto message = reader->next();
    if (!message) return message.error();
    if (!message->has_value()) return life;
    const auto json = Json::parse((*message)->data, nullptr, false);
    if (!json.is_object()) return base::Error{"component " + component + ": what was recorded of its life cycle is no JSON"};
    try {
      if ((*message)->channel == states) {
        if (json.value("context", 0) == context->value_or(0)) add_state(life, state, **message, json);
      } else {
        add_values(life, **message, json);
      }
    } catch (const Json::exception&) {
      return base::Error{"component " + component + ": what was recorded of its life cycle is not of the expected kind"};
    }
  }
}

void RecordedLife::forget(const std::string& parameter) {
  const auto clean = [&](RecordedChange& change) { std::erase_if(change.values, [&](const auto& one) { return one.first == parameter; }); };
  if (configuration) clean(*configuration);
  for (auto& change : changes) clean(change);
  std::erase_if(changes, [](const RecordedChange& change) { return change.kind == Kind::configure && change.values.empty(); });
}

RecordedLife RecordedLife::part(bool is_in_tick) const {
  RecordedLife part = *this;
  std::erase_if(part.changes, [&](const RecordedChange& change) { return change.is_in_tick != is_in_tick; });
  return part;
}

base::Result<void> LifePlayer::make(const RecordedChange& change) {
  ++done_;
  const auto* context = component_.shown_context();
  if (context == nullptr) return base::Error{"component " + component_.instance + ": has no execution context"};
  // Within a tick the answer of a transition comes too late: it is made in the next one, which waits for us.
  return tools::remote("component " + component_.instance + ": " + text_of(change.kind), [&] {
    if (change.kind == Kind::activate) context->object->activate_component(component_.object);
    if (change.kind == Kind::deactivate) context->object->deactivate_component(component_.object);
    if (change.kind == Kind::reset) context->object->reset_component(component_.object);
    if (change.kind != Kind::configure || change.values.empty()) return;
    const SDOPackage::Configuration_var configuration = tools::configuration_of(component_.object);
    const SDOPackage::ConfigurationSet_var set = configuration->get_configuration_set(change.set.c_str());
    auto all = tools::to_properties(set->configuration_data);
    for (const auto& [name, value] : change.values) all[name] = value;
    set->configuration_data = tools::to_nv_list(all);
    configuration->set_configuration_set_values(set);
    configuration->activate_configuration_set(change.set.c_str());
  });
}

base::Result<void> LifePlayer::begin(const tools::ComponentView& component) {
  component_ = component;
  if (life_.configuration && !life_.configuration->values.empty()) {
    if (const auto made = make(*life_.configuration); !made) return made;
  }
  if (life_.state == "Inactive" && component.state() == RTC::ACTIVE_STATE) {
    if (const auto made = make({.kind = Kind::deactivate}); !made) return made;
  }
  done_ = 0;
  return go_on(std::chrono::nanoseconds(0));
}

std::optional<std::chrono::nanoseconds> LifePlayer::next() const {
  return next_ < life_.changes.size() ? std::optional(life_.changes[next_].time) : std::nullopt;
}

base::Result<void> LifePlayer::go_on(std::chrono::nanoseconds until) {
  for (; next_ < life_.changes.size() && life_.changes[next_].time <= until; ++next_) {
    if (const auto made = make(life_.changes[next_]); !made) return made;
  }
  return {};
}

}  // namespace recorder
