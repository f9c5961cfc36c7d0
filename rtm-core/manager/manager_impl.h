// The state of RTC::Manager; shared by its source files only. Any thread, unless a function says otherwise.
#pragma once

#include <condition_variable>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "component/managed.h"
#include "corba/orb/orb.h"
#include "core/component_argument.h"
#include "core/key_limits.h"
#include "core/log_rate_limiter.h"
#include "core/signal_watcher.h"
#include "core/task_runner.h"
#include "rtm/LogstreamBase.h"
#include "rtm/Manager.h"
#include "rtm/ManagerActionListener.h"
#include "rtm/NumberingPolicyBase.h"

namespace RTM {
class ManagerServant;
}

namespace RTC {

// The value of manager.modules.load_path for a message, with a hint when it looks like a PATH.
std::string described_load_path(const std::string& value);

class ManagerConfig;
class ModuleManager;
class NamingManager;

class ManagerImpl {
 public:
  enum class Phase { created, started, active, ending, ended };

  struct RegisteredFactory {
    std::shared_ptr<FactoryBase> factory;
    std::string module;  // the file it came from; empty for the program itself
  };

  // A component of this manager, from the moment its creator returned it until its deletion.
  struct Record {
    std::uint64_t id = 0;
    RTObject_impl* component = nullptr;
    std::shared_ptr<FactoryBase> factory;  // none for components that others registered
    std::string module;
    std::string instance_name;
    std::vector<std::string> names;       // in the naming service
    std::vector<std::string> port_names;  // those of ports with a topic
    std::string object_key;
    bool listed = false;     // getComponents shows it
    bool numbered = false;   // the numbering policy knows it
    bool finalized = false;  // on its way to deletion
  };

  struct State {
    Phase phase = Phase::created;
    bool end_requested = false;
    bool is_hurried = false;        // by a signal: whoever sent it kills the process soon
    bool life_is_over = false;      // the life thread has done its work
    bool life_is_taken_in = false;  // and is joined
    int runners = 0;                // threads in runManager
    std::vector<RegisteredFactory> factories;
    std::map<std::uint64_t, Record> records;
    std::uint64_t last_id = 0;
    std::set<std::string> reserved_names;
    bool activating = false;  // a thread is in activate
    bool activated = false;   // everything that the configuration names has been made
    bool had_components = false;
    std::vector<Record> abandoned;  // gone for everybody, but in memory as long as a thread is in one of their callbacks
    std::string step;               // of the end
    std::chrono::steady_clock::time_point step_since{};
    std::chrono::steady_clock::time_point empty_since = std::chrono::steady_clock::now();
  };

  static ManagerImpl& of(Manager& manager) { return *manager.impl_; }
  explicit ManagerImpl(Manager& facade);
  ~ManagerImpl();

  // --- life (life.cpp)
  // Starts ORB, threads and naming. One line on failure.
  base::Result<void> start(const ManagerConfig& config, const ManagerOptions& options);
  // When other threads may already use the manager, and a signal ends it: local services are authors' code.
  void start_services();
  bool activate();
  // As the logger.* keys say now.
  void start_logging();
  void request_end();
  void wait_until_ended();
  bool wait_until_ended(std::chrono::nanoseconds timeout);
  bool is_ending() const;
  static void end_at_exit(int status, void*);
  std::string value(const std::string& key) const;
  bool flag(const std::string& key, bool otherwise) const;
  double number(const std::string& key, double otherwise) const;
  std::vector<std::string> list(const std::string& key) const;
  // Where the key was set, as the beginning of a message: `rtc.conf:12: `; empty when nobody has set it.
  std::string where(const std::string& key) const;
  std::string where_if(const std::string& text, const std::string& key) const;  // empty unless the key has that value
  bool is_master() const { return flag("manager.is_master", false); }

