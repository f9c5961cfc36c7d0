// The ORB of a tool, and the name server that it uses by default. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <string>

namespace tools {

// The first of $RTCTREE_NAMESERVERS, else localhost:2809.
std::string default_server();

// The ORB of a tool: it listens on loopback only, for the ports that print and inject make, and lets in only the own account, or with
// RTMSIM_OPEN_TO=host all of this machine. Throws std::runtime_error when the environment says what cannot be.
class Orb {
 public:
  Orb();
  ~Orb();
  Orb(const Orb&) = delete;
  Orb& operator=(const Orb&) = delete;
  CORBA::ORB_ptr get() const { return orb_; }

 private:
  CORBA::ORB_var orb_;
};

}  // namespace tools
