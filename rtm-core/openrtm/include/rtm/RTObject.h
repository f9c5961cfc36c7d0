// A component: servant of OpenRTM::DataFlowComponent and base class of all components that authors write. Its operations may be called from
// any thread. Callbacks: onInitialize, onFinalize, onStartup, onShutdown and onRateChanged run on the caller's thread, all others on the
// thread of the execution context. What a callback throws becomes RTC_ERROR and one log line. No lock is held while a callback runs.
//
// Callbacks of one component never run at the same time, for all callers: its own contexts, contexts of other components or processes, the
// wire. A call that comes while a callback runs waits (component/outside_calls.h says how long), and a callback that calls another one of
// its component on its own thread does so at once. Component action listeners and listeners of updated parameters belong to the callback
// that they stand around. All other listeners, and the operations of a component's services, run on the thread of the caller, beside
// callbacks.
#pragma once

#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/OS.h>
#include <coil/Properties.h>
#include <coil/Time.h>
#include <rtm/CORBA_SeqUtil.h>
#include <rtm/ComponentActionListener.h>
#include <rtm/ConfigAdmin.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/NVUtil.h>
#include <rtm/PortConnectListener.h>
#include <rtm/RTC.h>
#include <rtm/SystemLogger.h>
#include <rtm/idl/OpenRTMSkel.h>

// Authors rely on some of these headers without naming them: coil/Time.h, Mutex.h, Guard.h, OS.h, CORBA_SeqUtil.h, NVUtil.h, iostream.
#include <chrono>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

namespace SDOPackage {
class Organization_impl;
}

namespace RTC {

class InPortBase;
class Manager;
class OutPortBase;
class PortBase;
class SdoServiceAdmin;
class SdoServiceProviderBase;

class RTObject_impl : public virtual POA_OpenRTM::DataFlowComponent, public virtual PortableServer::RefCountServantBase {
 public:
  explicit RTObject_impl(Manager* manager);
  RTObject_impl(CORBA::ORB_ptr orb, PortableServer::POA_ptr poa);
  ~RTObject_impl() override;

