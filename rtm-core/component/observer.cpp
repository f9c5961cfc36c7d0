#include "component/observer.h"
#include <rtm/ConnectorListener.h>
#include <rtm/InPortBase.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPortBase.h>
#include <rtm/RTObject.h>
#include <rtm/idl/ComponentObserverSkel.h>
#include <rtm/idl/FsmComponentObserverSkel.h>
#include <rtm/idl/LoggerSkel.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include "base/clock.h"
#include "base/guarded.h"
#include "base/nondeterminism.h"
#include "base/text.h"
#include "base/tick.h"
#include "component/runtime_access.h"
#include "corba/members/courier.h"
#include "corba/orb/orb.h"

namespace RTC {

namespace {

using namespace std::chrono_literals;

// All kinds of both interfaces; the wire has other numbers for some.
enum class Kind {
  component_profile,
  rtc_status,
  ec_status,
  port_profile,
  configuration,
  rtc_heartbeat,
  ec_heartbeat,
  fsm_profile,
  fsm_status,
  fsm_structure,
  user_defined
};

constexpr std::pair<Kind, const char*> kind_names[] = {
    {Kind::component_profile, "COMPONENT_PROFILE"},
    {Kind::rtc_status, "RTC_STATUS"},
    {Kind::ec_status, "EC_STATUS"},
    {Kind::port_profile, "PORT_PROFILE"},
    {Kind::configuration, "CONFIGURATION"},
    {Kind::fsm_profile, "FSM_PROFILE"},
    {Kind::fsm_status, "FSM_STATUS"},
    {Kind::fsm_structure, "FSM_STRUCTURE"},
    {Kind::user_defined, "USER_DEFINED"},
};

// What has happened, and when: by the simulator's clock where there is one.
struct Event {
  Kind kind{};
  std::string hint{};
  std::string value{};  // of a parameter
  std::chrono::nanoseconds time = base::SystemClock().now();
  bool is_in_tick = false;  // else between two of them
};

Event event_now(Kind kind, const std::string& hint, const std::string& value) {
  if (const base::Tick* tick = base::tick_in_lock_step()) return {kind, hint, value, tick->time(), true};
  const auto simulated = base::lock_step_clock();
  return simulated ? Event{kind, hint, value, simulated->now()} : Event{kind, hint, value};
}

template <class Observer>
void send_status(typename Observer::Interface::_ptr_type target, const Event& event) {
  typename Observer::WireKind wire{};
  if (Observer::to_wire(event.kind, wire)) target->update_status(wire, event.hint.c_str());
}

struct OldObserver {
  using Interface = OpenRTM::ComponentObserver;
  static void send(Interface::_ptr_type target, const Event& event) { send_status<OldObserver>(target, event); }
  static constexpr const char* id = "IDL:OpenRTM/ComponentObserver:1.0";
  static constexpr std::pair<const char*, Kind> heartbeats[] = {{"heartbeat", Kind::rtc_heartbeat}};
  static bool to_wire(Kind kind, OpenRTM::StatusKind& wire) {
    switch (kind) {
      case Kind::component_profile:
        return wire = OpenRTM::COMPONENT_PROFILE, true;
      case Kind::rtc_status:
        return wire = OpenRTM::RTC_STATUS, true;
      case Kind::ec_status:
        return wire = OpenRTM::EC_STATUS, true;
      case Kind::port_profile:
        return wire = OpenRTM::PORT_PROFILE, true;
      case Kind::configuration:
        return wire = OpenRTM::CONFIGURATION, true;
      case Kind::rtc_heartbeat:
        return wire = OpenRTM::HEARTBEAT, true;
      default:
        return false;
    }
  }
  using WireKind = OpenRTM::StatusKind;
};

struct NewObserver {
  using Interface = RTC::ComponentObserver;
  static void send(Interface::_ptr_type target, const Event& event) { send_status<NewObserver>(target, event); }
  static constexpr const char* id = "IDL:omg.org/RTC/ComponentObserver:1.0";
  static constexpr std::pair<const char*, Kind> heartbeats[] = {
      {"heartbeat", Kind::rtc_heartbeat}, {"rtc_heartbeat", Kind::rtc_heartbeat}, {"ec_heartbeat", Kind::ec_heartbeat}};
  static bool to_wire(Kind kind, RTC::StatusKind& wire) {
    wire = static_cast<RTC::StatusKind>(kind);
    return true;
  }
  using WireKind = RTC::StatusKind;
};
static_assert(static_cast<int>(Kind::user_defined) == RTC::USER_DEFINED && static_cast<int>(Kind::fsm_status) == RTC::FSM_STATUS);

// A logger that is told of events instead of lines, each with its time.
struct EventLog {
  using Interface = OpenRTM::Logger;
  static constexpr const char* id = event_log_type;
  static constexpr std::array<std::pair<const char*, Kind>, 0> heartbeats{};
  static void send(Interface::_ptr_type target, const Event& event) {
    const auto* name = std::ranges::find(kind_names, event.kind, &std::pair<Kind, const char*>::first);
    if (name == std::end(kind_names)) return;
    OpenRTM::LogRecord record;
    record.time.sec = static_cast<CORBA::ULong>(event.time.count() / 1'000'000'000);
    record.time.nsec = static_cast<CORBA::ULong>(event.time.count() % 1'000'000'000);
    record.loggername = name->second;
    record.level = event.is_in_tick ? OpenRTM::RTM_INFO : OpenRTM::RTM_NORMAL;
    record.message = (event.hint + (event.value.empty() ? "" : "=" + event.value)).c_str();
    target->publish(record);
  }
};

// Where the events of one component go; shared by all listeners, which may be called a little longer than the consumer lives.
class Link {
 public:
  using Send = std::function<void(const Event& event)>;
  Link(Send send, std::set<Kind> observed) : courier_("component observer"), send_(std::move(send)), observed_(std::move(observed)) {}

  void tell(Kind kind, const std::string& hint, const std::string& value = "") {
    if (observed_.count(kind) == 0) return;
    courier_.send([this, event = event_now(kind, hint, value)] { send_(event); });
  }

  // At most one such message per interval.
  void tell_of_sample(const std::string& hint, std::chrono::nanoseconds interval) {
    if (observed_.count(Kind::port_profile) == 0) return;
    const auto now = std::chrono::steady_clock::now();
    {
      auto last = last_told_.lock();
      const auto [it, is_new] = last->try_emplace(hint, now);
      if (!is_new && now - it->second < interval) return;
      it->second = now;
    }
    tell(Kind::port_profile, hint);
  }

  void beat(const std::vector<std::pair<Kind, std::chrono::nanoseconds>>& hearts) {
    std::vector<corba::Courier::Regular> regulars;
    for (const auto& [kind, interval] : hearts) regulars.push_back({interval, [this, kind = kind] { send_({.kind = kind}); }});
    courier_.repeat(std::move(regulars));
  }

  void finish() { courier_.finish(); }

 private:
  corba::Courier courier_;
  const Send send_;
  const std::set<Kind> observed_;
  base::Guarded<std::map<std::string, std::chrono::steady_clock::time_point>, base::Rank::queue> last_told_;
};

template <class Base, class Function, class... Args>
class Calls final : public Base {
 public:
  explicit Calls(Function function) : function_(std::move(function)) {}
  void operator()(Args... args) override { function_(args...); }

 private:
  Function function_;
};

class SampleListener final : public ConnectorDataListener {
 public:
  SampleListener(std::shared_ptr<Link> link, std::string hint, std::chrono::nanoseconds interval)
      : link_(std::move(link)), hint_(std::move(hint)), interval_(interval) {}
  ReturnCode notify(ConnectorInfo&, detail::SampleEvent&) override {
    link_->tell_of_sample(hint_, interval_);
    return NO_CHANGE;
  }

 private:
  std::shared_ptr<Link> link_;
  std::string hint_;
  std::chrono::nanoseconds interval_;
};

// The least time between two messages about samples of one port.
struct SampleIntervals {
  std::chrono::nanoseconds send = 1s;
  std::chrono::nanoseconds receive = 1s;
};

// The sample listeners of one observer at the ports of one component. Ports come and go while it observes; one that has left may be
// destroyed, and takes its listener with it.
class SampleListeners {
 public:
  explicit SampleListeners(const SampleIntervals& intervals) : intervals_(intervals) {}

  void follow(RTObject_impl& component, const std::shared_ptr<Link>& link) {
    const std::vector<InPortBase*> in = component.getInPorts();
    const std::vector<OutPortBase*> out = component.getOutPorts();
    auto data = shared_.lock();
    if (data->has_left) return;
    update(data->in, in, ON_RECEIVED, "RECEIVE:InPort:", intervals_.receive, link);
    update(data->out, out, ON_SEND, "SEND:OutPort:", intervals_.send, link);
  }

  void leave(RTObject_impl& component) {
    const std::vector<InPortBase*> in = component.getInPorts();
    const std::vector<OutPortBase*> out = component.getOutPorts();
    auto data = shared_.lock();
    data->has_left = true;
    for (InPortBase* port : in)
      if (data->in.count(port) != 0) port->removeConnectorDataListener(ON_RECEIVED, data->in[port]);
    for (OutPortBase* port : out)
      if (data->out.count(port) != 0) port->removeConnectorDataListener(ON_SEND, data->out[port]);
    data->in.clear();
    data->out.clear();
  }

 private:
  template <class Port>
  using Listened = std::map<Port*, SampleListener*>;

  template <class Port>
  static void update(Listened<Port>& listened, const std::vector<Port*>& ports, ConnectorDataListenerType type, const char* event,
                     std::chrono::nanoseconds interval, const std::shared_ptr<Link>& link) {
    std::erase_if(listened, [&](const auto& entry) { return std::find(ports.begin(), ports.end(), entry.first) == ports.end(); });
    for (Port* port : ports) {
      const auto [it, is_new] = listened.try_emplace(port, nullptr);
      if (!is_new) continue;
      it->second = new SampleListener(link, event + std::string(port->getName()), interval);
      port->addConnectorDataListener(type, it->second);
    }
  }

  struct Data {
    Listened<InPortBase> in{};
    Listened<OutPortBase> out{};
    bool has_left = false;
  };
  const SampleIntervals intervals_;
  base::Guarded<Data, base::Rank::peers> shared_;
};

// The listeners of one observer at one component.
class Listeners {
 public:
  Listeners(RTObject_impl& component, std::shared_ptr<Link> link, const SampleIntervals& intervals)
      : component_(component), link_(std::move(link)), samples_(std::make_shared<SampleListeners>(intervals)) {
    listen_to_life_cycle();
    listen_to_contexts();
    listen_to_ports();
    listen_to_configuration();
    listen_to_state_machine();
    listen_to_status();
  }
  ~Listeners() {
    for (const auto& undo : undo_) undo();
  }
  Listeners(const Listeners&) = delete;
  Listeners& operator=(const Listeners&) = delete;

 private:
  // What a callback that rejected did not do is not told; the error state comes whatever onAborting answers.
  void post(PostComponentActionListenerType type, Kind kind, const char* event) {
    auto function = [link = link_, kind, event, always = type == POST_ON_ABORTING](UniqueId id, ReturnCode_t code) {
      if (always || code == RTC_OK) link->tell(kind, event + std::to_string(id));
    };
    auto* listener = new Calls<PostComponentActionListener, decltype(function), UniqueId, ReturnCode_t>(std::move(function));
    component_.addPostComponentActionListener(type, listener);
    undo_.push_back([this, type, listener] { component_.removePostComponentActionListener(type, listener); });
  }

  void listen_to_life_cycle() {
    post(POST_ON_ACTIVATED, Kind::rtc_status, "ACTIVE:");
    post(POST_ON_DEACTIVATED, Kind::rtc_status, "INACTIVE:");
    post(POST_ON_RESET, Kind::rtc_status, "INACTIVE:");
    post(POST_ON_ABORTING, Kind::rtc_status, "ERROR:");
    post(POST_ON_FINALIZE, Kind::rtc_status, "FINALIZE:");
  }

  void listen_to_contexts() {
    post(POST_ON_STARTUP, Kind::ec_status, "STARTUP:");
    post(POST_ON_SHUTDOWN, Kind::ec_status, "SHUTDOWN:");
    post(POST_ON_RATE_CHANGED, Kind::ec_status, "RATE_CHANGED:");
    for (const auto& [type, event] : {std::pair(EC_ATTACHED, "ATTACHED:"), std::pair(EC_DETACHED, "DETACHED:")}) {
      auto function = [link = link_, event = event](UniqueId id) { link->tell(Kind::ec_status, event + std::to_string(id)); };
      auto* listener = new Calls<ExecutionContextActionListener, decltype(function), UniqueId>(std::move(function));
      component_.addExecutionContextActionListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removeExecutionContextActionListener(type, listener); });
    }
  }

