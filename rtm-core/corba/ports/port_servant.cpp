#include "corba/ports/port_servant.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/id.h"
#include "base/log.h"
#include "base/text.h"
#include "corba/orb/nv_list.h"
#include "corba/orb/object_names.h"
#include "corba/orb/sequences.h"
#include "corba/ports/connector_keys.h"
#include "corba/ports/disconnect_notice.h"
#include "corba/ports/peer_watch.h"
#include "corba/transport/transport.h"
#include "core/key_limits.h"
#include "core/log_rate_limiter.h"

namespace corba {
namespace {

// Maximum number of connections without connection_limit: each takes memory, and can have a thread.
constexpr std::size_t usual_limit = 4096;

// For others to let go of a port that dies. They do at once, unless the POA was destroyed before.
constexpr auto longest_wait = std::chrono::seconds(10);

// Every name that the protocol needs is far shorter than the limits; longer ones only fill the memory of all peers.
base::Result<void> check_profile(const RTC::ConnectorProfile& profile) {
  if (profile.ports.length() > rt::max_ports_of_a_connection) {
    return base::Error{"connection: has " + std::to_string(profile.ports.length()) + " ports, expected at most " +
                       std::to_string(rt::max_ports_of_a_connection)};
  }
  for (CORBA::ULong i = 0; i < profile.ports.length(); ++i) {
    if (CORBA::is_nil(profile.ports[i])) return base::Error{"connection: a port is nil"};
  }
  constexpr std::size_t longest_id = 64 * 1024;
  if (std::strlen(profile.connector_id) > longest_id) return base::Error{"connection: its id is longer than 64 KiB"};
  return check_keys("connection: property", profile.properties);
}

std::string named(const RTC::ConnectorProfile& profile) { return "connection " + base::in_quotes(profile.name.in()); }

bool is_good(const RTC::ConnectorProfile& profile, const std::string& port) {
  const auto checked = check_profile(profile);
  if (!checked) rt::log_rejection(base::Level::warn, port, "rejected: " + checked.error().message);
  return bool(checked);
}

}  // namespace

PortServant::PortServant(std::string name) { state_.lock()->name = std::move(name); }

PortServant::~PortServant() { shut(); }

void PortServant::deactivate() {
  // The reference stays, to recognise ourselves by.
  const RTC::PortService_var reference = RTC::PortService::_duplicate(state_.lock()->reference);
  if (!CORBA::is_nil(reference)) {
    forget_object(reference);
    try {
      const PortableServer::POA_var poa = _default_POA();
      const PortableServer::ObjectId_var id = poa->servant_to_id(this);
      poa->deactivate_object(id);
    } catch (const CORBA::Exception&) {
      // Not active (any more), or the ORB is gone: nobody can call.
    }
  }
}

void PortServant::shut() {
  loss_->close();
  deactivate();
  gate_.close();
  for (const auto& profile : connections()) forget_peers(profile.connector_id.in(), *loss_);
  // A caller has its answer a little before the POA is done with the call.
  auto holders = holders_.lock();
  holders.wait_for(released_, longest_wait, [&] { return *holders <= 1; });
}

void PortServant::_add_ref() { ++*holders_.lock(); }

void PortServant::_remove_ref() {
  bool is_last = false;
  {
    // Notified under the lock: the one who waits destroys us.
    auto holders = holders_.lock();
    is_last = --*holders == 0;
    released_.notify_all();
  }
  if (is_last) delete this;  // the owner has given up its own count, as owners of servants on the heap do
}

bool PortServant::is_same(CORBA::Object_ptr a, CORBA::Object_ptr b) {
  if (CORBA::is_nil(a) || CORBA::is_nil(b)) return false;
  return a == b || a->_is_equivalent(b);  // the ORB compares keys and addresses itself
}

PortServant::Connection* PortServant::State::find(std::string_view id) {
  for (auto& connection : connections) {
    if (id == connection.profile.connector_id.in()) return &connection;
  }
  return nullptr;
}

RTC::PortService_ptr PortServant::reference() {
  {
    auto state = state_.lock();
    if (!CORBA::is_nil(state->reference)) return state->reference.in();
  }
  RTC::PortService_var made;
  try {
    made = _this();
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::error, port_name(), "the port cannot be made an object: {}", e._name());
    return RTC::PortService::_nil();
  }
  {
    auto state = state_.lock();
    if (!CORBA::is_nil(state->reference)) return state->reference.in();
    state->reference = RTC::PortService::_duplicate(made);
  }
  name_object(made, port_text(port_name()));
  activated(made);
  return state_.lock()->reference.in();
}