 protected:
  // What authors replace.
  virtual ReturnCode_t onInitialize();
  virtual ReturnCode_t onFinalize();
  virtual ReturnCode_t onStartup(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onShutdown(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onActivated(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onDeactivated(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onExecute(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onAborting(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onError(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onReset(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onStateUpdate(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onRateChanged(RTC::UniqueId exec_handle);
  virtual ReturnCode_t onAction(RTC::UniqueId exec_handle);

 public:
  // RTC::LightweightRTObject
  ReturnCode_t initialize() override;
  ReturnCode_t finalize() override;
  // From inside a callback it returns at once and happens after the cycle. Waits for callbacks of this component that run: those that do
  // not return within the property exec_cxt.callback_timeout (5 s), all together, are named in the log; the component is then gone for
  // everybody else but must not be deleted before they return.
  ReturnCode_t exit() override;
  CORBA::Boolean is_alive(ExecutionContext_ptr exec_context) override;
  ExecutionContext_ptr get_context(ExecutionContextHandle_t exec_handle) override;
  ExecutionContextList* get_owned_contexts() override;
  ExecutionContextList* get_participating_contexts() override;
  ExecutionContextHandle_t get_context_handle(ExecutionContext_ptr cxt) override;
  ExecutionContextHandle_t attach_context(ExecutionContext_ptr exec_context) override;
  ReturnCode_t detach_context(ExecutionContextHandle_t exec_handle) override;
  // -1 when the context is nil or no context.
  UniqueId bindContext(ExecutionContext_ptr exec_context);

  // RTC::ComponentAction and DataFlowComponentAction: what execution contexts, here and elsewhere, call. Over the wire a context of another
  // process, with the handle that attach_context has given it; all others get PRECONDITION_NOT_MET (component/outside_calls.h).
  ReturnCode_t on_initialize() override;
  ReturnCode_t on_finalize() override;
  ReturnCode_t on_startup(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_shutdown(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_activated(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_deactivated(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_aborting(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_error(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_reset(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_execute(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_state_update(ExecutionContextHandle_t exec_handle) override;
  ReturnCode_t on_rate_changed(ExecutionContextHandle_t exec_handle) override;

  // RTC::RTObject
  ComponentProfile* get_component_profile() override;
  PortServiceList* get_ports() override;

  // SDOPackage::SDO
  SDOPackage::OrganizationList* get_owned_organizations() override;
  char* get_sdo_id() override;
  char* get_sdo_type() override;
  SDOPackage::DeviceProfile* get_device_profile() override;
  SDOPackage::ServiceProfileList* get_service_profiles() override;
  SDOPackage::ServiceProfile* get_service_profile(const char* id) override;
  SDOPackage::SDOService_ptr get_sdo_service(const char* id) override;
  SDOPackage::Configuration_ptr get_configuration() override;
  SDOPackage::Monitoring_ptr get_monitoring() override;
  SDOPackage::OrganizationList* get_organizations() override;
  SDOPackage::NVList* get_status_list() override;
  CORBA::Any* get_status(const char* name) override;

  // What the component is.
  const char* getInstanceName() const { return profile_.instance_name.c_str(); }
  void setInstanceName(const char* instance_name);
  const char* getTypeName() const { return profile_.type_name.c_str(); }
  const char* getDescription() const { return profile_.description.c_str(); }
  const char* getVersion() const { return profile_.version.c_str(); }
  const char* getVendor() const { return profile_.vendor.c_str(); }
  const char* getCategory() const { return profile_.category.c_str(); }
  std::vector<std::string> getNamingNames() const;
  void setObjRef(const RTObject_ptr rtobj);
  // A new reference.
  RTObject_ptr getObjRef() const;
  // Merges; the values become those of the profile and of the configuration sets.
  void setProperties(const coil::Properties& prop);
  // Tells the component observers that ask for this kind; those of the first version know component_profile only. The hint of the runtime
  // itself is what has changed: the instance name, the event, or the state machine. Authors say what they like. Any thread.
  enum class Status { component_profile, fsm_profile, fsm_structure, user_defined };
  void notifyObservers(Status status, const std::string& hint);
  // For onInitialize and the constructor; no other thread may read the profile meanwhile.
  coil::Properties& getProperties() { return m_properties; }
  Manager* getManager() const { return m_pManager; }
  std::string getInstanceNameString() const { return profile_.instance_name; }

  // Configuration.
  template <typename VarType>
  bool bindParameter(const char* param_name, VarType& var, const char* def_val, bool (*trans)(VarType&, const char*) = coil::stringTo) {
    prepareBinding();
    return m_configsets.bindParameter(param_name, var, def_val, trans);
  }
  template <typename VarType, typename Function, std::enable_if_t<std::is_invocable_r_v<bool, Function, VarType&, const char*>, int> = 0>
  bool bindParameter(const char* param_name, VarType& var, const char* def_val, Function trans) {
    prepareBinding();
    return m_configsets.bindParameter(param_name, var, def_val, trans);
  }
  ConfigAdmin& getConfigService() { return m_configsets; }
  void updateParameters(const char* config_set) { m_configsets.update(config_set); }

  // Ports. They stay the caller's and must outlive the component's exit. False when a port of that name is there already.
  bool addPort(PortBase& port);
  // A port of another component (composites).
  bool addPort(PortService_ptr port);
  bool addInPort(const char* name, InPortBase& inport);
  bool addOutPort(const char* name, OutPortBase& outport);
  bool removeInPort(InPortBase& port);
  bool removeOutPort(OutPortBase& port);
  bool removePort(PortBase& port);
  bool removePort(PortService_ptr port);
  // Older names.
  void registerPort(PortBase& port) { addPort(port); }
  void registerPort(PortService_ptr port) { addPort(port); }
  void registerInPort(const char* name, InPortBase& inport) { addInPort(name, inport); }
  void registerOutPort(const char* name, OutPortBase& outport) { addOutPort(name, outport); }
  void deletePort(PortBase& port) { removePort(port); }
  void deletePort(PortService_ptr port) { removePort(port); }
  void deletePortByName(const char* port_name);
  std::vector<InPortBase*> getInPorts() const;
  std::vector<OutPortBase*> getOutPorts() const;

  // Read (write) every port before (after) each onExecute; `completion`: go on when one fails.
  bool readAll();
  bool writeAll();
  void setReadAll(bool read = true, bool completion = false);
  void setWriteAll(bool write = true, bool completion = false);

  // Execution contexts by handle: 0.. those of this component, 1000.. those it takes part in. A new reference; nil when there is none.
  ExecutionContext_ptr getExecutionContext(RTC::UniqueId ec_id);
  double getExecutionRate(RTC::UniqueId ec_id);
  ReturnCode_t setExecutionRate(RTC::UniqueId ec_id, double rate);
  bool isOwnExecutionContext(RTC::UniqueId ec_id);
  ReturnCode_t activate(RTC::UniqueId ec_id);
  ReturnCode_t deactivate(RTC::UniqueId ec_id);
  ReturnCode_t reset(RTC::UniqueId ec_id);

  // SDO services.
  bool addSdoServiceProvider(const SDOPackage::ServiceProfile& prof, SdoServiceProviderBase* provider);
  bool removeSdoServiceProvider(const char* id);
  bool addSdoServiceConsumer(const SDOPackage::ServiceProfile& prof);
  bool removeSdoServiceConsumer(const char* id);

  SDOPackage::DeviceProfile getDeviceProfile() const;
  void setDeviceProfile(const SDOPackage::DeviceProfile& profile);

  // Listeners. With autoclean they are deleted here. The forms with an object and a member function return the listener they have made, for
  // removal.
  void addPreComponentActionListener(PreComponentActionListenerType type, PreComponentActionListener* listener, bool autoclean = true);
  void removePreComponentActionListener(PreComponentActionListenerType type, PreComponentActionListener* listener);
  void addPostComponentActionListener(PostComponentActionListenerType type, PostComponentActionListener* listener, bool autoclean = true);
  void removePostComponentActionListener(PostComponentActionListenerType type, PostComponentActionListener* listener);
  void addPortActionListener(PortActionListenerType type, PortActionListener* listener, bool autoclean = true);
  void removePortActionListener(PortActionListenerType type, PortActionListener* listener);
  void addExecutionContextActionListener(ExecutionContextActionListenerType type, ExecutionContextActionListener* listener,
                                         bool autoclean = true);
  void removeExecutionContextActionListener(ExecutionContextActionListenerType type, ExecutionContextActionListener* listener);
  void addPreFsmActionListener(PreFsmActionListenerType type, PreFsmActionListener* listener, bool autoclean = true);
  void removePreFsmActionListener(PreFsmActionListenerType type, PreFsmActionListener* listener);
  void addPostFsmActionListener(PostFsmActionListenerType type, PostFsmActionListener* listener, bool autoclean = true);
  void removePostFsmActionListener(PostFsmActionListenerType type, PostFsmActionListener* listener);
  void addPortConnectListener(PortConnectListenerType type, PortConnectListener* listener, bool autoclean = true);
  void removePortConnectListener(PortConnectListenerType type, PortConnectListener* listener);
  void addPortConnectRetListener(PortConnectRetListenerType type, PortConnectRetListener* listener, bool autoclean = true);
  void removePortConnectRetListener(PortConnectRetListenerType type, PortConnectRetListener* listener);
  void addConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener, bool autoclean = true);
  void removeConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener);
  void addConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener, bool autoclean = true);
  void removeConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener);
  void addConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener,
                                       bool autoclean = true);
  void removeConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener);

  template <class Object>
  PreComponentActionListener* addPreComponentActionListener(PreComponentActionListenerType type, Object& object,
                                                            void (Object::*function)(UniqueId)) {
    return listen<PreComponentActionListener>(type, object, function, &RTObject_impl::addPreComponentActionListener);
  }
  template <class Object>
  PostComponentActionListener* addPostComponentActionListener(PostComponentActionListenerType type, Object& object,
                                                              void (Object::*function)(UniqueId, ReturnCode_t)) {
    return listen<PostComponentActionListener>(type, object, function, &RTObject_impl::addPostComponentActionListener);
  }
  template <class Object>
  PortActionListener* addPortActionListener(PortActionListenerType type, Object& object,
                                            void (Object::*function)(const RTC::PortProfile&)) {
    return listen<PortActionListener>(type, object, function, &RTObject_impl::addPortActionListener);
  }
  template <class Object>
  ExecutionContextActionListener* addExecutionContextActionListener(ExecutionContextActionListenerType type, Object& object,
                                                                    void (Object::*function)(UniqueId)) {
    return listen<ExecutionContextActionListener>(type, object, function, &RTObject_impl::addExecutionContextActionListener);
  }
  template <class Object>
  PreFsmActionListener* addPreFsmActionListener(PreFsmActionListenerType type, Object& object, void (Object::*function)(const char*)) {
    return listen<PreFsmActionListener>(type, object, function, &RTObject_impl::addPreFsmActionListener);
  }
  template <class Object>
  PostFsmActionListener* addPostFsmActionListener(PostFsmActionListenerType type, Object& object,
                                                  void (Object::*function)(const char*, ReturnCode_t)) {
    return listen<PostFsmActionListener>(type, object, function, &RTObject_impl::addPostFsmActionListener);
  }
  template <class Object>
  PortConnectListener* addPortConnectListener(PortConnectListenerType type, Object& object,
                                              void (Object::*function)(const char*, ConnectorProfile&)) {
    return listen<PortConnectListener>(type, object, function, &RTObject_impl::addPortConnectListener);
  }
  template <class Object>
  PortConnectRetListener* addPortConnectRetListener(PortConnectRetListenerType type, Object& object,
                                                    void (Object::*function)(const char*, ConnectorProfile&, ReturnCode_t)) {
    return listen<PortConnectRetListener>(type, object, function, &RTObject_impl::addPortConnectRetListener);
  }
  template <class Object>
  ConfigurationParamListener* addConfigurationParamListener(ConfigurationParamListenerType type, Object& object,
                                                            void (Object::*function)(const char*, const char*)) {
    return listen<ConfigurationParamListener>(type, object, function, &RTObject_impl::addConfigurationParamListener);
  }
  template <class Object>
  ConfigurationSetListener* addConfigurationSetListener(ConfigurationSetListenerType type, Object& object,
                                                        void (Object::*function)(const coil::Properties&)) {
    return listen<ConfigurationSetListener>(type, object, function, &RTObject_impl::addConfigurationSetListener);
  }
  template <class Object>
  ConfigurationSetNameListener* addConfigurationSetNameListener(ConfigurationSetNameListenerType type, Object& object,
                                                                void (Object::*function)(const char*)) {
    return listen<ConfigurationSetNameListener>(type, object, function, &RTObject_impl::addConfigurationSetNameListener);
  }

  // State machines tell their listeners with these.
  void preOnFsmInit(const char* state) { m_fsmListeners.preaction_[PRE_ON_INIT].notify(state); }
  void preOnFsmEntry(const char* state) { m_fsmListeners.preaction_[PRE_ON_ENTRY].notify(state); }
  void preOnFsmDo(const char* state) { m_fsmListeners.preaction_[PRE_ON_DO].notify(state); }
  void preOnFsmExit(const char* state) { m_fsmListeners.preaction_[PRE_ON_EXIT].notify(state); }
  void preOnFsmStateChange(const char* state) { m_fsmListeners.preaction_[PRE_ON_STATE_CHANGE].notify(state); }
  void postOnFsmInit(const char* state, ReturnCode_t ret) { m_fsmListeners.postaction_[POST_ON_INIT].notify(state, ret); }
  void postOnFsmEntry(const char* state, ReturnCode_t ret) { m_fsmListeners.postaction_[POST_ON_ENTRY].notify(state, ret); }
  void postOnFsmDo(const char* state, ReturnCode_t ret) { m_fsmListeners.postaction_[POST_ON_DO].notify(state, ret); }
  void postOnFsmExit(const char* state, ReturnCode_t ret) { m_fsmListeners.postaction_[POST_ON_EXIT].notify(state, ret); }
  void postOnFsmStateChange(const char* state, ReturnCode_t ret) { m_fsmListeners.postaction_[POST_ON_STATE_CHANGE].notify(state, ret); }

  // Parts of exit, for those who end a component in another order.
  void finalizePorts();
  void finalizeContexts();

  // The ORB's way in.
  _CORBA_Boolean _dispatch(omniCallHandle& call) override;

 protected:
  void shutdown();
  // A copy of one property; unlike m_properties safe while others change them.
  std::string property(const std::string& key, const std::string& otherwise = "") const;
  // Composites add themselves.
  void addOwnedOrganization(SDOPackage::Organization_impl* organization);

  Manager* m_pManager = nullptr;
  CORBA::ORB_var m_pORB;
  PortableServer::POA_var m_pPOA;
  mutable Logger rtclog{"rtobject"};
  coil::Properties m_properties;
  ConfigAdmin m_configsets;
  ComponentActionListeners m_actionListeners;
  PortConnectListeners m_portconnListeners;
  FsmActionListeners m_fsmListeners;

 private:
  struct Names {
    std::string instance_name, type_name, description, version, vendor, category;
  };
  struct Impl;
  struct Port;
  class Callbacks;
  friend class RuntimeAccess;

  template <class Listener, class Type, class Object, class Result, class... Args>
  Listener* listen(Type type, Object& object, Result (Object::*function)(Args...), void (RTObject_impl::*add)(Type, Listener*, bool)) {
    auto* listener = new MemberListener<Listener, Object, decltype(function), Args...>(object, function);
    (this->*add)(type, listener, true);
    return listener;
  }

  // exit() with another deadline.
  ReturnCode_t exitBy(std::chrono::steady_clock::time_point deadline);
  // Returns its number. A listener may be called a little longer than until it is removed.
  using StatusListener = std::function<void(Status, const std::string&)>;
  int addStatusListener(StatusListener listener);
  void removeStatusListener(int number);
  std::vector<PortBase*> getLocalPorts() const;
  // The contexts that this process has made for the component.
  std::vector<ExecutionContextBase*> getOwnContexts() const;
  std::chrono::nanoseconds callbackTimeout() const;
  // Asks for deactivation (reset) wherever the component is active (in error), and waits for nothing; then waits until it is at rest.
  void askToRest();
  void comeToRest(std::chrono::steady_clock::time_point deadline);
  // Callbacks that run on other threads, whoever calls them.
  struct RunningCallback {
    const char* callback;
    std::chrono::steady_clock::time_point since;
    std::thread::id thread;
    bool is_written_off;  // has outlasted a wait; nobody waits for it again
  };
  std::vector<RunningCallback> runningCallbacks() const;
  // After exit(): a thread is still in a callback; the component must not be deleted before it returns.
  bool isHeldByCallback() const;
  // Contexts and organizations whose process has died are left, and the component's own contexts go on. The manager's timer calls it.
  void leaveTheDead();
  // Contexts that could not end because of a callback are destroyed when it has returned: by the next component that ends, or here. True
  // when none is left.
  static bool destroyLeftContexts();
  // What Configuration::add_organization and remove_organization do.
  bool addOrganization(SDOPackage::Organization_ptr organization);
  bool removeOrganization(const char* organization_id);

  void prepareBinding();
  void takeNames();
  coil::Properties contextOptions(const std::string& type, const std::string& name) const;
  ReturnCode_t createContexts();
  bool addPort(Port port);
  bool removePort(const Port& port);
  std::string portNameOf(const std::string& name) const;
  void activatePorts(UniqueId exec_handle);
  void deactivatePorts(UniqueId exec_handle);
  void leaveOrganizations(std::chrono::steady_clock::time_point deadline);
  std::vector<std::shared_ptr<ExecutionContextBase>> localContexts() const;
  void leaveContexts(std::chrono::steady_clock::time_point deadline);
  ReturnCode_t exitNow(std::chrono::steady_clock::time_point deadline);
  // Of a component whose creation failed before it lived: the object adapter lets it go.
  void discard();
  ReturnCode_t finalizeBy(std::chrono::steady_clock::time_point deadline);
  void finalizeContexts(std::chrono::steady_clock::time_point deadline);
  void chooseClock();
  bool waitForCallbacks(std::chrono::steady_clock::time_point deadline);
  void complainAboutCallbacks(const char* consequence) const;
  void waitForExiter();
  // Says no to a caller from outside; few lines, however many calls.
  ReturnCode_t refuse(const char* operation, const std::string& why, ReturnCode_t code) const;
  bool mayBeChangedByCaller(const char* operation) const;

  Names profile_;
  std::unique_ptr<Impl> impl_;

 protected:
  // What the component is, as authors print it.
  const Names& m_profile = profile_;
};

using RtcBase = RTObject_impl;

}  // namespace RTC