  // --- components (creation.cpp, components.cpp, connections.cpp, topics.cpp)
  bool register_factory(const coil::Properties& profile, RtcNewFunc create, RtcDeleteFunc destroy);
  bool register_factory(std::shared_ptr<FactoryBase> factory);
  std::optional<RegisteredFactory> find_factory(const rt::ComponentId& id) const;
  // The record of a component that is still to be made, with its factory; nothing when there is no factory of that type.
  std::optional<Record> take_place(const rt::ComponentId& id);
  // How many components of the module exist, or are being made; without any, its factories are removed.
  std::size_t forget_module(const std::string& module);
  base::Result<RTObject_impl*> create(std::string argument);
  void finalized(RTObject_impl* component);
  void destroy(std::uint64_t id);
  void delete_abandoned();
  // Puts the component's names into the naming service and its key into the ORB, and takes them out.
  void publish(const Record& record);
  void withdraw(const Record& record);
  std::vector<Record> records() const;
  std::optional<Record> record_of(const RTObject_impl* component) const;
  // Components in the list, held, so that none is deleted while it is used. One: null if there is none.
  using Held = std::shared_ptr<Managed>;
  std::vector<Held> held_components() const;
  Held held_component(const std::string& instance_name) const;
  Held held_component(const RTObject_impl* component) const;
  base::Result<void> connect(const std::string& request);
  base::Result<void> activate_component(const std::string& name);
  // By instance name here, else by URL; nil if there is none.
  RTObject_var find_component(const std::string& name);
  // Binds the component's ports that have a topic and connects them with the others that have it.
  void publish_ports(const Managed& component);
  void subscribe_ports(const Managed& component);
  bool load_and_create(const std::string& module);
  // Logs why something could not be loaded or created. While the program starts, stderr gets the line too, unless the log goes there.
  // Errors in calls from other processes are logged within the limit of `rejection_limiter`.
  void report(const std::string& error);
  // Where the manager of this process would find a module; empty if nowhere, or if there is no manager.
  static std::string module_file(const std::string& module);

  Manager& facade;
  Logger rtclog{"manager"};
  LogStreamBuf log_buffers;
  // Between our own readers and writers of config; authors reach it as they like. Held for copies alone.
  mutable base::Turn<base::Rank::log> config_turn;
  coil::Properties config;
  rt::KeysOfCallers keys_of_callers;           // with the turn
  std::map<std::string, std::string> origins;  // of ManagerConfig
  ManagerOptions options;
  std::string program;  // its name in messages
  ModuleInitProc init_proc = nullptr;
  RTM::ManagerActionListeners listeners;
  base::Guarded<State, base::Rank::manager> state;
  std::condition_variable changed;
  std::unique_ptr<corba::Orb> orb;
  std::unique_ptr<rt::TaskRunner> timer;
  std::unique_ptr<rt::TaskRunner> cleaner;
  std::unique_ptr<rt::TaskRunner> peers;
  std::unique_ptr<NamingManager> naming;
  rt::LogRateLimiter rejection_limiter{32};  // calls of other processes that are rejected or fail
  std::unique_ptr<ModuleManager> modules;
  RTM::ManagerServant* servant = nullptr;  // we hold one reference
  std::thread::id home;                    // the thread that called init

  // The module whose init function runs on this thread.
  static thread_local std::string current_module;

 private:
  bool activate_all();
  void bind_to_processors();
  corba::TlsSettings tls_settings() const;
  base::Result<void> start_orb();
  void start_naming();
  void start_timer_tasks();
  void live();
  // The end (end.cpp)
  class EndWatch;
  void end();
  void remove_files() const;
  void begin_step(std::string step);
  void exit_all_components();
  std::chrono::nanoseconds callback_timeout() const;
  // Every component that is in memory, held.
  std::vector<Held> all_components() const;
  bool is_callback_running(std::chrono::nanoseconds at_least) const;
  void complain_about_callbacks() const;
  void answer_last_calls();
  [[noreturn]] void give_up(const std::string& step);
  [[noreturn]] void end_in_callback(int status);
  static void flush_streams();  // of the C library; in a second, or not
  void look_after_number_of_components();

  coil::Properties inherited_properties() const;
  coil::Properties configured_properties(const std::string& category, const std::string& name);
  coil::Properties properties_of_file(const std::string& named_by, const std::string& file);
  // nullptr when the argument names no component of that type.
  RTObject_impl* existing_component(const rt::ComponentArgument& argument, const coil::Properties& profile) const;
  base::Result<std::string> name_component(const Managed& component, const rt::ComponentArgument& argument, bool& numbered);
  std::vector<std::string> naming_names(const Managed& component, const coil::Properties& properties) const;
  base::Result<RTObject_impl*> finish_creation(const Record& place, const rt::ComponentArgument& argument);
  base::Result<RTObject_impl*> try_to_finish_creation(const Record& place, const rt::ComponentArgument& argument);
  // Policies are called one at a time, user-written or not; one may ask the manager for anything, another component included.
  base::UsersTurn numbering_turn;
  static constexpr std::chrono::seconds numbering_timeout{30};  // more than a policy that asks a naming service which hangs
  RTM::NumberingPolicyBase* numbering = nullptr;
  std::unique_ptr<rt::SignalWatcher> signals;
  std::vector<LogstreamBase*> log_plugins;
  std::thread life;           // in a lock of the state; taken in by whoever sees it end
  std::string socket_folder;  // of the ORB; empty if none
};

}  // namespace RTC
