#include "orb.h"

#include <cstdlib>

#include "base/text.h"

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
  const char* options[][2] = {{"endPoint", "giop:tcp:127.0.0.1:"},
                              {"giopMaxMsgSize", "268435456"},
                              {"supportPerThreadTimeOut", "1"},
                              // No limit of its own for new connections: it would replace the limit of the first call over each.
                              {"clientCallTimeOutPeriod", "30000"},
                              {nullptr, nullptr}};
  int argc = 0;
  orb_ = CORBA::ORB_init(argc, nullptr, "omniORB4", options);
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
