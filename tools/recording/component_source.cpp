#include "recording/component_source.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/guarded.h"
#include "base/text.h"
#include "channels/ros_schema.h"
#include "recording/logger_service.h"
#include "ros/messages.h"
#include "system/remote.h"

namespace recorder {

namespace {

using Json = nlohmann::ordered_json;
using std::chrono::nanoseconds;

constexpr const char* event_log_type = "rtm-sim/EventLog:1.0";     // of our components: rtm-core/component/observer.h
constexpr const char* simulator_parameter = "server_id";           // another one in each run
constexpr std::chrono::seconds longest_simulation{1'000'000'000};  // later stamps are of the wall clock

channels::Schema json_schema(const std::string& name, const std::string& properties) {
  return {name, "jsonschema", R"({"title":")" + name + R"(","type":"object","properties":{)" + properties + "}}"};
}

const channels::Schema state_schema =
    json_schema("rtmsim.State", R"("context":{"type":"integer"},"state":{"type":"string"},"is_in_tick":{"type":"boolean"})");
const channels::Schema configuration_schema = json_schema(
    "rtmsim.Configuration",
    R"("set":{"type":"string"},"values":{"type":"object","additionalProperties":{"type":"string"}},"all":{"type":"object","additionalProperties":{"type":"string"}},"is_change":{"type":"boolean"},"is_in_tick":{"type":"boolean"})");
const channels::Schema event_schema = json_schema("rtmsim.Event", R"("kind":{"type":"string"},"event":{"type":"string"})");

std::uint8_t ros_level(OpenRTM::LogLevel level) {
  constexpr std::uint8_t debug = 10, info = 20, warn = 30, error = 40;
  switch (level) {
    case OpenRTM::RTM_ERROR:
      return error;
    case OpenRTM::RTM_WARN:
      return warn;
    case OpenRTM::RTM_INFO:
    case OpenRTM::RTM_NORMAL:
      return info;
    default:
      return debug;
  }
}

// "ACTIVE:0" -> context 0, "Active".
std::optional<std::pair<int, std::string>> state_in(const std::string& event) {
  const auto colon = event.find(':');
  const auto context = colon == std::string::npos ? std::nullopt : base::parse_integer(event.substr(colon + 1));
  if (!context) return std::nullopt;
  for (const auto& [word, state] : {std::pair("ACTIVE", "Active"), std::pair("INACTIVE", "Inactive"), std::pair("ERROR", "Error"),
                                    std::pair("FINALIZE", "Finalized")}) {
    if (event.substr(0, colon) == word) return std::pair(static_cast<int>(*context), std::string(state));
  }
  return std::nullopt;
}

// "UPDATE_CONFIG_PARAM: default.gain=0.5" -> default, gain, 0.5.
std::optional<std::array<std::string, 3>> parameter_in(const std::string& event) {
  constexpr std::string_view head = "UPDATE_CONFIG_PARAM: ";
  const auto equals = event.find('=');
  const auto dot = event.find('.');
  if (!event.starts_with(head) || equals == std::string::npos || dot > equals) return std::nullopt;
  return std::array{event.substr(head.size(), dot - head.size()), event.substr(dot + 1, equals - dot - 1), event.substr(equals + 1)};
}

std::string state_name(RTC::LifeCycleState state) {
  static constexpr const char* names[] = {"Created", "Inactive", "Active", "Error"};
  return names[static_cast<std::size_t>(state) % 4];
}

}  // namespace

struct ComponentSource::State {
  CORBA::ORB_var orb;
  channels::Exchange& exchange;
  const base::Clock& clock;
  std::function<void(const std::string&, const ComponentEvent&)> told{};
  std::optional<channels::ChannelId> log{}, diagnostics{};
  std::vector<std::unique_ptr<Watched>> watched{};
  base::Turn<> turn{};                            // of who asks the components, and who puts one in the place of another
  std::map<std::string, std::uint64_t> counts{};  // of diagnose(), by topic
  channels::Time diagnosed{0};

