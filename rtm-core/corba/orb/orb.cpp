#include "corba/orb/orb.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "base/scratch_folder.h"
#include "base/text.h"
#include "corba/members/member_watch.h"
#include "corba/orb/call_context.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/call_watch.h"
#include "corba/orb/listening.h"
#include "corba/ports/disconnect_notice.h"
#include "corba/ports/peer_watch.h"
#include "corba/ports/sample_room.h"

namespace corba {
namespace {

// ---- a private folder for the unix socket

constexpr const char* folder_prefix = "rtmsim-orb-";

std::filesystem::path runtime_folder() {
  std::error_code error;
  if (const char* given = std::getenv("XDG_RUNTIME_DIR"); given != nullptr && *given == '/' && access(given, W_OK) == 0) return given;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? "/tmp" : folder;
}

}  // namespace

// Removed with its owner.
class Orb::PrivateFolder {
 public:
  static std::unique_ptr<PrivateFolder> make() {
    auto folder = base::ScratchFolder::make(folder_prefix, runtime_folder());
    return folder ? std::make_unique<PrivateFolder>(std::move(*folder)) : nullptr;
  }
  explicit PrivateFolder(base::ScratchFolder folder) : folder_(std::move(folder)) {}
  const std::string& path() const { return folder_.path(); }

