#include "system/tap.h"

#include "base/guarded.h"
#include "base/id.h"
#include "base/text.h"
#include "corba/orb/return_code.h"
#include "rtm/idl/DataPort_OpenRTMSkel.h"
#include "rtm/idl/RTCSkel.h"

namespace tools {
namespace {

constexpr const char* connector_name = "rtse";
constexpr const char* port_name = "rtse.tap";

}  // namespace

class Tap::Receiver final : public POA_OpenRTM::InPortCdr {
 public:
  explicit Receiver(OnData on_data) : on_data_(std::move(on_data)) {}
  OpenRTM::PortStatus put(const OpenRTM::CdrData& data) override {
    const auto mine = turn_.take();
    if (!on_data_) return OpenRTM::PORT_ERROR;
    on_data_({data.get_buffer(), data.length()}, little_endian);
    return OpenRTM::PORT_OK;
  }
  void stop() {
    const auto mine = turn_.take();
    on_data_ = nullptr;
  }
  bool little_endian = true;

 private:
  base::Turn<> turn_;  // of samples, and of the end: none is handed over after it
  OnData on_data_;
};

// The least that a connection needs at our end: the profile is completed, or the peer's receiver found in it.
class Tap::Port final : public POA_RTC::PortService {
 public:
  Port(CORBA::ORB_ptr orb, std::string port_type, std::string data_type, OnData on_data)
      : orb_(CORBA::ORB::_duplicate(orb)),
        port_type_(std::move(port_type)),
        data_type_(std::move(data_type)),
        receiver_(new Receiver(std::move(on_data))) {
    self_ = _this();
    if (port_type_ == "DataInPort") receiver_reference_ = receiver_->_this();
  }

  RTC::PortService_ptr self() const { return self_; }
  OpenRTM::InPortCdr_var target() { return connection_.lock()->target; }
  void deactivate() {
    receiver_->stop();
    deactivate(*this);
    if (port_type_ == "DataInPort") deactivate(*receiver_);
  }

  RTC::PortProfile* get_port_profile() override {
    RTC::PortProfile_var profile = new RTC::PortProfile;
    profile->name = port_name;
    profile->port_ref = RTC::PortService::_duplicate(self_);
    profile->properties = to_nv_list({{"port.port_type", port_type_},
                                      {"dataport.data_type", data_type_},
                                      {"dataport.interface_type", "corba_cdr"},
                                      {"dataport.dataflow_type", "push"},
                                      {"dataport.subscription_type", "flush,new,periodic"}});
    profile->connector_profiles = list();
    return profile._retn();
  }
  RTC::ConnectorProfileList* get_connector_profiles() override { return new RTC::ConnectorProfileList(list()); }
  RTC::ConnectorProfile* get_connector_profile(const char* id) override {
    auto connection = connection_.lock();
    const auto& profile = connection->profile;
    return new RTC::ConnectorProfile(std::string(id) == profile.connector_id.in() ? profile : RTC::ConnectorProfile());
  }
  RTC::ReturnCode_t connect(RTC::ConnectorProfile&) override { return RTC::UNSUPPORTED; }
  RTC::ReturnCode_t disconnect(const char* id) override { return notify_disconnect(id); }
  RTC::ReturnCode_t disconnect_all() override { return RTC::RTC_OK; }

  RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& profile) override {
    auto properties = to_properties(profile.properties);
    if (!CORBA::is_nil(receiver_reference_)) {
      CORBA::String_var ior = orb_->object_to_string(receiver_reference_);
      const auto order = base::split_list(property(properties, "dataport.serializer.cdr.endian", "little"));
      receiver_->little_endian = order.empty() || order.front() != "big";
      const auto n = profile.properties.length();
      profile.properties.length(n + 2);
      profile.properties[n].name = "dataport.corba_cdr.inport_ior";
      profile.properties[n].value <<= ior.in();
      profile.properties[n + 1].name = "dataport.corba_cdr.inport_ref";
      profile.properties[n + 1].value <<= receiver_reference_.in();
    }
    auto code = call_next(profile);
    if (CORBA::is_nil(receiver_reference_) && code == RTC::RTC_OK) code = find_target(profile);
    connection_.lock()->profile = profile;
    return code;
  }
  RTC::ReturnCode_t notify_disconnect(const char* id) override {
    Connection ended;  // its references are given back without the lock
    auto connection = connection_.lock();
    if (std::string(id) != connection->profile.connector_id.in()) return RTC::BAD_PARAMETER;
    std::swap(*connection, ended);
    return RTC::RTC_OK;
  }

