#include "rtm/RTObject.h"

#include <coil/stringutil.h>
#include <omniORB4/callHandle.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/NVUtil.h>
#include <rtm/PortBase.h>
#include "component/component_impl.h"

#include <algorithm>

#include "base/text.h"
#include "corba/members/remote_participant.h"
#include "corba/orb/guarded_transport.h"
#include "corba/orb/object_names.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "core/remote_rights.h"

namespace RTC {

void deactivateServant(PortableServer::ServantBase& servant, CORBA::Object_ptr reference) {
  corba::forget_object(reference);
  try {
    PortableServer::POA_var poa = servant._default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(reference);
    poa->deactivate_object(id);
  } catch (const CORBA::Exception&) {
    // Deactivated already, or the object adapter is gone.
  }
}

RTObject_impl::RTObject_impl(Manager* manager) : m_pManager(manager), impl_(std::make_unique<Impl>(*this)) {
  int argc = 0;
  m_pORB = manager ? CORBA::ORB::_duplicate(manager->getORB()) : CORBA::ORB_init(argc, nullptr);
  m_pPOA = manager ? PortableServer::POA::_duplicate(manager->getPOA()) : PortableServer::POA::_the_root_poa();
  m_configsets.setLog([this](const std::string& line) { RTC_WARN(("%s", line.c_str())); });
  OpenRTM::DataFlowComponent_var self = _this();
  auto* configuration = new SDOPackage::Configuration_impl(*this, m_configsets, impl_->services);
  SDOPackage::Configuration_var configuration_reference = configuration->_this();
  auto data = impl_->shared.lock();
  data->configuration = configuration;
  data->configuration_reference = configuration_reference;
  data->reference = RTC::RTObject::_duplicate(self);
}

RTObject_impl::RTObject_impl(CORBA::ORB_ptr orb, PortableServer::POA_ptr poa) : RTObject_impl(nullptr) {
  m_pORB = CORBA::ORB::_duplicate(orb);
  m_pPOA = PortableServer::POA::_duplicate(poa);
}

RTObject_impl::~RTObject_impl() {
  std::thread exiter;
  exiter.swap(*impl_->exiter.lock());
  if (exiter.get_id() == std::this_thread::get_id())
    exiter.detach();
  else if (exiter.joinable())
    exiter.join();
  // A component that never lived, or was deleted without exit. Its ports are members of the derived class and gone already.
  impl_->shared.lock()->ports.clear();
  finalizeContexts();
  shutdown();
}

DataFlowComponentBase::DataFlowComponentBase(Manager* manager) : RTObject_impl(manager) {}
DataFlowComponentBase::DataFlowComponentBase(CORBA::ORB_ptr orb, PortableServer::POA_ptr poa) : RTObject_impl(orb, poa) {}
DataFlowComponentBase::~DataFlowComponentBase() = default;

// --- who calls from outside

_CORBA_Boolean RTObject_impl::_dispatch(omniCallHandle& call) {
  // Without a message the call is of this process.
  if (call.iop_s() == nullptr || !is_watched_operation(call.operation_name())) return POA_OpenRTM::DataFlowComponent::_dispatch(call);
  const OutsideCall from_outside(*this);
  return POA_OpenRTM::DataFlowComponent::_dispatch(call);
}

ReturnCode_t RTObject_impl::refuse(const char* operation, const std::string& why, ReturnCode_t code) const {
  if (const auto left_out = impl_->rejection_limiter.next()) {
    RTC_WARN(("%s asked for %s: rejected, %s%s", corba::caller().c_str(), operation, why.c_str(),
              rt::LogRateLimiter::omitted_text(*left_out).c_str()));
  }
  return code;
}

bool RTObject_impl::mayBeChangedByCaller(const char* operation) const {
  if (corba::principal() == corba::Principal::own || m_pManager == nullptr) return true;
  if (rt::parse_remote_rights(m_pManager->configValue("manager.remote_rights")) != rt::RemoteRights::read) return true;
  refuse(operation, "manager.remote_rights is read", RTC_ERROR);
  return false;
}

// --- life

ReturnCode_t RTObject_impl::initialize() {
  if (OutsideCall::is_mine(*this)) {
    if (!mayBeChangedByCaller("initialize")) return RTC_ERROR;
    if (m_pManager != nullptr) return refuse("initialize", "its manager initializes the component", PRECONDITION_NOT_MET);
  }
  {
    auto data = impl_->shared.lock();
    if (data->phase != Impl::Phase::created) return PRECONDITION_NOT_MET;
    data->phase = Impl::Phase::initializing;
  }
  const auto give_up = [this](ReturnCode_t code) {
    finalizePorts();
    finalizeContexts();
    shutdown();
    return code;
  };
  prepareBinding();
  coil::Properties properties;
  {
    const auto turn = impl_->properties_turn.take();
    properties = m_properties;
  }
  const std::string active_set = properties.getProperty("configuration.active_config");
  if (!active_set.empty() && !m_configsets.activateConfigurationSet(active_set.c_str()))
    RTC_WARN(("configuration.active_config: there is no set %s", base::in_quotes(active_set).c_str()));
  impl_->services.init(properties);
  if (getOwnContexts().empty())  // the manager's bindExecutionContext may have made them
    if (const ReturnCode_t code = createContexts(); code != RTC_OK) return give_up(code);
  if (const ReturnCode_t code = on_initialize(); code != RTC_OK) {
    RTC_ERROR(("onInitialize failed"));
    return give_up(code);
  }
  std::vector<ExecutionContextBase*> contexts;
  {
    auto data = impl_->shared.lock();
    data->phase = Impl::Phase::alive;
    contexts = data->contexts;
  }
  for (ExecutionContextBase* context : contexts) {
    if (context->start() != RTC_ERROR || context->isRunning()) continue;  // a shared one may run already
    RTC_ERROR(("an execution context of the component cannot run"));
    return RTC_ERROR;
  }
  return RTC_OK;
}

void RTObject_impl::discard() {
  {
    auto data = impl_->shared.lock();
    if (data->phase != Impl::Phase::created && data->phase != Impl::Phase::initializing) return;
  }
  finalizePorts();
  finalizeContexts();
  shutdown();
}

ReturnCode_t RTObject_impl::finalize() {
  if (OutsideCall::is_mine(*this)) {
    if (!mayBeChangedByCaller("finalize")) return RTC_ERROR;
    return refuse("finalize", "exit ends a component", PRECONDITION_NOT_MET);
  }
  return finalizeBy(std::chrono::steady_clock::now() + callbackTimeout());
}

ReturnCode_t RTObject_impl::finalizeBy(std::chrono::steady_clock::time_point deadline) {
  {
    auto data = impl_->shared.lock();
    if (data->phase != Impl::Phase::exiting) return PRECONDITION_NOT_MET;
    data->phase = Impl::Phase::finalizing;
  }
  impl_->gate.close_to_remote();
  // Authors rely on it that their callbacks do not run side by side.
  if (waitForCallbacks(deadline))
    on_finalize();
  else
    complainAboutCallbacks("the component ends without onFinalize and onShutdown and stays in memory");
  finalizePorts();
  finalizeContexts(deadline);
  shutdown();
  destroyLeftContexts();  // not in the destructor, which a context's thread may call
  if (m_pManager) m_pManager->notifyFinalized(this);
  return RTC_OK;
}

ReturnCode_t RTObject_impl::exit() {
  if (OutsideCall::is_mine(*this) && !mayBeChangedByCaller("exit")) return RTC_ERROR;
  return exitBy(std::chrono::steady_clock::now() + callbackTimeout());
}

ReturnCode_t RTObject_impl::exitBy(std::chrono::steady_clock::time_point deadline) {
  bool is_first = false;
  {
    auto data = impl_->shared.lock();
    is_first = data->phase == Impl::Phase::alive;
    if (is_first) data->phase = Impl::Phase::exiting;
  }
  if (!is_first) {
    if (!isInsideCallback()) waitForExiter();
    return PRECONDITION_NOT_MET;
  }
  if (!isInsideCallback()) return exitNow(deadline);
  // A context cannot be stopped from inside one of its callbacks. The thread holds a reference: the component may be given back meanwhile.
  _add_ref();
  *impl_->exiter.lock() = std::thread([this, deadline, principal = corba::principal()] {
    const corba::OnBehalfOf same(principal);
    exitNow(deadline);
    _remove_ref();
  });
  return RTC_OK;
}

// Who takes the component away after it has left by itself must not do so while it is still leaving.
void RTObject_impl::waitForExiter() {
  std::thread exiter;
  {
    auto own = impl_->exiter.lock();
    if (own->get_id() == std::this_thread::get_id()) return;
    exiter.swap(*own);
  }
  if (exiter.joinable()) exiter.join();
}

ReturnCode_t RTObject_impl::exitNow(std::chrono::steady_clock::time_point deadline) {
  leaveOrganizations(deadline);
  leaveContexts(deadline);
  return finalizeBy(deadline);
}

void RTObject_impl::leaveOrganizations(std::chrono::steady_clock::time_point deadline) {
  std::vector<SDOPackage::Organization_var> organizations;
  organizations.swap(impl_->shared.lock()->organizations);
  const LastCalls calls(deadline);
  for (const SDOPackage::Organization_var& organization : organizations) {
    if (calls.are_over()) return;
    try {
      const SDOPackage::Organization_var target = corba::copy_as<SDOPackage::Organization>(organization, calls.timeout());
      target->remove_member(getInstanceName());
    } catch (const CORBA::Exception& exception) {
      RTC_DEBUG(("an organization does not let the component go: %s", corba::to_text(exception).c_str()));
    }
  }
}

// May be called again.
void RTObject_impl::shutdown() {
  std::vector<SDOPackage::Organization_impl*> organizations;
  SDOPackage::Configuration_impl* configuration = nullptr;
  SDOPackage::Configuration_var configuration_reference;
  RTObject_var self;
  {
    auto data = impl_->shared.lock();
    if (data->phase == Impl::Phase::finalized) return;
    data->phase = Impl::Phase::finalized;
    organizations.swap(data->owned_organizations);
    configuration = std::exchange(data->configuration, nullptr);
    configuration_reference = std::exchange(data->configuration_reference, SDOPackage::Configuration_var());
    self = data->reference;
  }
  impl_->gate.close_to_remote();
  for (SDOPackage::Organization_impl* organization : organizations) {
    try {
      SDOPackage::Organization_var reference = organization->getObjRef();
      deactivateServant(*organization, reference);
    } catch (const CORBA::Exception&) {
      // The object adapter is gone.
    }
    organization->_remove_ref();
  }
  impl_->services.exit();
  if (configuration) {
    configuration->close();
    deactivateServant(*configuration, configuration_reference);
    configuration->_remove_ref();
  }
  deactivateServant(*this, self);
}

// --- what it is

void RTObject_impl::setInstanceName(const char* instance_name) {
  {
    const auto turn = impl_->properties_turn.take();
    profile_.instance_name = instance_name ? instance_name : "";
    m_properties["instance_name"] = profile_.instance_name;
  }
  rtclog.setName(profile_.instance_name.c_str());
  RTC::RTObject_var self;
  SDOPackage::Configuration_var configuration;
  std::vector<Port> ports;
  {
    auto data = impl_->shared.lock();
    self = data->reference;
    configuration = data->configuration_reference;
    ports = data->ports;
  }
  corba::name_object(self, "component " + profile_.instance_name);
  corba::name_object(configuration, "component " + profile_.instance_name);
  for (const Port& port : ports)
    if (port.local) port.local->setName(portNameOf(port.name).c_str());
  notifyObservers(Status::component_profile, profile_.instance_name);
}

void RTObject_impl::takeNames() {
  std::string instance;
  {
    const auto turn = impl_->properties_turn.take();
    const auto take = [this](const char* key, std::string& name) { name = m_properties.getProperty(key, name); };
    take("type_name", profile_.type_name);
    take("description", profile_.description);
    take("version", profile_.version);
    take("vendor", profile_.vendor);
    take("category", profile_.category);
    instance = m_properties.getProperty("instance_name");
  }
  if (!instance.empty() && instance != profile_.instance_name) setInstanceName(instance.c_str());
}

std::string RTObject_impl::property(const std::string& key, const std::string& otherwise) const {
  const auto turn = impl_->properties_turn.take();
  return m_properties.getProperty(key, otherwise);
}

std::vector<std::string> RTObject_impl::getNamingNames() const { return coil::split(property("naming.names"), ",", true); }

void RTObject_impl::setObjRef(const RTObject_ptr rtobj) { impl_->shared.lock()->reference = RTC::RTObject::_duplicate(rtobj); }

RTObject_ptr RTObject_impl::getObjRef() const { return RTC::RTObject::_duplicate(impl_->shared.lock()->reference); }

void RTObject_impl::setProperties(const coil::Properties& prop) {
  {
    const auto turn = impl_->properties_turn.take();
    m_properties << prop;
  }
  takeNames();
  prepareBinding();
  notifyObservers(Status::component_profile, profile_.instance_name);
}

void RTObject_impl::notifyObservers(Status status, const std::string& hint) {
  const std::map<int, StatusListener> listeners = impl_->shared.lock()->status_listeners;
  for (const auto& [number, listener] : listeners) listener(status, hint);
}

int RTObject_impl::addStatusListener(StatusListener listener) {
  auto data = impl_->shared.lock();
  data->status_listeners.emplace(data->next_status_listener, std::move(listener));
  return data->next_status_listener++;
}

void RTObject_impl::removeStatusListener(int number) { impl_->shared.lock()->status_listeners.erase(number); }

// While the component is made, its configuration sets follow its properties.
void RTObject_impl::prepareBinding() {
  const auto phase = impl_->shared.lock()->phase;
  if (phase != Impl::Phase::created && phase != Impl::Phase::initializing) return;
  coil::Properties sets;
  {
    const auto turn = impl_->properties_turn.take();
    const coil::Properties* conf = m_properties.findNode("conf");
    if (!conf) return;
    sets = *conf;
  }
  m_configsets.load(sets);
}

ComponentProfile* RTObject_impl::get_component_profile() {
  ComponentProfile_var profile = new ComponentProfile();
  coil::Properties properties;
  {
    const auto turn = impl_->properties_turn.take();
    properties = m_properties;
    profile->instance_name = profile_.instance_name.c_str();
    profile->type_name = profile_.type_name.c_str();
    profile->description = profile_.description.c_str();
    profile->version = profile_.version.c_str();
    profile->vendor = profile_.vendor.c_str();
    profile->category = profile_.category.c_str();
  }
  const std::vector<Port> ports = impl_->shared.lock()->ports;
  CORBA::ULong n = 0;
  profile->port_profiles.length(static_cast<CORBA::ULong>(ports.size()));
  for (const Port& port : ports) {
    try {
      PortProfile_var one = port.local ? port.local->get_port_profile() : PortService_var(port.reference)->get_port_profile();
      profile->port_profiles[n] = one;
      ++n;
    } catch (const CORBA::Exception& exception) {
      RTC_WARN(("a port of another component does not answer: %s", corba::to_text(exception).c_str()));
    }
  }
  profile->port_profiles.length(n);
  coil::Properties& conf = properties.getNode("conf");
  for (const coil::Properties& set : m_configsets.getConfigurationSets()) {
    if (set.getLeaf().empty()) continue;
    conf.getNode(set.getName()) << set;
  }
  NVUtil::copyFromProperties(profile->properties, properties);
  return profile._retn();
}

// --- listeners

#define RTC_DEFINE_LISTENERS(What, Type, lists, count)                       \
  void RTObject_impl::add##What(Type type, What* listener, bool autoclean) { \
    if (type < count) lists[type].addListener(listener, autoclean);          \
  }                                                                          \
  void RTObject_impl::remove##What(Type type, What* listener) {              \
    if (type < count) lists[type].removeListener(listener);                  \
  }