  void listen_to_ports() {
    for (const auto& [type, event] : {std::pair(ADD_PORT, "ADD:"), std::pair(REMOVE_PORT, "REMOVE:")}) {
      auto function = [&component = component_, samples = samples_, link = link_, event = event](const PortProfile& profile) {
        link->tell(Kind::port_profile, event + std::string(profile.name));
        samples->follow(component, link);
      };
      auto* listener = new Calls<PortActionListener, decltype(function), const PortProfile&>(std::move(function));
      component_.addPortActionListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removePortActionListener(type, listener); });
    }
    for (const auto& [type, event] : {std::pair(ON_CONNECTED, "CONNECT:"), std::pair(ON_DISCONNECTED, "DISCONNECT:")}) {
      auto function = [link = link_, event = event](const char* port, ConnectorProfile&, ReturnCode_t code) {
        if (code == RTC_OK) link->tell(Kind::port_profile, event + std::string(port));
      };
      auto* listener =
          new Calls<PortConnectRetListener, decltype(function), const char*, ConnectorProfile&, ReturnCode_t>(std::move(function));
      component_.addPortConnectRetListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removePortConnectRetListener(type, listener); });
    }
    samples_->follow(component_, link_);
    undo_.push_back([this] { samples_->leave(component_); });
  }

  void listen_to_configuration() {
    {
      auto function = [&component = component_, link = link_](const char* set, const char* parameter) {
        link->tell(Kind::configuration, "UPDATE_CONFIG_PARAM: " + std::string(set) + "." + parameter,
                   component.getConfigService().getConfigurationSet(set).getProperty(parameter));
      };
      auto* listener = new Calls<ConfigurationParamListener, decltype(function), const char*, const char*>(std::move(function));
      component_.addConfigurationParamListener(ON_UPDATE_CONFIG_PARAM, listener);
      undo_.push_back([this, listener] { component_.removeConfigurationParamListener(ON_UPDATE_CONFIG_PARAM, listener); });
    }
    for (const auto& [type, event] : {std::pair(ON_SET_CONFIG_SET, "SET_CONFIG_SET: "), std::pair(ON_ADD_CONFIG_SET, "ADD_CONFIG_SET: ")}) {
      auto function = [link = link_, event = event](const coil::Properties& set) {
        link->tell(Kind::configuration, event + std::string(set.getName()));
      };
      auto* listener = new Calls<ConfigurationSetListener, decltype(function), const coil::Properties&>(std::move(function));
      component_.addConfigurationSetListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removeConfigurationSetListener(type, listener); });
    }
    for (const auto& [type, event] :
         {std::pair(ON_UPDATE_CONFIG_SET, "UPDATE_CONFIG_SET: "), std::pair(ON_REMOVE_CONFIG_SET, "REMOVE_CONFIG_SET: "),
          std::pair(ON_ACTIVATE_CONFIG_SET, "ACTIVATE_CONFIG_SET: ")}) {
      auto function = [link = link_, event = event](const char* set) { link->tell(Kind::configuration, event + std::string(set)); };
      auto* listener = new Calls<ConfigurationSetNameListener, decltype(function), const char*>(std::move(function));
      component_.addConfigurationSetNameListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removeConfigurationSetNameListener(type, listener); });
    }
  }

  void listen_to_state_machine() {
    for (const auto& [type, event] :
         {std::pair(PRE_ON_INIT, " PRE_ONINIT"), std::pair(PRE_ON_ENTRY, " PRE_ONENTRY"), std::pair(PRE_ON_DO, " PRE_ONDO"),
          std::pair(PRE_ON_EXIT, " PRE_ONEXIT"), std::pair(PRE_ON_STATE_CHANGE, " PRE_ONSTATECHANGE")}) {
      auto function = [link = link_, event = event](const char* state) { link->tell(Kind::fsm_status, std::string(state) + event); };
      auto* listener = new Calls<PreFsmActionListener, decltype(function), const char*>(std::move(function));
      component_.addPreFsmActionListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removePreFsmActionListener(type, listener); });
    }
    for (const auto& [type, event] :
         {std::pair(POST_ON_INIT, " POST_ONINIT"), std::pair(POST_ON_ENTRY, " POST_ONENTRY"), std::pair(POST_ON_DO, " POST_ONDO"),
          std::pair(POST_ON_EXIT, " POST_ONEXIT"), std::pair(POST_ON_STATE_CHANGE, " POST_ONSTATECHANGE")}) {
      auto function = [link = link_, event = event](const char* state, ReturnCode_t) {
        link->tell(Kind::fsm_status, std::string(state) + event);
      };
      auto* listener = new Calls<PostFsmActionListener, decltype(function), const char*, ReturnCode_t>(std::move(function));
      component_.addPostFsmActionListener(type, listener);
      undo_.push_back([this, type = type, listener] { component_.removePostFsmActionListener(type, listener); });
    }
  }

  void listen_to_status() {
    // By RTObject_impl::Status.
    static constexpr std::array kinds{Kind::component_profile, Kind::fsm_profile, Kind::fsm_structure, Kind::user_defined};
    const auto tell = [link = link_](RTObject_impl::Status status, const std::string& hint) {
      link->tell(kinds.at(static_cast<std::size_t>(status)), hint);
    };
    const int number = RuntimeAccess::add_status_listener(component_, tell);
    undo_.push_back([this, number] { RuntimeAccess::remove_status_listener(component_, number); });
  }

  RTObject_impl& component_;
  std::shared_ptr<Link> link_;
  const std::shared_ptr<SampleListeners> samples_;
  std::vector<std::function<void()>> undo_;
};

