// The manager: loads modules, makes components, names, connects and deletes them; one per process. Any thread.
// No lock is held while components, listeners, modules or other processes are called. Components are deleted on the manager's own thread.
#pragma once

#include <rtm/ECFactory.h>
#include <rtm/Factory.h>
#include <rtm/ManagerActionListener.h>
#include <rtm/ObjectManager.h>
#include <rtm/RTC.h>
#include <rtm/SystemLogger.h>

// Authors rely on some of these headers without naming them.
#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/Properties.h>
#include <coil/Signal.h>
#include <coil/Task.h>
#include <coil/Timer.h>
#include <coil/stringutil.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace RTM {
class ManagerServant;
class ManagerActionListener;
class ModuleActionListener;
class RtcLifecycleActionListener;
class NamingActionListener;
class LocalServiceActionListener;
struct ManagerActionListeners;
}  // namespace RTM

namespace RTC {

class CorbaNaming;
class ExecutionContextBase;
class LogStreamBuf;
class Manager;
class ManagerImpl;
class ModuleManager;
class NamingManager;

using ModuleInitProc = void (*)(Manager* manager);

// What a manager is started with, besides the command line.
struct ManagerOptions {
  bool strict_arguments = false;       // rtcd: an unknown option or a bare argument is an error; else the program's own affair
  bool bind_manager = false;           // rtcd: the manager has an entry of its own in the naming service although it is no master
  std::vector<std::string> modules{};  // rtcd: files, names to load, or `Name?args` to create, after the modules of the configuration
};

class Manager {
 public:
  // Reads the command line (-a -d -f FILE -i -o KEY:VALUE -p PORT) and rtc.conf and starts the manager of this process; later calls return
  // the same one. When that fails the reason goes to stderr in one line and the process exits: 2 for a bad command line, 1 for anything
  // else.
  static Manager* init(int argc, char** argv);
  static Manager* init(int argc, char** argv, const ManagerOptions& options);
  // The manager of this process, started without arguments if nobody has called init.
  static Manager& instance();
  // The manager if there is one.
  static Manager* instance_if_any();
  // A manager without ORB, threads and naming that only records what a module registers: for reading a module's profile.
  static Manager& profile_reader();

  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  // Asks the manager to end, from any thread, and returns at once; runManager or join then does the work.
  void terminate();
  // Ends now: components finalized and deleted, names unbound, ORB destroyed. On a thread that belongs to a component or the ORB it only
  // asks.
  void shutdown();
  // Waits until shutdown is complete.
  void join();

  // Called by activateManager after the modules of the configuration are loaded and before its components are created.
  void setModuleInitProc(ModuleInitProc proc);
  // Lets requests in, loads, creates, connects and activates what the configuration names. False if the manager is ending.
  bool activateManager();
  // Blocks until the manager is told to end (signal, terminate, tools, last component gone) and shuts it down. no_block: that happens on a
  // thread of its own.
  void runManager(bool no_block = false);
  // From init until somebody asks it to end.
  bool isRunning() const;

  coil::Properties& getConfig();
  // A copy of one value, safe while others change the configuration.
  std::string configValue(const std::string& key) const;
  Logger& getLogger();
  int getLogLevel();
  // Where stream buffers are added that want the log too; <rtm/LogstreamBase.h> has its class.
  LogStreamBuf& getLogStreamBuf();

  // --- modules
  // RTC_OK also when it is loaded already. fname: a file, found in manager.modules.load_path unless it is a path. initfunc: the function to
  // call, default `<file base>Init`.
  ReturnCode_t load(const std::string& fname, const std::string& initfunc = "");
  // PRECONDITION_NOT_MET while a component of the module exists, BAD_PARAMETER if it is not loaded.
  ReturnCode_t unload(const char* fname);
  void unloadAll();
  // One entry per module: file_path, and what get_loaded_modules publishes.
  std::vector<coil::Properties> getLoadedModules();
  // Profiles of the modules in manager.modules.load_path, each read in a process of its own.
  std::vector<coil::Properties> getLoadableModules();

  // --- factories
  // False if a factory of the same id (vendor, category, implementation_id, language, version) exists.
  bool registerFactory(coil::Properties& profile, RtcNewFunc new_func, RtcDeleteFunc delete_func);
  std::vector<coil::Properties> getFactoryProfiles();
  bool registerECFactory(const char* name, ExecutionContextBase* (*create)(), void (*destroy)(ExecutionContextBase*));
  std::vector<std::string> getModulesFactories();