RTC_DEFINE_LISTENERS(PreComponentActionListener, PreComponentActionListenerType, m_actionListeners.preaction_,
                     PRE_COMPONENT_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PostComponentActionListener, PostComponentActionListenerType, m_actionListeners.postaction_,
                     POST_COMPONENT_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PortActionListener, PortActionListenerType, m_actionListeners.portaction_, PORT_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(ExecutionContextActionListener, ExecutionContextActionListenerType, m_actionListeners.ecaction_,
                     EC_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PreFsmActionListener, PreFsmActionListenerType, m_fsmListeners.preaction_, PRE_FSM_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PostFsmActionListener, PostFsmActionListenerType, m_fsmListeners.postaction_, POST_FSM_ACTION_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PortConnectListener, PortConnectListenerType, m_portconnListeners.portconnect_, PORT_CONNECT_LISTENER_NUM)
RTC_DEFINE_LISTENERS(PortConnectRetListener, PortConnectRetListenerType, m_portconnListeners.portconnret_, PORT_CONNECT_RET_LISTENER_NUM)
#undef RTC_DEFINE_LISTENERS

#define RTC_DEFINE_LISTENERS(What, Type)                                                                                          \
  void RTObject_impl::add##What(Type type, What* listener, bool autoclean) { m_configsets.add##What(type, listener, autoclean); } \
  void RTObject_impl::remove##What(Type type, What* listener) { m_configsets.remove##What(type, listener); }
RTC_DEFINE_LISTENERS(ConfigurationParamListener, ConfigurationParamListenerType)
RTC_DEFINE_LISTENERS(ConfigurationSetListener, ConfigurationSetListenerType)
RTC_DEFINE_LISTENERS(ConfigurationSetNameListener, ConfigurationSetNameListenerType)
#undef RTC_DEFINE_LISTENERS

}  // namespace RTC