  nanoseconds time_of(const RTC::Time& time) const {
    const nanoseconds said = std::chrono::seconds(time.sec) + nanoseconds(time.nsec);
    return said < longest_simulation ? said : clock.now();
  }
  void put(channels::ChannelId id, nanoseconds time, const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    exchange.put(id, time, {text.data(), text.size()});
  }
  void take_line(const OpenRTM::LogRecord& record) {
    const auto time = time_of(record.time);
    exchange.put(
        *log, time,
        ros::encode(ros::Log{
            .stamp = ros::to_time(time), .level = ros_level(record.level), .logger = record.loggername.in(), .msg = record.message.in()}));
  }
};

// One component, with the services that are attached to it.
class ComponentSource::Watched {
 public:
  Watched(State& state, const tools::ComponentView& component) : state_(state), view_(component) {}
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

  base::Result<void> open();
  // Instead of opening some: with the channels of one that is gone.
  void go_on_from(const Watched& gone);
  void attach();
  const tools::ComponentView& view() const { return view_; }

 private:
  void take(const OpenRTM::LogRecord& record);
  std::string topic(const char* what) const { return "/rtc/" + view_.instance + "/" + what; }
  base::Result<channels::ChannelId> channel(const char* what, const channels::Schema& schema, bool is_latched = false) {
    channels::Channel channel{topic(what), "json", schema, {{"component", view_.instance}, {"component_type", view_.type}}};
    if (is_latched) channel.metadata["latched"] = "yes";
    return state_.exchange.open(std::move(channel));
  }

  void put_first();

