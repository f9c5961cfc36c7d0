// The life of the manager: what start, activation and end do, in this order.
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb/guarded_transport.h"
#include "core/connector_settings.h"
#include "core/name_format.h"
#include "manager/manager_impl.h"
#include "rtm/FactoryInit.h"
#include "rtm/LocalServiceAdmin.h"
#include "rtm/LogstreamBase.h"
#include "rtm/ManagerConfig.h"
#include "rtm/ManagerServant.h"
#include "rtm/ModuleManager.h"
#include "rtm/NamingManager.h"

namespace RTC {
namespace {

using std::chrono::steady_clock;

std::chrono::milliseconds to_milliseconds(double seconds) {
  constexpr double longest = 1e9;  // 30 years
  return std::chrono::milliseconds(static_cast<std::int64_t>(std::clamp(seconds, 0.0, longest) * 1000.0));
}

std::vector<std::string> split_arguments(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  char quote = '\0';
  bool has_word = false;
  for (const char c : text) {
    if (quote != '\0') {
      if (c == quote) {
        quote = '\0';
      } else {
        word += c;
      }
    } else if (c == '"' || c == '\'') {
      quote = c;
      has_word = true;
    } else if (c == ' ' || c == '\t') {
      if (has_word) words.push_back(std::move(word));
      word.clear();
      has_word = false;
    } else {
      word += c;
      has_word = true;
    }
  }
  if (has_word) words.push_back(std::move(word));
  return words;
}

}  // namespace

// --- start

base::Result<void> ManagerImpl::start(const ManagerConfig& configuration, const ManagerOptions& given) {
  options = given;
  home = std::this_thread::get_id();
  configuration.configure(config);
  origins = configuration.origins();
  start_logging();
  for (const auto& warning : configuration.warnings()) RTC_WARN(("%s", warning.c_str()));
  bind_to_processors();
  // From now on a signal finds somebody who ends everything properly, also while the rest starts. One that nohup or a script
  // has us ignore stays ignored.
  signals = std::make_unique<rt::SignalWatcher>(std::vector<int>{SIGINT, SIGTERM, SIGHUP}, [this](int number) {
    state.lock()->is_hurried = true;
    request_end();
    auto locked = state.lock();
    while (!locked.wait_for(changed, std::chrono::hours(1), [&] { return locked->life_is_over; })) {
    }
    // If nobody comes to runManager who would let the process end, the signal ends it.
    constexpr std::chrono::seconds timeout{2};
    if (!locked.wait_for(changed, timeout, [&] { return locked->runners > 0; })) ::raise(number);
  });
  if (auto started = start_orb(); !started) return started.error();
  timer = std::make_unique<rt::TaskRunner>("rtm-timer");
  cleaner = std::make_unique<rt::TaskRunner>("rtm-cleaner");
  modules = std::make_unique<ModuleManager>(&facade);
  {
    auto locked = state.lock();
    locked->phase = Phase::started;
    locked->empty_since = steady_clock::now();
  }
  FactoryInit(&facade);
  const auto policy = value("manager.components.naming_policy");
  auto& policies = RTM::NumberingPolicyFactory::instance();
  numbering = policies.createObject(policy);
  if (numbering == nullptr) {
    RTC_WARN(("%smanager.components.naming_policy: unknown policy %s; process_unique is used",
              where("manager.components.naming_policy").c_str(), base::in_quotes(policy).c_str()));
    numbering = policies.createObject("process_unique");
  }
  start_naming();
  if (flag("manager.corba_servant", true)) {
    servant = new RTM::ManagerServant(facade);
    servant->activate();
    facade.m_mgrservant = servant;
  }
  start_timer_tasks();
  auto locked = state.lock();
  life = std::thread([this] { live(); });
  return {};
}

void ManagerImpl::start_services() {
  coil::Properties local_services;
  {
    const auto mine = config_turn.take();
    if (const auto* node = config.findNode("manager.local_service")) local_services = *node;
  }
  RTM::LocalServiceAdmin::instance().init(local_services);
}

void ManagerImpl::start_logging() {
  LogSettings settings;
  settings.enabled = flag("logger.enable", true);
  settings.level = Logger::parseLevel(value("logger.log_level")).value_or(Logger::RTL_INFO);
  settings.colored = flag("logger.escape_sequence_enable", false);
  settings.date_format = value("logger.date_format");
  settings.clock = base::to_lower(value("logger.clock_type"));
  settings.files.clear();
  for (const auto& pattern : list("logger.file_name")) {
    settings.files.push_back(rt::expand_format(pattern, [&](char c) -> std::optional<std::string> {
      if (c == 'p') return std::to_string(getpid());
      if (c == 'h') return value("os.hostname");
      if (c == 'M' || c == 'n') return value("manager.name");
      return std::nullopt;
    }));
  }
  for (const auto& complaint : setLogSettings(settings)) RTC_ERROR(("%s", complaint.c_str()));
}

// All threads of the process, because they are started later.
void ManagerImpl::bind_to_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  const auto wanted = list("manager.cpu_affinity");
  for (const auto& text : wanted) {
    const auto number = base::parse_integer(text);
    if (number && *number >= 0 && *number < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(*number), &set);
  }
  if (wanted.empty() || (CPU_COUNT(&set) > 0 && sched_setaffinity(0, sizeof set, &set) == 0)) return;
  RTC_WARN(("%smanager.cpu_affinity names no processor of this machine", where("manager.cpu_affinity").c_str()));
}