std::string PortServant::port_name() const { return state_.lock()->name; }
void PortServant::set_port_name(const std::string& name) {
  RTC::PortService_var reference;
  {
    auto state = state_.lock();
    state->name = name;
    reference = RTC::PortService::_duplicate(state->reference);
  }
  name_object(reference, port_text(name));
}
void PortServant::set_owner(RTC::RTObject_ptr owner) { state_.lock()->owner = RTC::RTObject::_duplicate(owner); }
void PortServant::set_reference(RTC::PortService_ptr reference) { state_.lock()->reference = RTC::PortService::_duplicate(reference); }

void PortServant::set_profile_property(const std::string& key, const std::string& value) {
  set_text(state_.lock()->properties, key, value);
}
std::string PortServant::profile_property(const std::string& key) const { return find_text(state_.lock()->properties, key).value_or(""); }

bool PortServant::add_interface(const std::string& instance, const std::string& type, RTC::PortInterfacePolarity polarity) {
  auto state = state_.lock();
  for (CORBA::ULong i = 0; i < state->interfaces.length(); ++i) {
    const auto& known = state->interfaces[i];
    if (instance == known.instance_name.in() && type == known.type_name.in() && polarity == known.polarity) return false;
  }
  RTC::PortInterfaceProfile added;
  added.instance_name = instance.c_str();
  added.type_name = type.c_str();
  added.polarity = polarity;
  append(state->interfaces, added);
  return true;
}

bool PortServant::remove_interface(const std::string& instance, RTC::PortInterfacePolarity polarity) {
  auto state = state_.lock();
  auto& interfaces = state->interfaces;
  for (CORBA::ULong i = 0; i < interfaces.length(); ++i) {
    if (instance != interfaces[i].instance_name.in() || polarity != interfaces[i].polarity) continue;
    for (CORBA::ULong k = i; k + 1 < interfaces.length(); ++k) interfaces[k] = interfaces[k + 1];
    interfaces.length(interfaces.length() - 1);
    return true;
  }
  return false;
}

std::vector<RTC::ConnectorProfile> PortServant::connections() const {
  std::vector<RTC::ConnectorProfile> profiles;
  auto state = state_.lock();
  for (const auto& connection : state->connections) {
    if (connection.is_established && !connection.is_leaving) profiles.push_back(connection.profile);
  }
  return profiles;
}

RTC::PortProfile PortServant::profile() const {
  RTC::PortProfile profile;
  {
    auto state = state_.lock();
    profile.name = state->name.c_str();
    profile.interfaces = state->interfaces;
    profile.port_ref = RTC::PortService::_duplicate(state->reference);
    profile.owner = RTC::RTObject::_duplicate(state->owner);
    profile.properties = state->properties;
    for (const auto& connection : state->connections) {
      if (connection.is_established && !connection.is_leaving) append(profile.connector_profiles, connection.profile);
    }
  }
  complete(profile);
  return profile;
}

RTC::PortProfile* PortServant::get_port_profile() {
  reference();
  return new RTC::PortProfile(profile());
}

RTC::ConnectorProfileList* PortServant::get_connector_profiles() {
  RTC::ConnectorProfileList_var list = new RTC::ConnectorProfileList();
  for (const auto& profile : connections()) append(list.inout(), profile);
  return list._retn();
}

RTC::ConnectorProfile* PortServant::get_connector_profile(const char* connector_id) {
  RTC::ConnectorProfile_var profile = new RTC::ConnectorProfile();
  auto state = state_.lock();
  const Connection* connection = state->find(connector_id);
  if (connection && connection->is_established && !connection->is_leaving) profile.inout() = connection->profile;
  return profile._retn();
}

int PortServant::position(const RTC::PortServiceList& ports) {
  const RTC::PortService_ptr self = reference();
  for (CORBA::ULong i = 0; i < ports.length(); ++i) {
    if (is_same(ports[i], self)) return static_cast<int>(i);
  }
  return -1;
}

