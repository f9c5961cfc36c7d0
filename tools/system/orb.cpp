#include "system/orb.h"

#include <array>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text.h"
#include "corba/orb/guarded_transport.h"
#include "corba/orb/tls.h"

namespace tools {

std::string default_server() {
  // rtshell's variable; several servers are separated by ';'.
  if (const char* servers = std::getenv("RTCTREE_NAMESERVERS")) {
    const auto list = base::split_list(servers, ';');
    if (!list.empty()) return list.front();
  }
  return "localhost:2809";
}

namespace {

constexpr std::size_t longest_sample = std::size_t{256} << 20;  // [bytes]

// Tools read no rtc.conf.
corba::OpenTo open_to_of_environment() {
  const char* said = std::getenv("RTMSIM_OPEN_TO");
  const std::string text = said != nullptr ? said : "";
  if (text.empty() || text == "account") return corba::OpenTo::account;
  if (text == "host") return corba::OpenTo::host;
  throw std::runtime_error("RTMSIM_OPEN_TO: expected account or host, got " + base::in_quotes(text));
}

}  // namespace

// What ports send to a tool comes in by end points that are guarded as those of any host of components.
Orb::Orb() {
  const auto tls = corba::prepare_tls(corba::tls_of_environment());
  if (!tls) throw std::runtime_error(tls.error().message);
  corba::AccessSettings access{open_to_of_environment(), !tls->empty(), {}};
  access.limits.sample = longest_sample;
  access.limits.total = 2 * longest_sample;
  corba::set_access(access);
  const auto here = corba::guarded("giop:tcp:127.0.0.1:"), over_tls = corba::guarded("giop:ssl::");
  const auto longest = std::to_string(longest_sample);
  std::vector<std::array<const char*, 2>> options{
      {"endPoint", here.c_str()},
      {"giopMaxMsgSize", longest.c_str()},
      {"supportPerThreadTimeOut", "1"},
      // No limit of its own for new connections: it would replace the limit of the first call over each.
      {"clientCallTimeOutPeriod", "30000"}};
  for (const auto& [name, value] : *tls) options.push_back({name.c_str(), value.c_str()});
  if (!tls->empty()) options.push_back({"endPoint", over_tls.c_str()});  // what ports of other hosts send comes here
  options.push_back({nullptr, nullptr});
  int argc = 0;
  try {
    orb_ = CORBA::ORB_init(argc, nullptr, "omniORB4", reinterpret_cast<const char*(*)[2]>(options.data()));
  } catch (const CORBA::INITIALIZE&) {
    if (tls->empty()) throw;
    const auto files = corba::tls_of_environment();
    throw std::runtime_error("tls: certificate " + base::in_quotes(files.certificate) + " with its key, or authority " +
                             base::in_quotes(files.authority) +
                             ": cannot be used; expected PEM files, and the key's password in RTMSIM_TLS_PASSWORD");
  }
  CORBA::Object_var object = orb_->resolve_initial_references("RootPOA");
  const PortableServer::POA_var poa = PortableServer::POA::_narrow(object);
  const PortableServer::POAManager_var manager = poa->the_POAManager();
  manager->activate();
}

Orb::~Orb() {
  try {
    orb_->destroy();
  } catch (const CORBA::Exception&) {
    // The process ends anyway.
  }
}

}  // namespace tools