// What rtc.conf says, else what is said to the tools.
corba::TlsSettings ManagerImpl::tls_settings() const {
  corba::TlsSettings settings = corba::tls_of_environment();
  const auto take = [&](const char* key, std::string& field) {
    if (auto said = value(key); !said.empty()) field = std::move(said);
  };
  take("corba.tls.certificate", settings.certificate);
  take("corba.tls.authority", settings.authority);
  take("corba.tls.password", settings.password);
  settings.endpoints = list("corba.tls.endpoints");
  return settings;
}

base::Result<void> ManagerImpl::start_orb() {
  corba::OrbSettings settings;
  settings.endpoints = list("corba.endpoints");
  for (const auto& endpoint : list("corba.endpoint")) settings.endpoints.push_back(endpoint);
  settings.further_addresses = list("corba.alternate_iiop_addresses");
  const auto families = base::to_lower(value("corba.endpoint_property"));
  settings.ipv6 = families.find("ipv6") != std::string::npos;
  settings.ipv4 = !settings.ipv6 || families.find("ipv4") != std::string::npos;
  settings.arguments = split_arguments(value("corba.args"));
  const auto open_to = base::to_lower(value("corba.open_to"));
  if (open_to == "account") settings.open_to = corba::OpenTo::account;
  if (open_to == "host") settings.open_to = corba::OpenTo::host;
  if (open_to == "network") settings.open_to = corba::OpenTo::network;
  settings.max_request_size = rt::parse_size(value("corba.max_request_size")).value_or(settings.max_request_size);
  settings.tls = tls_settings();
  settings.unix_socket = flag("corba.unix_socket", true);
  settings.call_timeout = to_milliseconds(number("corba.call_timeout", 10.0));
  settings.peer_check_interval = to_milliseconds(number("corba.peer_check_interval", 2.0));
  if (is_master() && settings.endpoints.empty()) {
    const auto address = value("corba.master_manager");
    const auto colon = address.rfind(':');
    if (colon != std::string::npos) settings.endpoints.push_back(address.substr(colon));
  }
  auto started = corba::Orb::start(settings);
  if (!started) return started.error();
  orb = std::move(*started);
  socket_folder = orb->folder();
  std::vector<std::string> ipv4;
  std::vector<std::string> ipv6;
  for (auto& address : orb->addresses()) (address.starts_with('[') ? ipv6 : ipv4).push_back(std::move(address));
  const auto mine = config_turn.take();
  config.setProperty("corba.endpoints_ipv4", base::join(ipv4, ","));
  config.setProperty("corba.endpoints_ipv6", base::join(ipv6, ","));
  return {};
}