void PortServant::tell(Step step, RTC::ConnectorProfile& profile, RTC::ReturnCode_t code) {
  try {
    on_step(step, profile, code);
  } catch (const std::exception& e) {
    base::log(base::Level::error, port_name(), "a connect callback has thrown: {}", e.what());
  } catch (...) {
    base::log(base::Level::error, port_name(), "a connect callback has thrown something that is no std::exception");
  }
}

RTC::ReturnCode_t PortServant::connect(RTC::ConnectorProfile& profile) {
  const Gate::Visit visit(gate_);
  if (!visit) return RTC::RTC_ERROR;
  if (!is_good(profile, port_name()) || position(profile.ports) < 0) return RTC::BAD_PARAMETER;
  complete_profile(profile);
  const bool is_id_ours = *profile.connector_id.in() == '\0';
  if (is_id_ours) {
    profile.connector_id = base::make_uuid().c_str();
  } else if (state_.lock()->find(profile.connector_id.in())) {
    return RTC::PRECONDITION_NOT_MET;
  }

  if (is_same(profile.ports[0], reference())) return join(profile, true);
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  try {
    const RTC::PortService_var first = RTC::PortService::_duplicate(profile.ports[0]);
    limit_calls(first, chain_timeout(port_call_timeout(), profile.ports.length(), profile.ports.length()));
    code = first->notify_connect(profile);
    // What the others have set up is of no use if one has rejected; a port that knew a given id before keeps its connection.
    if (code != RTC::RTC_OK && (is_id_ours || code != RTC::PRECONDITION_NOT_MET)) break_up(profile);
  } catch (const CORBA::Exception& e) {
    rt::log_rejection(base::Level::warn, port_name(), "the first port of " + named(profile) + " does not answer: " + e._name());
    break_up(profile, is_time_out(e));
  }
  return code;
}

RTC::ReturnCode_t PortServant::notify_connect(RTC::ConnectorProfile& profile) {
  const Gate::Visit visit(gate_);
  if (!visit) return RTC::RTC_ERROR;
  if (*profile.connector_id.in() == '\0' || !is_good(profile, port_name())) return RTC::BAD_PARAMETER;
  return join(profile, false);
}

RTC::ReturnCode_t PortServant::reserve(const RTC::ConnectorProfile& profile, bool allows_duplicate) {
  const RTC::PortService_var self = RTC::PortService::_duplicate(reference());
  const auto share_a_peer = [&](const RTC::PortServiceList& a, const RTC::PortServiceList& b) {
    for (CORBA::ULong i = 0; i < a.length(); ++i) {
      if (is_same(a[i], self)) continue;
      for (CORBA::ULong k = 0; k < b.length(); ++k) {
        if (is_same(a[i], b[k])) return true;
      }
    }
    return false;
  };
  const std::string id = profile.connector_id.in();
  const int limit = connection_limit_.load(std::memory_order_relaxed);
  const std::size_t most = limit >= 0 ? static_cast<std::size_t>(limit) : usual_limit;
  auto state = state_.lock();
  if (state->find(id)) return RTC::PRECONDITION_NOT_MET;
  if (state->connections.size() >= most) return RTC::RTC_ERROR;
  Connection* crossed = nullptr;
  for (auto& connection : state->connections) {
    if (allows_duplicate || connection.is_leaving || !share_a_peer(profile.ports, connection.profile.ports)) continue;
    // Two ports that connect to each other at the same time start opposite chains, and each meets the other's at its second port. Both
    // must give way to the same one, the one with the smaller id, or both fail.
    const bool have_crossed = !connection.is_established && is_same(connection.profile.ports[0], self) && !is_same(profile.ports[0], self);
    if (!have_crossed || id > connection.profile.connector_id.in()) return RTC::PRECONDITION_NOT_MET;
    crossed = &connection;
  }
  if (crossed) crossed->gives_way_to = id;
  state->connections.push_back({profile});
  return RTC::RTC_OK;
}

bool PortServant::gives_way(std::string_view id) {
  auto state = state_.lock();
  const Connection* connection = state->find(id);
  return connection && !connection->gives_way_to.empty() && state->find(connection->gives_way_to);
}