  State& state_;
  const tools::ComponentView view_;
  channels::ChannelId states_ = 0, configuration_ = 0;
  Json values_ = Json::object();  // of parameters, as they are now: who reads a part of the recording knows all of them
  base::Guarded<std::optional<channels::ChannelId>, base::Rank::noted> events_;  // when there is the first one
  std::unique_ptr<LoggerService> own_events_, log_;                              // last: they call the others
};

base::Result<void> ComponentSource::Watched::open() {
  const auto states = channel("state", state_schema, true);
  const auto configuration = channel("configuration", configuration_schema, true);
  if (!states || !configuration) return (states ? configuration : states).error();
  states_ = *states;
  configuration_ = *configuration;
  put_first();
  return {};
}

void ComponentSource::Watched::go_on_from(const Watched& gone) {
  states_ = gone.states_;
  configuration_ = gone.configuration_;
  *events_.lock() = gone.events_.snapshot();
  put_first();
}

// As it is now.
void ComponentSource::Watched::put_first() {
  const auto now = state_.clock.now();
  for (const auto& context : view_.contexts) {
    if (!context.is_gone() && context.is_running)
      state_.put(states_, now, {{"context", context.handle}, {"state", state_name(context.state)}, {"is_in_tick", false}});
  }
  for (const auto& set : view_.configuration_sets) {
    if (set.id != view_.active_set) continue;
    Json values = Json::object();
    for (const auto& [name, value] : set.values) {
      if (name != simulator_parameter) values[name] = value;
    }
    values_ = values;
    state_.put(configuration_, now, {{"set", set.id}, {"values", values}, {"is_change", false}, {"is_in_tick", false}});
  }
}

// A component that does not know such services says nothing more.
void ComponentSource::Watched::attach() {
  own_events_ = LoggerService::attach(
      view_, event_log_type,
      {{"observed_status", "RTC_STATUS,EC_STATUS,CONFIGURATION,COMPONENT_PROFILE"}},  // ports would be listened to at each sample
      [this](const OpenRTM::LogRecord& record) { this->take(record); });
  log_ = LoggerService::of_log(view_, [&state = state_](const OpenRTM::LogRecord& record) { state.take_line(record); });
}

void ComponentSource::Watched::take(const OpenRTM::LogRecord& record) {
  const ComponentEvent event{state_.time_of(record.time), record.loggername.in(), record.message.in(), record.level == OpenRTM::RTM_INFO};
  if (state_.told) state_.told(view_.instance, event);
  if (const auto state = event.kind == "RTC_STATUS" ? state_in(event.event) : std::nullopt)
    return state_.put(states_, event.time, {{"context", state->first}, {"state", state->second}, {"is_in_tick", event.is_in_tick}});
  if (const auto parameter = parameter_in(event.event)) {
    const auto& [set, name, value] = *parameter;
    if (name == simulator_parameter) return;
    values_[name] = value;
    return state_.put(configuration_, event.time,
                      {{"set", set}, {"values", {{name, value}}}, {"all", values_}, {"is_change", true}, {"is_in_tick", event.is_in_tick}});
  }
  auto id = events_.snapshot();
  if (!id) {
    const auto opened = channel("events", event_schema);
    if (!opened) return;
    id = *opened;
    *events_.lock() = id;
  }
  state_.put(*id, event.time, {{"kind", event.kind}, {"event", event.event}});
}

ComponentSource::ComponentSource(CORBA::ORB_ptr orb, channels::Exchange& exchange, const base::Clock& clock)
    : state_(new State{CORBA::ORB::_duplicate(orb), exchange, clock}) {}

ComponentSource::~ComponentSource() { state_->watched.clear(); }

void ComponentSource::on_event(std::function<void(const std::string&, const ComponentEvent&)> told) { state_->told = std::move(told); }

std::size_t ComponentSource::size() const { return state_->watched.size(); }

base::Result<void> ComponentSource::add(const tools::ComponentView& component) {
  if (!state_->log) {
    // What depends on the machine is no difference between two runs.
    const auto log = state_->exchange.open({"/log", "cdr", channels::schema_of<ros::Log>(), {{"compare", "no"}}});
    const auto diagnostics =
        state_->exchange.open({"/diagnostics", "cdr", channels::schema_of<ros::DiagnosticArray>(), {{"compare", "no"}}});
    if (!log || !diagnostics) return (log ? diagnostics : log).error();
    state_->log = *log;
    state_->diagnostics = *diagnostics;
  }
  auto watched = std::make_unique<Watched>(*state_, component);
  if (const auto opened = watched->open(); !opened) return opened;
  watched->attach();
  state_->watched.push_back(std::move(watched));
  return {};
}

void ComponentSource::attach_again(const tools::ComponentView& component) {
  const auto mine = state_->turn.take();
  const auto known = std::ranges::find_if(state_->watched, [&](const auto& one) { return one->view().instance == component.instance; });
  if (known == state_->watched.end() || (*known)->view().object->_is_equivalent(component.object)) return;
  auto watched = std::make_unique<Watched>(*state_, component);
  watched->go_on_from(**known);
  watched->attach();
  *known = std::move(watched);
}

void ComponentSource::diagnose(channels::Time now, const PortSource& ports) {
  const auto mine = state_->turn.take();
  if (!state_->diagnostics) return;
  const auto counts = ports.counts();
  const double passed = std::chrono::duration<double>(now - state_->diagnosed).count();
  ros::DiagnosticArray array{.header = {ros::to_time(now), ""}};
  for (const auto& watched : state_->watched) {
    const auto& view = watched->view();
    ros::DiagnosticStatus status{.subject = view.instance, .message = "gone", .hardware_id = view.type};
    const auto* context = view.shown_context();
    RTC::LifeCycleState life = RTC::CREATED_STATE;
    const bool is_there =
        context != nullptr && tools::remote("component", [&] { life = context->object->get_component_state(view.object); }).ok();
    if (is_there) status.message = state_name(life);
    enum Level { ok, warn, error, stale };
    status.level = static_cast<ros::Byte>(!is_there ? stale : life == RTC::ERROR_STATE ? error : life == RTC::ACTIVE_STATE ? ok : warn);
    for (const auto& [topic, count] : counts) {
      if (!topic.starts_with("/" + view.instance + "/") || passed <= 0) continue;
      const auto before = state_->counts.contains(topic) ? state_->counts.at(topic) : 0;
      status.values.push_back(
          {topic.substr(view.instance.size() + 2) + " [Hz]", base::format_number(static_cast<double>(count - before) / passed)});
    }
    array.status.push_back(std::move(status));
  }
  state_->counts = counts;
  state_->diagnosed = now;
  state_->exchange.put(*state_->diagnostics, now, ros::encode(array));
}

}  // namespace recorder