void ManagerImpl::start_naming() {
  naming = std::make_unique<NamingManager>(&facade);
  if (!flag("naming.enable", true)) return;
  for (const auto& method : list("naming.type")) {
    const bool by_managers = base::equal_ignoring_case(method, "manager");
    auto servers = list(by_managers ? "manager.nameservers" : "corba.nameservers");
    if (by_managers && !is_master()) servers.push_back(value("corba.master_manager"));
    for (const auto& server : servers) naming->registerNameServer(by_managers ? "manager" : "corba", server.c_str());
  }
}

void ManagerImpl::start_timer_tasks() {
  if (!flag("timer.enable", true)) return;
  if (flag("manager.shutdown_auto", true) && !is_master()) {
    timer->add([this] { look_after_number_of_components(); }, std::chrono::seconds(1), std::chrono::seconds(1));
  }
  // Other processes may hang: what looks after them has a thread of its own.
  peers = std::make_unique<rt::TaskRunner>("rtm-peers");
  constexpr std::chrono::seconds look{2};
  // Other tasks have their turn also while many components have peers that hang.
  const auto look_after_components = [this, look, next = std::size_t{0}]() mutable {
    const auto components = held_components();
    const auto until = steady_clock::now() + look;
    for (std::size_t seen = 0; seen < components.size() && steady_clock::now() < until; ++seen) {
      if (state.lock()->end_requested) return;
      components[next++ % components.size()]->leave_the_dead();
    }
  };
  peers->add(look_after_components, look, look);
  if (servant != nullptr) peers->add([this] { servant->tell_dropped_slaves(); }, look, look);
  // Both spellings are in the documentation.
  const bool greets = flag("manager.update_master_manager.enable", flag("corba.update_master_manager.enable", true));
  if (servant != nullptr && !is_master() && greets) {
    const double every = number("manager.update_master_manager.interval", number("corba.update_master_manager.interval", 10.0));
    const auto interval = std::max(to_milliseconds(every), std::chrono::milliseconds(100));
    peers->add([this] { servant->greet_master(); }, interval, {});
  }
}

// --- activate

bool ManagerImpl::activate() {
  {
    auto locked = state.lock();
    if (locked->phase == Phase::active) return true;
    if (locked->phase != Phase::started) return false;
    locked->phase = Phase::active;
    locked->activating = true;
  }
  const bool ok = activate_all();
  auto locked = state.lock();
  locked->empty_since = steady_clock::now();
  locked->activating = false;
  locked->activated = true;
  changed.notify_all();
  return ok && !locked->end_requested;
}