 private:
  base::ScratchFolder folder_;
};

namespace {

// ---- what the ORB says

struct OrbMessages {
  bool collecting = false;
  std::string last;
};

auto& orb_messages() {
  static base::Guarded<OrbMessages, base::Rank::log> messages;
  return messages;
}

void take_orb_message(const char* text) {
  std::string_view line = base::trim(text);
  if (line.starts_with("omniORB:")) line = base::trim(line.substr(8));
  {
    auto messages = orb_messages().lock();
    if (messages->collecting) {
      messages->last = line;
      return;
    }
  }
  base::log_text(base::Level::debug, "orb", line);
}

// ---- end points

base::Result<void> check_port(std::string_view endpoint, std::string_view port) {
  if (port.empty()) return {};
  const auto number = base::parse_integer(port);
  if (number && *number >= 0 && *number <= 65535) return {};
  return base::Error{"end point " + base::in_quotes(endpoint) + ": expected a port from 0 to 65535, got " + base::in_quotes(port)};
}

// Nobody on another host reaches it.
bool is_on_this_host(std::string_view endpoint) {
  endpoint = base::trim(endpoint);
  for (const std::string_view kind : {"giop:tcp:", "giop:ssl:", "iiop://"}) {
    if (endpoint.starts_with(kind)) endpoint.remove_prefix(kind.size());
  }
  if (endpoint.empty() || endpoint.starts_with("giop:unix:") || endpoint == "unix") return true;
  for (const std::string_view host : {":", "localhost", "127.", "[::1]"}) {
    if (endpoint.starts_with(host)) return true;
  }
  return false;
}

bool is_every_end_point_on_this_host(const OrbSettings& settings) {
  for (const auto& endpoint : settings.endpoints) {
    if (!is_on_this_host(endpoint)) return false;
  }
  for (std::size_t i = 0; i + 1 < settings.arguments.size(); ++i) {
    if (settings.arguments[i].starts_with("-ORBendPoint") && !is_on_this_host(settings.arguments[i + 1])) return false;
  }
  return true;
}

OpenTo who_may_call(const OrbSettings& settings) {
  return settings.open_to.value_or(is_every_end_point_on_this_host(settings) ? OpenTo::account : OpenTo::network);
}

// As omniORB wants it.
base::Result<std::string> to_orb_endpoint(std::string_view endpoint, bool is_open) {
  auto text = base::trim(endpoint);
  if (text.starts_with("giop:")) {
    const auto kinds = {"giop:tcp:", "giop:ssl:", "giop:unix:"};
    if (std::ranges::any_of(kinds, [&](const char* kind) { return text.starts_with(kind); })) return std::string(text);
    return base::Error{"end point " + base::in_quotes(endpoint) + ": expected giop:tcp:HOST:PORT, giop:ssl:HOST:PORT or giop:unix:FILE"};
  }
  if (text.starts_with("iiop://")) text.remove_prefix(7);
  if (text == "all" || text == "ipv4") return std::string("giop:tcp:0.0.0.0:");
  if (text == "ipv6") return std::string("giop:tcp:[::]:");
  const auto colon = text.rfind(':');
  const bool is_bare_ipv6 = text.ends_with(']');
  auto host = colon == std::string_view::npos || is_bare_ipv6 ? text : text.substr(0, colon);
  const auto port = colon == std::string_view::npos || is_bare_ipv6 ? std::string_view() : text.substr(colon + 1);
  if (auto checked = check_port(endpoint, port); !checked) return checked.error();
  if (host.empty()) host = is_open ? "0.0.0.0" : "127.0.0.1";
  if (host.find_first_of(" \t/") != std::string_view::npos || (host.find(':') != std::string_view::npos && !host.starts_with('['))) {
    return base::Error{"end point " + base::in_quotes(endpoint) + ": expected host:port, :port, all, unix or giop:..."};
  }
  return "giop:tcp:" + std::string(host) + ":" + std::string(port);
}

bool has_argument(const std::vector<std::string>& arguments, std::string_view name) {
  for (const auto& argument : arguments) {
    if (argument == name) return true;
  }
  return false;
}

base::Result<std::vector<std::string>> to_arguments(const OrbSettings& settings, const std::string& unix_folder) {
  std::vector<std::string> result{"rtm", "-ORBgiopMaxMsgSize", std::to_string(settings.max_message_size),
                                  // Connections from other processes stay open however seldom they are used.
                                  "-ORBinConScanPeriod", "0",
                                  // Ours to processes that are gone are found only when they have been idle for so long [s].
                                  "-ORBoutConScanPeriod", "30", "-ORBclientCallTimeOutPeriod",
                                  std::to_string(settings.call_timeout.count()),
                                  // The timeout of calls that wait for activate(), those of this process included.
                                  "-ORBpoaHoldRequestTimeout", std::to_string(settings.call_timeout.count())};
  std::vector<std::string> endpoints;
  for (const auto& endpoint : settings.endpoints) {
    if (base::trim(endpoint) != "all") {
      endpoints.push_back(endpoint);
      continue;
    }
    if (settings.ipv4) endpoints.emplace_back("ipv4");
    if (settings.ipv6) endpoints.emplace_back("ipv6");
  }
  if (endpoints.empty()) endpoints.emplace_back();
  const bool given_by_arguments = has_argument(settings.arguments, "-ORBendPoint");
  for (const auto& endpoint : endpoints) {
    if (given_by_arguments) break;
    if (endpoint == "unix") continue;
    auto converted = to_orb_endpoint(endpoint, who_may_call(settings) == OpenTo::network);
    if (!converted) return converted.error();
    result.insert(result.end(), {"-ORBendPoint", guarded(*converted)});
  }
  if (!unix_folder.empty()) result.insert(result.end(), {"-ORBendPoint", guarded("giop:unix:" + unix_folder + "/socket")});
  auto tls = prepare_tls(settings.tls);
  if (!tls) return tls.error();
  for (const auto& [name, value] : *tls) result.insert(result.end(), {"-ORB" + name, value});
  for (const auto& endpoint : settings.tls.endpoints) {
    auto converted = to_orb_endpoint(endpoint, true);
    if (!converted) return converted.error();
    result.insert(result.end(), {"-ORBendPoint", guarded("giop:ssl:" + converted->substr(std::string_view("giop:tcp:").size()))});
  }
  for (const auto& address : settings.further_addresses) {
    const auto port = address.find(':') == std::string::npos ? ":2809" : "";
    result.insert(result.end(), {"-ORBendPointNoListen", "giop:tcp:" + address + port});
  }
  for (std::size_t i = 0; i < settings.arguments.size(); ++i) {
    const bool is_endpoint = i > 0 && (settings.arguments[i - 1] == "-ORBendPoint" || settings.arguments[i - 1] == "-ORBendPointNoPublish");
    result.push_back(is_endpoint ? guarded(settings.arguments[i]) : settings.arguments[i]);
  }
  return result;
}

// Of the last argument of that name; 0 if there is none.
std::int64_t last_number(const std::vector<std::string>& arguments, std::string_view name) {
  std::optional<std::int64_t> given;
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == name) given = base::parse_integer(arguments[i + 1]);
  }
  return given.value_or(0);
}

// Of the arguments, so that calls between ports keep what rtc.conf says in corba.args; 0 is none.
std::chrono::milliseconds call_timeout_of(const std::vector<std::string>& arguments) {
  const auto given = last_number(arguments, "-ORBclientCallTimeOutPeriod");
  return given > 0 ? std::chrono::milliseconds(given) : std::chrono::hours(1);
}