 private:
  template <class Servant>
  static void deactivate(Servant& servant) {
    PortableServer::POA_var poa = servant._default_POA();
    PortableServer::ObjectId_var id = poa->servant_to_id(&servant);
    poa->deactivate_object(id);
  }
  RTC::ConnectorProfileList list() {
    auto connection = connection_.lock();
    RTC::ConnectorProfileList list;
    if (connection->profile.ports.length() > 0) {
      list.length(1);
      list[0] = connection->profile;
    }
    return list;
  }
  RTC::ReturnCode_t call_next(RTC::ConnectorProfile& profile) {
    for (CORBA::ULong i = 0; i + 1 < profile.ports.length(); ++i) {
      if (profile.ports[i]->_is_equivalent(self_)) return profile.ports[i + 1]->notify_connect(profile);
    }
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t find_target(const RTC::ConnectorProfile& profile) {
    const auto ior = property(to_properties(profile.properties), "dataport.corba_cdr.inport_ior");
    if (ior.empty()) return RTC::BAD_PARAMETER;
    CORBA::Object_var object = orb_->string_to_object(ior.c_str());
    OpenRTM::InPortCdr_var target = OpenRTM::InPortCdr::_unchecked_narrow(object);
    connection_.lock()->target = target;
    return RTC::RTC_OK;
  }

  CORBA::ORB_var orb_;
  const std::string port_type_;
  const std::string data_type_;
  PortableServer::Servant_var<Receiver> receiver_;
  RTC::PortService_var self_;
  OpenRTM::InPortCdr_var receiver_reference_;
  struct Connection {
    RTC::ConnectorProfile profile;
    OpenRTM::InPortCdr_var target;
  };
  base::Guarded<Connection, base::Rank::port> connection_;
};

Tap::Tap() : port_(nullptr, [](Port* port) { port->_remove_ref(); }) {}

Result<std::unique_ptr<Tap>> Tap::connect(CORBA::ORB_ptr orb, const PortView& port, const Properties& extra, OnData on_data) {
  if (!port.is_data_port()) return Error{"port " + port.full_name + ": is a " + port.port_type() + ", data ports were expected"};
  const bool reads = port.port_type() == "DataOutPort";
  std::unique_ptr<Tap> tap(new Tap);
  tap->port_.reset(new Port(orb, reads ? "DataInPort" : "DataOutPort", port.data_type(), std::move(on_data)));
  tap->peer_ = port.object;
  tap->id_ = base::make_uuid();
  auto properties = Properties{{"dataport.interface_type", "corba_cdr"},
                               {"dataport.dataflow_type", "push"},
                               {"dataport.subscription_type", "flush"},
                               {"dataport.data_type", port.data_type()},
                               {"dataport.serializer.cdr.endian", "little,big"}};
  if (reads) properties["dataport.looks_on"] = "YES";
  for (const auto& [key, value] : extra) properties[key] = value;
  RTC::ConnectorProfile profile;
  profile.name = connector_name;
  profile.connector_id = tap->id_.c_str();
  profile.ports.length(2);
  profile.ports[0] = RTC::PortService::_duplicate(reads ? port.object.in() : tap->port_->self());
  profile.ports[1] = RTC::PortService::_duplicate(reads ? tap->port_->self() : port.object.in());
  profile.properties = to_nv_list(properties);
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  // The OutPort side starts, as tools do it: the call runs through both ports, and back to us.
  constexpr std::chrono::seconds longest_connect{10};
  const CallLimit limited(longest_connect);
  const auto called = remote("connecting to port " + port.full_name,
                             [&] { code = reads ? port.object->connect(profile) : tap->port_->notify_connect(profile); });
  if (!called) return called.error();
  if (const auto checked = check("connecting to port " + port.full_name, code); !checked) return checked.error();
  return tap;
}

bool is_tap(const ConnectorView& connector) {
  if (connector.name != connector_name) return false;
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    RTC::PortProfile_var profile;
    const auto asked = remote("port of a connection", [&] { profile = connector.ports[i]->get_port_profile(); });
    if (asked && std::string_view(profile->name) == port_name) return true;
  }
  return false;
}

Tap::~Tap() {
  if (!port_) return;
  try {
    peer_->notify_disconnect(id_.c_str());
  } catch (const CORBA::Exception&) {
    // The peer is gone, and the connection with it.
  }
  try {
    port_->deactivate();
  } catch (const CORBA::Exception&) {
    // The ORB is shutting down and deactivates it itself.
  }
}

Result<void> Tap::put(std::span<const unsigned char> payload) {
  OpenRTM::InPortCdr_var target = port_->target();
  if (CORBA::is_nil(target)) return Error{"port: the connection does not exist any more"};
  const OpenRTM::CdrData data(static_cast<CORBA::ULong>(payload.size()), static_cast<CORBA::ULong>(payload.size()),
                              const_cast<CORBA::Octet*>(payload.data()), false);  // borrowed: omniORB only reads it
  OpenRTM::PortStatus status = OpenRTM::UNKNOWN_ERROR;
  const auto called = remote("port", [&] { status = target->put(data); });
  if (!called) return called.error();
  static constexpr const char* names[] = {"PORT_OK", "PORT_ERROR", "BUFFER_FULL", "BUFFER_EMPTY", "BUFFER_TIMEOUT", "UNKNOWN_ERROR"};
  if (status != OpenRTM::PORT_OK) return Error{std::string("port: did not take the sample: ") + names[status]};
  return {};
}

}  // namespace tools