std::chrono::nanoseconds seconds_or(const std::string& text, std::chrono::nanoseconds fallback) {
  const auto number = base::parse_number(text);
  if (!number || !(*number > 0) || *number > 1e6) return fallback;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(*number * 1e9));
}

template <class Observer>
class ObserverConsumer final : public SdoServiceConsumerBase {
 public:
  ~ObserverConsumer() override { ObserverConsumer::finalize(); }

  bool init(RTObject_impl& rtobj, const SDOPackage::ServiceProfile& profile) override {
    component_ = &rtobj;
    return start(profile);
  }

  bool reinit(const SDOPackage::ServiceProfile& profile) override {
    finalize();
    return start(profile);
  }

  const SDOPackage::ServiceProfile& getProfile() const override { return profile_; }

  void finalize() override {
    listeners_.reset();
    if (link_) link_->finish();
    link_.reset();
  }

 private:
  using Interface = typename Observer::Interface;

  bool start(const SDOPackage::ServiceProfile& profile) {
    typename Interface::_var_type observer;
    try {
      corba::set_call_timeout(profile.service, 1s);
      observer = Interface::_narrow(profile.service);
    } catch (const CORBA::Exception&) {
      return false;
    }
    if (CORBA::is_nil(observer)) return false;
    corba::set_call_timeout(observer, 1s);
    profile_ = profile;
    const auto property = [&](const std::string& name) { return NVUtil::toString(profile.properties, name); };
    link_ = std::make_shared<Link>(
        [observer](const Event& event) {
          const typename Interface::_var_type target = observer;
          Observer::send(target, event);
        },
        observed(property("observed_status")));
    std::map<Kind, std::chrono::nanoseconds> hearts;
    for (const auto& [name, kind] : Observer::heartbeats)
      if (base::parse_bool(property(std::string(name) + ".enable")).value_or(false))
        hearts[kind] = std::max<std::chrono::nanoseconds>(seconds_or(property(std::string(name) + ".interval"), 1s), 10ms);
    link_->beat({hearts.begin(), hearts.end()});
    SampleIntervals intervals;
    intervals.send = seconds_or(property("port_profile.send_event.min_interval"), intervals.send);
    intervals.receive = seconds_or(property("port_profile.receive_event.min_interval"), intervals.receive);
    listeners_ = std::make_unique<Listeners>(*component_, link_, intervals);
    return true;
  }

  // Without a list everything is observed.
  static std::set<Kind> observed(const std::string& list) {
    std::set<Kind> kinds;
    const std::vector<std::string> words = base::split_list(list);
    for (const auto& [kind, name] : kind_names) {
      bool wanted = words.empty();
      for (const std::string& word : words)
        wanted = wanted || base::equal_ignoring_case(word, name) || base::equal_ignoring_case(word, "ALL");
      if (wanted) kinds.insert(kind);
    }
    return kinds;
  }

  RTObject_impl* component_ = nullptr;
  SDOPackage::ServiceProfile profile_;
  std::shared_ptr<Link> link_;
  std::unique_ptr<Listeners> listeners_;
};

template <class Observer>
void register_consumer() {
  SdoServiceConsumerFactory::instance().addFactory(Observer::id, coil::Creator<SdoServiceConsumerBase, ObserverConsumer<Observer>>,
                                                   coil::Destructor<SdoServiceConsumerBase, ObserverConsumer<Observer>>);
}

}  // namespace

void registerComponentObserverConsumers() {
  register_consumer<OldObserver>();
  register_consumer<NewObserver>();
  register_consumer<EventLog>();
}

}  // namespace RTC