// What the configuration and the program name, in this order.
bool ManagerImpl::activate_all() {
  orb->activate();
  if (servant != nullptr && (is_master() || options.bind_manager)) {
    for (const auto& format : list("manager.naming_formats")) {
      const auto name = rt::expand_format(format, [&](char c) -> std::optional<std::string> {
        if (c == 'n') return rt::escape_name(value("manager.instance_name"));
        if (c == 'h') return rt::escape_name(value("os.hostname"));
        if (c == 'M') return rt::escape_name(value("manager.name"));
        if (c == 'p') return std::to_string(getpid());
        return std::nullopt;
      });
      // One host of several on a machine is enough to be asked by this name; which one it is, is nobody's fault.
      if (is_master())
        naming->bindObject(name.c_str(), servant);
      else
        naming->bindUnlessTaken(name.c_str(), servant);
    }
  }

  std::vector<std::string> preload = list("manager.modules.preload");
  for (const auto& key : {"manager.preload.modules", "logger.plugins", "manager.local_service.modules"}) {
    for (const auto& module : list(key)) preload.push_back(module);
  }
  for (const auto& module : preload) facade.load(module);
  for (const auto& id : LogstreamFactory::instance().getIdentifiers()) {
    auto* plugin = LogstreamFactory::instance().createObject(id);
    coil::Properties node;
    {
      const auto mine = config_turn.take();
      if (const auto* found = config.findNode("logger.logstream." + id)) node = *found;
    }
    if (plugin == nullptr) continue;
    if (node.size() == 0 || !plugin->init(node)) {
      LogstreamFactory::instance().deleteObject(plugin);
      continue;
    }
    if (plugin->getStreamBuffer() != nullptr) addLogStreamBuffer(plugin->getStreamBuffer());
    log_plugins.push_back(plugin);
  }

  if (init_proc != nullptr) {
    try {
      init_proc(&facade);
    } catch (const std::exception& e) {
      RTC_ERROR(("the module init function failed: %s", e.what()));
    } catch (...) {
      RTC_ERROR(("the module init function failed with an unknown exception"));
    }
  }
  bool ok = true;
  for (const auto& module : options.modules) ok = load_and_create(module) && ok;
  for (const auto& argument : list("manager.components.precreate")) facade.createComponent(argument);
  facade.connectPorts(value("manager.components.preconnect"));
  facade.activateComponents(value("manager.components.preactivation"));
  on_exit(&end_at_exit, nullptr);  // again: before what has been made meanwhile is destroyed
  return ok;
}

void ManagerImpl::report(const std::string& error) {
  std::string end;
  if (corba::has_caller()) {
    const auto left_out = rejection_limiter.next();
    if (!left_out) return;
    end = rt::LogRateLimiter::omitted_text(*left_out);
  }
  RTC_ERROR(("%s%s", error.c_str(), end.c_str()));
  const auto outputs = list("logger.file_name");
  const bool is_logged_there = flag("logger.enable", true) && std::find(outputs.begin(), outputs.end(), "stderr") != outputs.end();
  if (state.lock()->activating && !is_logged_there) std::cerr << program << ": " << error << std::endl;
}

// A manager that nobody ever gave a component ends after a while, so that forgotten processes go away.
void ManagerImpl::look_after_number_of_components() {
  if (!flag("manager.shutdown_on_nortcs", true) || is_master()) return;
  const auto duration = to_milliseconds(number("manager.auto_shutdown_duration", 20.0));
  bool is_over = false;
  {
    auto locked = state.lock();
    if (!locked->records.empty() || locked->phase != Phase::active) locked->empty_since = steady_clock::now();
    is_over = steady_clock::now() - locked->empty_since >= duration;
  }
  if (!is_over) return;
  RTC_INFO(("no component for %g s: ending", static_cast<double>(duration.count()) / 1000.0));
  request_end();
}

// --- end

bool ManagerImpl::is_ending() const {
  const auto phase = state.lock()->phase;
  return phase == Phase::ending || phase == Phase::ended;
}

void ManagerImpl::request_end() {
  state.lock()->end_requested = true;
  changed.notify_all();
}

void ManagerImpl::wait_until_ended() {
  while (!wait_until_ended(std::chrono::hours(1))) {
  }
}

bool ManagerImpl::wait_until_ended(std::chrono::nanoseconds timeout) {
  {
    auto locked = state.lock();
    if (!locked.wait_for(changed, timeout, [&] { return locked->life_is_over || locked->phase == Phase::created; })) return false;
  }
  // The thread has done its work; whoever comes first takes it in, nobody goes on before that.
  std::thread finished;
  {
    auto locked = state.lock();
    if (!locked->life_is_over || life.get_id() == std::this_thread::get_id()) return true;
    finished.swap(life);
    if (!finished.joinable()) return locked.wait_for(changed, timeout, [&] { return locked->life_is_taken_in; });
  }
  finished.join();
  state.lock()->life_is_taken_in = true;
  changed.notify_all();
  return true;
}

}  // namespace RTC