RTC::ReturnCode_t PortServant::join(RTC::ConnectorProfile& profile, bool starts_the_chain) {
  const int self = position(profile.ports);
  const OnBehalfOfSenders senders(profile.ports);
  if (self < 0 || !may_keep_ports(profile.ports, self)) return RTC::BAD_PARAMETER;
  tell(Step::notify_connect, profile, RTC::RTC_OK);
  const auto terms = read_terms(profile);
  RTC::ReturnCode_t code = reserve(profile, terms->allows_duplicate);
  if (code == RTC::RTC_ERROR)
    rt::log_rejection(base::Level::warn, port_name(), named(profile) + " is rejected: the port has as many as connection_limit allows");
  if (code != RTC::RTC_OK) return code;

  const std::string id = profile.connector_id.in();
  const RTC::PortServiceList ports = profile.ports;
  bool is_next_told = false;
  bool is_next_silent = false;
  bool is_published = false;
  try {
    code = prepare(profile, *terms);
    if (code == RTC::RTC_OK) {
      is_published = true;
      code = publish(profile, *terms);
      tell(Step::published, profile, code);
    }
    if (code == RTC::RTC_OK) {
      const Next next = join_next(profile, self, starts_the_chain);
      code = next.code;
      is_next_silent = next.is_silent;
      is_next_told = code != RTC::PRECONDITION_NOT_MET;
      if (id != profile.connector_id.in() || profile.ports.length() != ports.length()) {
        rt::log_rejection(base::Level::warn, port_name(), "the next port of " + named(profile) + " answers with another id or other ports");
        code = RTC::RTC_ERROR;
      }
      if (code == RTC::RTC_OK && !is_good(profile, port_name())) code = RTC::BAD_PARAMETER;
      profile.connector_id = id.c_str();
      profile.ports = ports;
      tell(Step::next_connected, profile, code);
    }
    if (code == RTC::RTC_OK) {
      code = subscribe(profile, *terms);
      tell(Step::subscribed, profile, code);
    }
    // A peer of another make may have taken both of two chains that crossed.
    if (code == RTC::RTC_OK && gives_way(profile.connector_id.in())) code = RTC::PRECONDITION_NOT_MET;
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::error, port_name(), "connecting failed: {}", e._name());
    code = RTC::RTC_ERROR;
  } catch (const std::exception& e) {
    base::log(base::Level::error, port_name(), "connecting failed: {}", e.what());
    code = RTC::RTC_ERROR;
  }

  if (code != RTC::RTC_OK) {
    if (is_next_told) leave_next(profile, is_next_silent);
    if (is_published) unsubscribe(profile, false);
    auto state = state_.lock();
    if (const Connection* connection = state->find(profile.connector_id.in())) {
      state->connections.erase(state->connections.begin() + (connection - state->connections.data()));
    }
    return code;
  }
  {
    auto state = state_.lock();
    if (Connection* connection = state->find(profile.connector_id.in())) {
      connection->profile = profile;
      connection->is_established = true;
    }
  }
  watch_peers(profile.connector_id.in(), profile.ports, reference(), loss_);
  const bool is_still_there = state_.lock()->find(profile.connector_id.in());
  if (!is_still_there) forget_peers(profile.connector_id.in(), *loss_);
  tell(Step::connected, profile, code);
  return code;
}

PortServant::Next PortServant::join_next(RTC::ConnectorProfile& profile, int self, bool starts_the_chain) {
  const CORBA::ULong next = static_cast<CORBA::ULong>(self) + 1;
  if (next >= profile.ports.length()) return {};
  const RTC::PortService_var port = RTC::PortService::_duplicate(profile.ports[next]);
  try {
    limit_calls(port,
                chain_timeout(port_call_timeout(), profile.ports.length() - next, profile.ports.length() - (starts_the_chain ? 1 : 0)));
    return {port->notify_connect(profile)};
  } catch (const CORBA::Exception& e) {
    rt::log_rejection(base::Level::warn, port_name(), "the next port of " + named(profile) + " does not answer: " + e._name());
    return {RTC::RTC_ERROR, is_time_out(e)};
  }
}

RTC::ReturnCode_t PortServant::break_up(const RTC::ConnectorProfile& profile, bool has_waited) {
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto deadline = disconnect_deadline(has_waited);
  for (CORBA::ULong i = 0; i < profile.ports.length(); ++i) {
    if (is_same(profile.ports[i], reference())) return leave(profile.connector_id.in(), true, false);
    // If it is dead or hangs, the next one takes the lead.
    const auto answer = notify_disconnect_of(profile.ports[i], profile.connector_id, profile.ports.length() - i, deadline);
    if (answer) return *answer;
  }
  return code;
}

