#include "rtm/Manager.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "base/abnormal_exit.h"
#include "base/log.h"
#include "base/text.h"
#include "manager/manager_impl.h"
#include "rtm/ECFactory.h"
#include "rtm/ManagerConfig.h"
#include "rtm/ManagerServant.h"
#include "rtm/ModuleManager.h"
#include "rtm/NamingManager.h"

namespace RTM::detail {

void log_listener_exception() {
  try {
    throw;
  } catch (const std::exception& e) {
    base::log(base::Level::error, "manager", "a listener failed: {}", e.what());
  } catch (...) {
    base::log(base::Level::error, "manager", "a listener failed with an unknown exception");
  }
}

}  // namespace RTM::detail

namespace RTC {
namespace {

struct Place {
  Manager* manager = nullptr;              // lives until the process ends: components' and the ORB's threads may outlive main()
  std::optional<std::thread::id> starter;  // a thread starts it; nobody else sees it before it can be used
};
base::Guarded<Place, base::Rank::log> the_place;  // asked for under any lock
std::condition_variable has_started;

// Waits while another thread starts it. No code of authors runs meanwhile, so that start waits for nobody who asks here.
Manager* the_manager() {
  auto place = the_place.lock();
  const auto is_for_us = [&] { return !place->starter || *place->starter == std::this_thread::get_id(); };
  while (!place.wait_for(has_started, std::chrono::hours(1), is_for_us)) {
  }
  return place->manager;
}

// True for the one thread that is to start it.
bool takes_the_start(Manager* found) {
  auto place = the_place.lock();
  if (place->starter || place->manager != found) return false;
  place->starter = std::this_thread::get_id();
  return true;
}

std::string base_name(const char* path) {
  const std::string text(path != nullptr ? path : "rtm");
  return text.substr(text.rfind('/') + 1);
}

[[noreturn]] void give_up(int argc, char** argv, int code, const std::string& message) {
  std::cerr << base_name(argc > 0 ? argv[0] : nullptr) << ": " << message << std::endl;
  std::exit(code);
}

}  // namespace

thread_local std::string ManagerImpl::current_module;

// A program that leaves main() without ending the manager: it is ended before statics and libraries go away. When a component keeps that
// from happening the process ends as it is.
void ManagerImpl::end_at_exit(int status, void*) {
  constexpr std::chrono::seconds timeout{10};
  const Manager* manager = Manager::instance_if_any();
  if (manager == nullptr) return;
  if (base::report_exit_in_callback(status)) manager->impl_->end_in_callback(status);
  manager->impl_->request_end();
  if (manager->impl_->wait_until_ended(timeout)) return;
  manager->impl_->remove_files();
  ManagerImpl::flush_streams();
  _exit(status);
}

ManagerImpl::ManagerImpl(Manager& manager) : facade(manager) {}

ManagerImpl::~ManagerImpl() {
  if (life.joinable()) life.join();
}

// --- settings

std::string ManagerImpl::value(const std::string& key) const {
  const auto mine = config_turn.take();
  return static_cast<const coil::Properties&>(config).getProperty(key);
}

bool ManagerImpl::flag(const std::string& key, bool otherwise) const { return base::parse_bool(value(key)).value_or(otherwise); }
double ManagerImpl::number(const std::string& key, double otherwise) const { return base::parse_number(value(key)).value_or(otherwise); }
std::vector<std::string> ManagerImpl::list(const std::string& key) const { return base::split_list(value(key)); }

std::string ManagerImpl::where(const std::string& key) const {
  const auto at = origins.find(key);
  return at == origins.end() ? std::string() : at->second + ": ";
}

// --- facade

Manager::Manager() : impl_(std::make_unique<ManagerImpl>(*this)) {}
Manager::~Manager() = default;

Manager* Manager::init(int argc, char** argv) { return init(argc, argv, ManagerOptions{}); }

Manager* Manager::init(int argc, char** argv, const ManagerOptions& options) {
  auto* manager = the_manager();
  const auto lives = [](const Manager* one) { return one != nullptr && one->impl_->state.lock()->phase != ManagerImpl::Phase::ended; };
  while (!lives(manager) && !takes_the_start(manager)) manager = the_manager();
  if (lives(manager)) return manager;
  ManagerConfig config;
  if (!config.init(argc, argv, options.strict_arguments)) give_up(argc, argv, config.exitCode(), config.error());
  if (manager == nullptr) {
    manager = new Manager;
    the_place.lock()->manager = manager;
  } else {
    manager->impl_ = std::make_unique<ManagerImpl>(*manager);
  }
  manager->impl_->program = base_name(argc > 0 ? argv[0] : nullptr);
  if (auto started = manager->impl_->start(config, options); !started) give_up(argc, argv, 1, started.error().message);
  the_place.lock()->starter.reset();
  has_started.notify_all();
  manager->impl_->start_services();
  on_exit(&ManagerImpl::end_at_exit, nullptr);
  base::report_fatal_signals();
  return manager;
}

Manager& Manager::instance() {
  if (auto* manager = instance_if_any()) return *manager;
  return *init(0, nullptr);
}

Manager* Manager::instance_if_any() { return the_manager(); }

Manager& Manager::profile_reader() {
  static Manager& reader = *new Manager;
  return reader;
}

void Manager::terminate() { impl_->request_end(); }

void Manager::shutdown() {
  terminate();
  if (std::this_thread::get_id() == impl_->home) join();
}

void Manager::join() { impl_->wait_until_ended(); }

void Manager::setModuleInitProc(ModuleInitProc proc) { impl_->init_proc = proc; }
bool Manager::activateManager() { return impl_->activate(); }

void Manager::runManager(bool no_block) {
  ++impl_->state.lock()->runners;
  impl_->changed.notify_all();
  if (no_block) return;  // the life thread does the rest
  impl_->wait_until_ended();
}

bool Manager::isRunning() const {
  auto locked = impl_->state.lock();
  return !locked->end_requested && (locked->phase == ManagerImpl::Phase::started || locked->phase == ManagerImpl::Phase::active);
}

coil::Properties& Manager::getConfig() { return impl_->config; }
std::string Manager::configValue(const std::string& key) const { return impl_->value(key); }
Logger& Manager::getLogger() { return impl_->rtclog; }
int Manager::getLogLevel() { return impl_->rtclog.getLevel(); }
LogStreamBuf& Manager::getLogStreamBuf() { return impl_->log_buffers; }

ReturnCode_t Manager::load(const std::string& fname, const std::string& initfunc) {
  if (impl_->modules == nullptr || impl_->is_ending()) return PRECONDITION_NOT_MET;
  std::string file = fname;
  std::string function = initfunc;
  impl_->listeners.module_.call(&RTM::ModuleActionListener::preLoad, file, function);
  std::string error;
  const auto code = impl_->modules->load(file, function, error);
  auto& rtclog = impl_->rtclog;
  if (code != RTC_OK) {
    impl_->report(error);
  } else {
    RTC_DEBUG(("module %s loaded", file.c_str()));
  }
  impl_->listeners.module_.call(&RTM::ModuleActionListener::postLoad, file, function);
  return code;
}

ReturnCode_t Manager::unload(const char* fname) {
  if (impl_->modules == nullptr || fname == nullptr) return PRECONDITION_NOT_MET;
  std::string file = fname;
  impl_->listeners.module_.call(&RTM::ModuleActionListener::preUnload, file);
  const auto code = impl_->modules->unload(file);
  impl_->listeners.module_.call(&RTM::ModuleActionListener::postUnload, file);
  return code;
}

void Manager::unloadAll() {
  if (impl_->modules != nullptr) impl_->modules->unloadAll();
}

std::vector<coil::Properties> Manager::getLoadedModules() {
  return impl_->modules != nullptr ? impl_->modules->getLoadedModules() : std::vector<coil::Properties>();
}

std::vector<coil::Properties> Manager::getLoadableModules() {
  return impl_->modules != nullptr ? impl_->modules->getLoadableModules() : std::vector<coil::Properties>();
}

bool Manager::registerECFactory(const char* name, ExecutionContextBase* (*create)(), void (*destroy)(ExecutionContextBase*)) {
  if (name == nullptr || create == nullptr || destroy == nullptr) return false;
  const auto destroy_and_forget = [destroy](ExecutionContextBase*& context) {
    destroy(context);
    context = nullptr;
  };
  return ExecutionContextFactory::instance().addFactory(name, create, destroy_and_forget) == coil::FactoryReturn::OK;
}

void Manager::addManagerActionListener(RTM::ManagerActionListener* listener, bool autoclean) {
  impl_->listeners.manager_.addListener(listener, autoclean);
}
void Manager::removeManagerActionListener(RTM::ManagerActionListener* listener) { impl_->listeners.manager_.removeListener(listener); }
void Manager::addModuleActionListener(RTM::ModuleActionListener* listener, bool autoclean) {
  impl_->listeners.module_.addListener(listener, autoclean);
}
void Manager::removeModuleActionListener(RTM::ModuleActionListener* listener) { impl_->listeners.module_.removeListener(listener); }
void Manager::addRtcLifecycleActionListener(RTM::RtcLifecycleActionListener* listener, bool autoclean) {
  impl_->listeners.rtclifecycle_.addListener(listener, autoclean);
}
void Manager::removeRtcLifecycleActionListener(RTM::RtcLifecycleActionListener* listener) {
  impl_->listeners.rtclifecycle_.removeListener(listener);
}
void Manager::addNamingActionListener(RTM::NamingActionListener* listener, bool autoclean) {
  impl_->listeners.naming_.addListener(listener, autoclean);
}
void Manager::removeNamingActionListener(RTM::NamingActionListener* listener) { impl_->listeners.naming_.removeListener(listener); }
void Manager::addLocalServiceActionListener(RTM::LocalServiceActionListener* listener, bool autoclean) {
  impl_->listeners.localservice_.addListener(listener, autoclean);
}
void Manager::removeLocalServiceActionListener(RTM::LocalServiceActionListener* listener) {
  impl_->listeners.localservice_.removeListener(listener);
}
RTM::ManagerActionListeners& Manager::listeners() { return impl_->listeners; }

CORBA::ORB_ptr Manager::getORB() { return impl_->orb ? impl_->orb->orb() : CORBA::ORB::_nil(); }
PortableServer::POA_ptr Manager::getPOA() { return impl_->orb ? impl_->orb->root_poa() : PortableServer::POA::_nil(); }
PortableServer::POAManager_ptr Manager::getPOAManager() {
  return impl_->orb ? impl_->orb->poa_manager() : PortableServer::POAManager::_nil();
}
RTM::ManagerServant& Manager::getManagerServant() {
  if (impl_->servant == nullptr) throw CORBA::OBJECT_NOT_EXIST();  // manager.corba_servant is NO, or the manager has ended
  return *impl_->servant;
}
NamingManager* Manager::getNaming() { return impl_->naming.get(); }

Manager::TaskId Manager::addTask(std::function<void()> task, std::chrono::nanoseconds period, std::chrono::nanoseconds delay) {
  return impl_->timer ? impl_->timer->add(std::move(task), period, delay) : 0;
}
bool Manager::removeTask(TaskId id) { return impl_->timer && impl_->timer->remove(id); }
void Manager::invoke(std::function<void()> task) {
  if (impl_->timer) impl_->timer->post(std::move(task));
}

}  // namespace RTC
