#include "rtm/SdoServiceAdmin.h"

#include <coil/stringutil.h>
#include "component/log_consumer.h"
#include "component/observer.h"

#include <algorithm>
#include <optional>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "corba/orb/principal.h"
#include "core/log_rate_limiter.h"

namespace RTC {

namespace {

struct Provider {
  SDOPackage::ServiceProfile profile;
  std::shared_ptr<SdoServiceProviderBase> servant;
};

struct Consumer {
  std::string id;
  std::shared_ptr<SdoServiceConsumerBase> consumer;
};

std::shared_ptr<SdoServiceConsumerBase> make_consumer(const std::string& type) {
  SdoServiceConsumerBase* made = SdoServiceConsumerFactory::instance().createObject(type);
  if (made == nullptr) return nullptr;
  return {made, [](SdoServiceConsumerBase* consumer) { SdoServiceConsumerFactory::instance().deleteObject(consumer); }};
}

std::shared_ptr<SdoServiceProviderBase> counted(SdoServiceProviderBase* provider) {
  return {provider, [](SdoServiceProviderBase* servant) { servant->_remove_ref(); }};
}

void end(Provider& provider) {
  provider.servant->finalize();
  try {
    PortableServer::POA_var poa = provider.servant->_default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(provider.profile.service);
    poa->deactivate_object(id);
  } catch (const CORBA::Exception&) {
    // The provider has done it itself, or the object adapter is gone.
  }
}

bool is_enabled(const std::string& list, const std::string& type) {
  return coil::includes(list, "ALL", true) || coil::includes(list, type, true);
}

}  // namespace

struct SdoServiceAdmin::Impl {
  struct Data {
    std::vector<Provider> providers{};
    std::vector<Consumer> consumers{};
    std::string enabled_consumers = "ALL";
  };
  explicit Impl(RTObject_impl& owner) : component(owner) {}
  RTObject_impl& component;
  base::Guarded<Data, base::Rank::component> shared;
};

SdoServiceAdmin::SdoServiceAdmin(RTObject_impl& rtobj) : impl_(std::make_unique<Impl>(rtobj)) {}

SdoServiceAdmin::~SdoServiceAdmin() { exit(); }

void SdoServiceAdmin::init(const coil::Properties& props) {
  registerBuiltinSdoServices();
  const std::string providers = props.getProperty("sdo.service.provider.enabled_services", "ALL");
  impl_->shared.lock()->enabled_consumers = props.getProperty("sdo.service.consumer.enabled_services", "ALL");
  for (const std::string& type : SdoServiceProviderFactory::instance().getIdentifiers()) {
    if (!is_enabled(providers, type)) continue;
    SdoServiceProviderBase* made = SdoServiceProviderFactory::instance().createObject(type);
    if (made == nullptr) continue;
    SDOPackage::ServiceProfile profile;
    profile.id = type.c_str();
    profile.interface_type = type.c_str();
    SDOPackage::SDOService_var reference = made->_this();
    profile.service = reference;
    if (made->init(impl_->component, profile))
      addSdoServiceProvider(profile, made);
    else
      made->_remove_ref();
  }
}

void SdoServiceAdmin::exit() {
  std::vector<Provider> providers;
  std::vector<Consumer> consumers;
  {
    auto data = impl_->shared.lock();
    providers.swap(data->providers);
    consumers.swap(data->consumers);
  }
  for (Provider& provider : providers) end(provider);
  for (Consumer& consumer : consumers) consumer.consumer->finalize();
}

SDOPackage::ServiceProfileList* SdoServiceAdmin::getServiceProviderProfiles() const {
  SDOPackage::ServiceProfileList_var profiles = new SDOPackage::ServiceProfileList();
  auto data = impl_->shared.lock();
  profiles->length(static_cast<CORBA::ULong>(data->providers.size()));
  for (CORBA::ULong i = 0; i < profiles->length(); ++i) profiles[i] = data->providers[i].profile;
  return profiles._retn();
}

SDOPackage::ServiceProfile* SdoServiceAdmin::getServiceProviderProfile(const char* id) const {
  const std::string wanted = id;
  auto data = impl_->shared.lock();
  for (const Provider& provider : data->providers)
    if (wanted == provider.profile.id.in()) return new SDOPackage::ServiceProfile(provider.profile);
  for (const Provider& provider : data->providers)
    if (wanted == provider.profile.interface_type.in()) return new SDOPackage::ServiceProfile(provider.profile);
  return nullptr;
}

bool SdoServiceAdmin::addSdoServiceProvider(const SDOPackage::ServiceProfile& profile, SdoServiceProviderBase* provider) {
  if (provider == nullptr) return false;
  auto data = impl_->shared.lock();
  for (const Provider& known : data->providers)
    if (std::string(known.profile.id) == profile.id.in()) return false;
  data->providers.push_back({profile, counted(provider)});
  return true;
}

bool SdoServiceAdmin::removeSdoServiceProvider(const char* id) {
  std::optional<Provider> removed;
  {
    auto data = impl_->shared.lock();
    const auto it = std::find_if(data->providers.begin(), data->providers.end(),
                                 [&](const Provider& provider) { return std::string(provider.profile.id) == id; });
    if (it == data->providers.end()) return false;
    removed = std::move(*it);
    data->providers.erase(it);
  }
  end(*removed);
  return true;
}

namespace {

constexpr std::size_t max_consumers = 256;  // of one component; each may have a thread, and is told of every event

bool try_to_init(SdoServiceConsumerBase& consumer, RTObject_impl& component, const SDOPackage::ServiceProfile& profile) {
  try {
    return consumer.init(component, profile);
  } catch (const std::exception& e) {  // no thread, for instance
    base::log(base::Level::error, component.getInstanceNameString(), "SDO service {} cannot be used: {}", base::in_quotes(profile.id.in()),
              e.what());
    return false;
  }
}

}  // namespace

bool SdoServiceAdmin::addSdoServiceConsumer(const SDOPackage::ServiceProfile& profile) {
  const std::string id = profile.id.in();
  const std::string type = profile.interface_type.in();
  if (id.empty() || CORBA::is_nil(profile.service) || !corba::may_keep(profile.service)) return false;
  std::shared_ptr<SdoServiceConsumerBase> known;
  std::string enabled;
  bool is_full = false;
  {
    auto data = impl_->shared.lock();
    enabled = data->enabled_consumers;
    is_full = data->consumers.size() >= max_consumers;
    for (const Consumer& consumer : data->consumers)
      if (consumer.id == id) known = consumer.consumer;
  }
  if (known) return known->reinit(profile);
  if (is_full) {
    rt::log_rejection(
        base::Level::error, impl_->component.getInstanceNameString(),
        "SDO service " + base::in_quotes(id) + " is rejected: there are " + std::to_string(max_consumers) + " already, the maximum");
    return false;
  }
  if (!is_enabled(enabled, type)) return false;
  const auto consumer = make_consumer(type);
  if (!consumer) return false;
  if (!try_to_init(*consumer, impl_->component, profile)) return false;
  bool added = false;
  {
    auto data = impl_->shared.lock();
    added = std::none_of(data->consumers.begin(), data->consumers.end(), [&](const Consumer& other) { return other.id == id; }) &&
            data->consumers.size() < max_consumers;
    if (added) data->consumers.push_back({id, consumer});
  }
  if (!added) consumer->finalize();  // somebody else was faster
  return added;
}

bool SdoServiceAdmin::removeSdoServiceConsumer(const char* id) {
  std::shared_ptr<SdoServiceConsumerBase> removed;
  {
    auto data = impl_->shared.lock();
    const auto it =
        std::find_if(data->consumers.begin(), data->consumers.end(), [&](const Consumer& consumer) { return consumer.id == id; });
    if (it == data->consumers.end()) return false;
    removed = it->consumer;
    data->consumers.erase(it);
  }
  removed->finalize();
  return true;
}

void registerBuiltinSdoServices() {
  registerComponentObserverConsumers();
  registerLoggerConsumer();
}

}  // namespace RTC