AccessSettings access_of(const OrbSettings& settings, const std::vector<std::string>& arguments) {
  AccessSettings access{who_may_call(settings), !settings.tls.endpoints.empty(), {}};
  access.limits.sample = static_cast<std::size_t>(std::max<std::int64_t>(last_number(arguments, "-ORBgiopMaxMsgSize"), 8192));
  // Who says how long a message may be by an argument of the ORB means every message.
  const bool is_said = has_argument(settings.arguments, "-ORBgiopMaxMsgSize");
  access.limits.request = is_said ? access.limits.sample : std::min(settings.max_request_size, access.limits.sample);
  access.limits.total = std::max(access.limits.total, 2 * access.limits.sample);
  if (!is_said) access.limits.room = &room_for_samples;
  return access;
}

// ---- object keys that people can write

// Sends every caller on to the object it stands for.
class Forwarder final : public PortableServer::ServantBase {
 public:
  explicit Forwarder(CORBA::Object_ptr target) : target_(CORBA::Object::_duplicate(target)) {}
  _CORBA_Boolean _dispatch(omniCallHandle&) override { throw omniORB::LOCATION_FORWARD(CORBA::Object::_duplicate(target_), false); }
  // Callers of this process ask here.
  _CORBA_Boolean _is_a(const char* id) override { return target_->_is_a(id); }
  _CORBA_Boolean _non_existent() override { return target_->_non_existent(); }
  void* _ptrToInterface(const char* id) override { return omni::ptrStrMatch(id, CORBA::Object::_PD_repoId) ? this : nullptr; }
  const char* _mostDerivedRepoId() override { return CORBA::Object::_PD_repoId; }
  CORBA::Object_ptr target() const { return CORBA::Object::_duplicate(target_); }

 private:
  CORBA::Object_var target_;
};

void remove_object(PortableServer::POA_ptr poa, const PortableServer::ObjectId& id) {
  try {
    poa->deactivate_object(id);
  } catch (const PortableServer::POA::ObjectNotActive&) {
  }
}

// " on WHERE: WHY". What the ORB says counts only when nothing else explains it.
std::string why_not(const OrbSettings& settings, const std::vector<std::string>& arguments, std::string said) {
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (!arguments[i].starts_with("-ORBendPoint") || arguments[i] == "-ORBendPointNoListen") continue;
    const auto endpoint = unguarded(arguments[i + 1]);
    if (const auto problem = listening_problem(endpoint); !problem.empty()) return " on " + endpoint + ": " + problem;
  }
  constexpr std::string_view signature = "omniORB: ";
  if (said.starts_with(signature)) said.erase(0, signature.size());
  if (said.starts_with('(')) said.erase(0, std::min(said.find(')') + 1, said.size()));
  const auto where = base::join(settings.endpoints, ", ");
  return (where.empty() ? "" : " on " + where) + ": " + std::string(base::trim(said));
}

}  // namespace

base::Result<std::unique_ptr<Orb>> Orb::start(const OrbSettings& settings) {
  std::unique_ptr<Orb> result(new Orb);
  if (settings.unix_socket) result->folder_ = PrivateFolder::make();
  auto arguments = to_arguments(settings, result->folder_ ? result->folder_->path() : "");
  if (!arguments) return arguments.error();
  set_port_call_timeout(call_timeout_of(*arguments));
  const AccessSettings access = access_of(settings, *arguments);
  set_access(access);
  // An answer to "are you there?" may move a reference past those who look at answers to calls (corba/orb/principal.h).
  if (accepts_other_accounts()) arguments->insert(arguments->end(), {"-ORBverifyObjectExistsAndType", "0"});
  std::vector<char*> argv;
  for (auto& argument : *arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int argc = static_cast<int>(arguments->size());

  *orb_messages().lock() = {.collecting = true, .last = ""};
  omniORB::setLogFunction(&take_orb_message);
  std::string failure;
  try {
    result->orb_ = CORBA::ORB_init(argc, argv.data(), "omniORB4");
    remember_callers();
    watch_calls();
    pass_on_time();
    expect_no_data_held_at_calls();
    CORBA::Object_var poa = result->orb_->resolve_initial_references("RootPOA");
    result->root_poa_ = PortableServer::POA::_narrow(poa);
    result->poa_manager_ = result->root_poa_->the_POAManager();
    poa = result->orb_->resolve_initial_references("omniINSPOA");
    result->ins_poa_ = PortableServer::POA::_narrow(poa);
  } catch (const CORBA::Exception& e) {
    failure = to_text(e);
  } catch (const omniORB::fatalException& e) {
    failure = e.errmsg();
  }
  const auto detail = std::exchange(*orb_messages().lock(), {}).last;
  if (failure.empty()) {
    if (access.open_to != OpenTo::account) {
      base::log(base::Level::info, "orb", "open to {}: {}",
                access.open_to == OpenTo::host ? "every account of this machine" : "every caller that reaches it",
                base::join(result->addresses(), ", "));
    }
    if (access.has_tls) {
      base::log(base::Level::info, "orb", "open over TLS to every owner of a certificate of {}", base::in_quotes(settings.tls.authority));
    }
    start_disconnect_notices();
    begin_port_watch();
    if (settings.peer_check_interval.count() > 0) result->watch_ = std::make_unique<PeerWatch>(settings.peer_check_interval);
    return result;
  }
  return base::Error{"orb: cannot start" + why_not(settings, *arguments, detail.empty() ? failure : detail)};
}

Orb::Orb() = default;

Orb::~Orb() {
  watch_.reset();
  end_port_watch();
  stop_disconnect_notices();
  try {
    if (!CORBA::is_nil(orb_)) orb_->destroy();
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "orb", "shutting down failed: {}", to_text(e));
  }
}