RTC::ReturnCode_t PortServant::disconnect(const char* connector_id) {
  const Gate::Visit visit(gate_);
  if (!visit) return RTC::RTC_ERROR;
  RTC::ConnectorProfile profile;
  {
    auto state = state_.lock();
    const Connection* connection = state->find(connector_id);
    if (!connection || !connection->is_established || connection->is_leaving) return RTC::BAD_PARAMETER;
    profile = connection->profile;
  }
  const RTC::ReturnCode_t code = break_up(profile);
  // Whoever took the lead may not have come as far as us.
  const RTC::ReturnCode_t own = leave(connector_id, true, false);
  return own == RTC::RTC_OK ? RTC::RTC_OK : code;
}

RTC::ReturnCode_t PortServant::disconnect_all() {
  RTC::ReturnCode_t result = RTC::RTC_OK;
  for (const auto& profile : connections()) {
    const RTC::ReturnCode_t code = disconnect(profile.connector_id);
    // Somebody else may have been faster.
    if (code != RTC::RTC_OK && code != RTC::BAD_PARAMETER) result = code;
  }
  return result;
}

RTC::ReturnCode_t PortServant::notify_disconnect(const char* connector_id) {
  const Gate::Visit visit(gate_);
  if (!visit) return RTC::RTC_ERROR;
  return leave(connector_id, true, false);
}

bool PortServant::drop_connection(const char* connector_id) {
  const Gate::Visit visit(gate_);
  return visit && leave(connector_id, false, true) == RTC::RTC_OK;
}

RTC::ReturnCode_t PortServant::leave(std::string_view connector_id, bool tells_next, bool is_lost) {
  const std::string id(connector_id);
  RTC::ConnectorProfile profile;
  {
    auto state = state_.lock();
    Connection* connection = state->find(id);
    if (!connection || !connection->is_established || connection->is_leaving) return RTC::BAD_PARAMETER;
    connection->is_leaving = true;
    profile = connection->profile;
  }
  forget_peers(id, *loss_);
  tell(Step::notify_disconnect, profile, RTC::RTC_OK);
  if (tells_next) tell(Step::next_disconnected, profile, leave_next(profile));
  tell(Step::unsubscribed, profile, RTC::RTC_OK);
  try {
    unsubscribe(profile, is_lost);
  } catch (const std::exception& e) {
    base::log(base::Level::error, port_name(), "disconnecting failed: {}", e.what());
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::error, port_name(), "disconnecting failed: {}", e._name());
  }
  {
    auto state = state_.lock();
    const Connection* connection = state->find(id);
    if (connection != nullptr) state->connections.erase(state->connections.begin() + (connection - state->connections.data()));
  }
  if (is_lost) tell_lost(profile);
  tell(Step::disconnected, profile, RTC::RTC_OK);
  return RTC::RTC_OK;
}

// A process that only hung still thinks that it is connected, and would refuse to be connected again.
void PortServant::tell_lost(const RTC::ConnectorProfile& profile) {
  const bool has_refused = take_refusal(profile.connector_id.in());
  const bool comes_back =
      !has_refused && base::parse_bool(find_text(profile.properties, "dataport.reconnect").value_or("")).value_or(false);
  for (CORBA::ULong i = 0; i < profile.ports.length(); ++i) {
    if (is_same(profile.ports[i], reference())) continue;
    if (comes_back)
      reconnect_later(profile.ports[i], profile);
    else
      notify_disconnect_later(profile.ports[i], profile.connector_id);
  }
}

RTC::ReturnCode_t PortServant::leave_next(const RTC::ConnectorProfile& profile, bool has_waited) {
  const int self = position(profile.ports);
  if (self < 0) return RTC::BAD_PARAMETER;
  const auto deadline = disconnect_deadline(has_waited);
  for (CORBA::ULong next = static_cast<CORBA::ULong>(self) + 1; next < profile.ports.length(); ++next) {
    if (const auto answer = notify_disconnect_of(profile.ports[next], profile.connector_id, profile.ports.length() - next, deadline))
      return *answer;
  }
  return RTC::RTC_OK;
}

}  // namespace corba
