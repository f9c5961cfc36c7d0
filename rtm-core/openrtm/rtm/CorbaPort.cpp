#include "rtm/CorbaPort.h"

#include <algorithm>
#include <optional>

#include "base/guarded.h"
#include "base/text.h"
#include "corba/orb/nv_list.h"
#include "corba/orb/object_names.h"
#include "corba/ports/connector_keys.h"
#include "corba/transport/transport.h"
#include "core/log_rate_limiter.h"
#include "openrtm/opaque_types.h"

namespace RTC {
namespace {

// "Arm0.control" -> "Arm0" and "control".
std::pair<std::string, std::string> split_name(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos) return {"", name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

// Arm0.port.control.provided.Control.arm
std::string long_key(const std::string& port, std::string_view role, const std::string& type, const std::string& instance) {
  const auto [owner, name] = split_name(port);
  return (owner.empty() ? "" : owner + ".") + "port." + name + "." + std::string(role) + "." + type + "." + instance;
}

std::string short_key(const std::string& type, const std::string& instance) { return "port." + type + "." + instance; }

// What providers write: the long key or the short one, port.<type>.<instance>.
bool is_provided_key(std::string_view key) {
  const auto is_short = [&] { return std::ranges::count(key, '.') == 2 && key != "port.connection.strictness"; };
  return key.find(".provided.") != std::string_view::npos || (key.starts_with("port.") && is_short());
}

bool means_unbound(const std::string& value) { return value == "null" || value == "nil"; }

}  // namespace

// A servant and its place in its POA. Its reference is the same whenever it is active.
struct CorbaPort::Provider {
  std::string instance;
  std::string type;
  PortableServer::ServantBase* servant;
  PortableServer::POA_var poa;
  PortableServer::ObjectId_var id;
  CORBA::Object_var reference;
  bool is_active = false;
};

struct CorbaPort::Consumer {
  std::string instance;
  std::string type;
  CorbaConsumerBase* consumer;
  std::string connector_id;  // of the connection that has bound it
};

struct CorbaPort::State {
  std::vector<Provider> providers;
  std::vector<Consumer> consumers;
  base::Turn<base::Rank::component> activation;  // of the providers: calls of the POA, which are local
  base::Turn<base::Rank::connector> binding;     // of the consumers
};

CorbaPort::CorbaPort(const char* name) : PortBase(name), state_(std::make_unique<State>()) { addProperty("port.port_type", "CorbaPort"); }

CorbaPort::~CorbaPort() {
  deactivateInterfaces();
  for (const auto& provider : state_->providers) corba::forget_object(provider.reference);
  shut();
}

void CorbaPort::init(coil::Properties& properties) { PortBase::init(properties); }

bool CorbaPort::registerProvider(const char* instance_name, const char* type_name, PortableServer::ServantBase& provider) {
  if (!appendInterface(instance_name, type_name, PROVIDED)) return false;
  Provider added{instance_name, type_name, &provider, {}, {}, {}, false};
  try {
    added.poa = provider._default_POA();
    try {
      added.id = added.poa->activate_object(&provider);
    } catch (const PortableServer::POA::ServantAlreadyActive&) {
      added.id = added.poa->servant_to_id(&provider);
    }
    added.reference = added.poa->id_to_reference(added.id);
    added.poa->deactivate_object(added.id);  // until the component is active
  } catch (const CORBA::Exception& e) {
    RTC_ERROR_STR("provider " << instance_name << " cannot be made an object: " << e._name());
    deleteInterface(instance_name, PROVIDED);
    return false;
  }
  state_->providers.push_back(std::move(added));
  return true;
}

bool CorbaPort::registerConsumer(const char* instance_name, const char* type_name, CorbaConsumerBase& consumer) {
  if (!appendInterface(instance_name, type_name, REQUIRED)) return false;
  state_->consumers.push_back({instance_name, type_name, &consumer, {}});
  return true;
}

void CorbaPort::activateInterfaces() {
  const auto activation = state_->activation.take();
  for (auto& provider : state_->providers) {
    if (std::exchange(provider.is_active, true)) continue;
    try {
      corba::name_object(provider.reference, corba::port_text(getName()));
      provider.poa->activate_object_with_id(provider.id, provider.servant);
    } catch (const PortableServer::POA::ServantAlreadyActive&) {
    } catch (const PortableServer::POA::ObjectAlreadyActive&) {
    } catch (const CORBA::Exception& e) {
      provider.is_active = false;
      RTC_ERROR_STR("provider " << provider.instance << " cannot be activated: " << e._name());
    }
  }
}

void CorbaPort::deactivateInterfaces() {
  const auto activation = state_->activation.take();
  for (auto& provider : state_->providers) {
    if (!std::exchange(provider.is_active, false)) continue;
    try {
      provider.poa->deactivate_object(provider.id);
    } catch (const CORBA::Exception&) {
      // Somebody else has deactivated it, or the ORB is gone.
    }
  }
}

std::shared_ptr<detail::PortTerms> CorbaPort::read_terms(const ConnectorProfile& profile) {
  auto terms = std::make_shared<detail::PortTerms>();
  const auto allowed = corba::find_text(profile.properties, "dataport.allow_dup_connection");
  terms->allows_duplicate = base::parse_bool(allowed.value_or(m_properties.getProperty("allow_dup_connection"))).value_or(false);
  return terms;
}

void CorbaPort::complete_profile(ConnectorProfile& profile) {
  // References that somebody has kept from an earlier life of the connection; whoever provides writes its own.
  NVList kept;
  CORBA::ULong count = 0;
  kept.length(profile.properties.length());
  for (CORBA::ULong i = 0; i < profile.properties.length(); ++i) {
    const char* text = nullptr;
    const auto& entry = profile.properties[i];
    const bool is_reference = (entry.value >>= text) && std::string_view(text).starts_with("IOR:");
    if (!is_reference || !is_provided_key(entry.name.in())) kept[count++] = entry;
  }
  kept.length(count);
  profile.properties = kept;
}

ReturnCode_t CorbaPort::publishInterfaces(ConnectorProfile& profile) {
  const std::string port = getName();
  for (const auto& provider : state_->providers) {
    const CORBA::String_var text = corba::orb()->object_to_string(provider.reference);
    corba::set_text(profile.properties, long_key(port, "provided", provider.type, provider.instance), text.in());
    corba::set_text(profile.properties, short_key(provider.type, provider.instance), text.in());
  }
  return RTC_OK;
}

ReturnCode_t CorbaPort::subscribeInterfaces(const ConnectorProfile& profile) {
  // A peer that adds without replacing leaves a stale entry in front of its own: the last of a name counts.
  const rt::KeyValues values = corba::to_key_values(profile.properties);
  const auto value_of = [&](const std::string& key) -> std::optional<std::string> {
    const auto it = values.find(key);
    if (it == values.end()) return std::nullopt;
    return it->second;
  };
  const bool is_strict = base::equal_ignoring_case(base::trim(value_of("port.connection.strictness").value_or("best_effort")), "strict");
  const std::string port = getName();

  for (auto& consumer : state_->consumers) {
    std::optional<std::string> reference;
    if (const auto required = value_of(long_key(port, "required", consumer.type, consumer.instance))) {
      const std::string name(base::trim(*required));
      reference = means_unbound(name) || name.starts_with("IOR:") ? name : value_of(name);
    }
    if (!reference) reference = value_of(short_key(consumer.type, consumer.instance));
    if (!reference) {
      if (!is_strict) continue;
      rt::log_rejection(rtclog, Logger::RTL_WARN, "connection rejected: no port provides " + consumer.type + " " + consumer.instance);
      return RTC::RTC_ERROR;
    }
    if (means_unbound(*reference)) continue;
    const CORBA::Object_var object = corba::parse_reference(reference->c_str());  // nil is rejected below
    if (!consumer.consumer->setObject(object)) {
      rt::log_rejection(rtclog, Logger::RTL_WARN,
                        "the object for consumer " + consumer.instance + " is no " + consumer.type + " or does not answer");
      if (is_strict) return RTC::RTC_ERROR;
      continue;
    }
    const auto binding = state_->binding.take();
    consumer.connector_id = profile.connector_id.in();
  }
  return RTC_OK;
}

void CorbaPort::unsubscribeInterfaces(const ConnectorProfile& profile) {
  for (auto& consumer : state_->consumers) {
    {
      const auto binding = state_->binding.take();
      if (consumer.connector_id != profile.connector_id.in()) continue;
      consumer.connector_id.clear();
    }
    consumer.consumer->releaseObject();
  }
}

}  // namespace RTC