void Orb::activate() {
  poa_manager_->activate();
  PortableServer::POAManager_var manager = ins_poa_->the_POAManager();
  manager->activate();
}

std::string Orb::folder() const { return folder_ ? folder_->path() : std::string(); }

std::vector<std::string> Orb::addresses() const {
  std::vector<std::string> result;
  const auto add = [&](const IIOP::Address& address) {
    const std::string host(address.host);
    result.push_back((host.find(':') != std::string::npos ? "[" + host + "]" : host) + ":" + std::to_string(address.port));
  };
  try {
    CORBA::Object_var reference = root_poa_->create_reference("IDL:omg.org/CORBA/Object:1.0");
    const omniIOR_var ior = reference->_PR_getobj()->_getIOR();
    for (CORBA::ULong i = 0; i < ior->iopProfiles().length(); ++i) {
      const auto& profile = ior->iopProfiles()[i];
      if (profile.tag != IOP::TAG_INTERNET_IOP) continue;
      IIOP::ProfileBody body;
      IIOP::unmarshalProfile(profile, body);
      add(body.address);
      for (CORBA::ULong k = 0; k < body.components.length(); ++k) {
        if (body.components[k].tag != IOP::TAG_ALTERNATE_IIOP_ADDRESS) continue;
        const auto& octets = body.components[k].component_data;
        cdrEncapsulationStream stream(octets.get_buffer(), octets.length(), true);
        IIOP::Address address;
        address.host = stream.unmarshalRawString();
        address.port <<= stream;
        add(address);
      }
    }
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::debug, "orb", "its own addresses are unknown: {}", to_text(e));
  }
  return result;
}

void Orb::publish(const std::string& key, CORBA::Object_ptr object) {
  const PortableServer::ObjectId_var id = PortableServer::string_to_ObjectId(key.c_str());
  remove_object(ins_poa_, id);
  PortableServer::Servant_var<Forwarder> servant = new Forwarder(object);
  try {
    ins_poa_->activate_object_with_id(id, servant);
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "orb", "object key {} cannot be published: {}", base::in_quotes(key), to_text(e));
  }
}

void Orb::withdraw(const std::string& key) {
  const PortableServer::ObjectId_var id = PortableServer::string_to_ObjectId(key.c_str());
  remove_object(ins_poa_, id);
}

CORBA::Object_ptr published_object(CORBA::Object_ptr reference) {
  try {
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const CORBA::Object_var adapter = orb->resolve_initial_references("omniINSPOA");
    const PortableServer::POA_var keys = PortableServer::POA::_narrow(adapter);
    const PortableServer::ServantBase_var servant = keys->reference_to_servant(reference);
    if (const auto* forwarder = dynamic_cast<const Forwarder*>(servant.in())) return forwarder->target();
  } catch (const CORBA::Exception&) {
    // Not of this adapter: the normal case.
  }
  return CORBA::Object::_nil();
}

void set_call_timeout(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  omniORB::setClientCallTimeout(object, static_cast<CORBA::ULong>(timeout.count()));
}

std::string to_text(const CORBA::Exception& exception) {
  if (const auto* system = CORBA::SystemException::_downcast(&exception)) {
    const char* minor = system->NP_minorString();
    return std::string(system->_name()) + (minor != nullptr ? " (" + std::string(minor) + ")" : "");
  }
  return exception._name();
}

}  // namespace corba