  // --- components
  // `Type`, `Type?key=value&...` or `RTC:vendor:category:Type:language:version?...`. nullptr, and the reason in the log, on failure.
  RTObject_impl* createComponent(const std::string& comp_args);
  RTObject_impl* createComponent(const char* comp_args);
  // Components that others made. False if one of that name exists.
  bool registerComponent(RTObject_impl* comp);
  bool unregisterComponent(RTObject_impl* comp);
  // 1.x: gives a component that has no execution context yet its own; true also when it has one. initialize() does it by itself.
  bool bindExecutionContext(RTObject_impl* comp);
  // Finalizes it (RTObject::exit); it is deleted a little later.
  void deleteComponent(RTObject_impl* comp);
  // BAD_PARAMETER if there is none of that name.
  ReturnCode_t deleteComponent(const char* instance_name);
  // By instance name; nullptr if there is none. Valid until the component is deleted.
  RTObject_impl* getComponent(const char* instance_name);
  RTObject_impl* getComponent(const std::string& instance_name) { return getComponent(instance_name.c_str()); }
  std::vector<RTObject_impl*> getComponents();
  // A finalized component says so here; the manager takes its names out of the naming service and deletes it on its own thread.
  void notifyFinalized(RTObject_impl* comp);
  // Deletes what has been finalized; waits until that is done (not from a component's or the ORB's thread).
  void cleanupComponents();
  // Makes `<comp>.<port>?port=...` connections and activations as the keys preconnect and preactivation do.
  void connectPorts(const std::string& preconnect);
  void activateComponents(const std::string& preactivation);
  // What createComponent does with ports that have a topic (port properties publish_topic, subscribe_topic, rendezvous_point): binds them,
  // and connects them with those that others have bound. For ports that are added later.
  void publishPorts(RTObject_impl* comp);
  void subscribePorts(RTObject_impl* comp);

  // --- listeners; with autoclean the manager deletes them
  void addManagerActionListener(RTM::ManagerActionListener* listener, bool autoclean = true);
  void removeManagerActionListener(RTM::ManagerActionListener* listener);
  void addModuleActionListener(RTM::ModuleActionListener* listener, bool autoclean = true);
  void removeModuleActionListener(RTM::ModuleActionListener* listener);
  void addRtcLifecycleActionListener(RTM::RtcLifecycleActionListener* listener, bool autoclean = true);
  void removeRtcLifecycleActionListener(RTM::RtcLifecycleActionListener* listener);
  void addNamingActionListener(RTM::NamingActionListener* listener, bool autoclean = true);
  void removeNamingActionListener(RTM::NamingActionListener* listener);
  void addLocalServiceActionListener(RTM::LocalServiceActionListener* listener, bool autoclean = true);
  void removeLocalServiceActionListener(RTM::LocalServiceActionListener* listener);
  RTM::ManagerActionListeners& listeners();

  // --- the ORB; the pointers are borrowed
  CORBA::ORB_ptr getORB();
  CORBA::ORB_ptr theORB() { return getORB(); }
  PortableServer::POA_ptr getPOA();
  PortableServer::POA_ptr thePOA() { return getPOA(); }
  // Calls inside a process are short in every adapter.
  PortableServer::POA_ptr theShortCutPOA() { return getPOA(); }
  PortableServer::POAManager_ptr getPOAManager();
  PortableServer::POAManager_ptr thePOAManager() { return getPOAManager(); }
  RTM::ManagerServant& getManagerServant();
  NamingManager* getNaming();

  // --- tasks on the manager's thread; they must be short
  using TaskId = std::uint64_t;
  // Runs `task` every `period`, first after `delay`, until removeTask (which waits for a run in progress, except on the task's own thread).
  TaskId addTask(std::function<void()> task, std::chrono::nanoseconds period, std::chrono::nanoseconds delay = std::chrono::nanoseconds(0));
  bool removeTask(TaskId id);
  // Runs `task` once, soon.
  void invoke(std::function<void()> task);

 protected:
  // Hosts of components reach the servant through a class derived from this one. nullptr if there is none: before init, after shutdown, or
  // with manager.corba_servant NO.
  RTM::ManagerServant* m_mgrservant = nullptr;

 private:
  friend class ManagerImpl;
  friend class ModuleManager;
  friend class NamingManager;
  friend class RTM::ManagerServant;
  Manager();
  ~Manager();
  std::unique_ptr<ManagerImpl> impl_;
};

}  // namespace RTC
