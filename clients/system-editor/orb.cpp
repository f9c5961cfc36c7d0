#include "orb.h"

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "base/text.h"
#include "corba/tls.h"

namespace editor {

std::string default_server() {
  // rtshell's variable; several servers are separated by ';'.
  if (const char* servers = std::getenv("RTCTREE_NAMESERVERS")) {
    const auto list = base::split_list(servers, ';');
    if (!list.empty()) return list.front();
  }
  return "localhost:2809";
}

Orb::Orb() {
  const auto tls = corba::prepare_tls(corba::tls_of_environment());
  if (!tls) throw std::runtime_error(tls.error().message);
  std::vector<std::array<const char*, 2>> options{
      {"endPoint", "giop:tcp:127.0.0.1:"},
      {"giopMaxMsgSize", "268435456"},
      {"supportPerThreadTimeOut", "1"},
      // No limit of its own for new connections: it would replace the limit of the first call over each.
      {"clientCallTimeOutPeriod", "30000"}};
  for (const auto& [name, value] : *tls) options.push_back({name.c_str(), value.c_str()});
  if (!tls->empty()) options.push_back({"endPoint", "giop:ssl::"});  // what ports of other hosts send comes here
  options.push_back({nullptr, nullptr});
  int argc = 0;
  orb_ = CORBA::ORB_init(argc, nullptr, "omniORB4", reinterpret_cast<const char*(*)[2]>(options.data()));
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

}  // namespace editor
