// TLS between machines, by omniORB's own transport (in Debian's libomniorb4-2). Both sides need a certificate of the same authority; all
// others are rejected. Host names in certificates are not checked. A value; any thread.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace corba {

struct TlsSettings {
  std::string certificate{};  // file in PEM: the own key and certificate
  std::string authority{};    // file in PEM: certificates of those who sign
  std::string password{};     // of the key; empty: it has none
  // Where to listen: "HOST:PORT", ":PORT" (every interface); empty text: any free port. None: only calls to others go over TLS.
  std::vector<std::string> endpoints{};

  bool is_on() const { return !certificate.empty() || !authority.empty(); }
};

// What RTMSIM_TLS_CERTIFICATE, RTMSIM_TLS_AUTHORITY and RTMSIM_TLS_PASSWORD say: for tools, which read no rtc.conf.
TlsSettings tls_of_environment();

// Loads the transport and gives the arguments that the ORB needs for it, pairs of name (without -ORB) and value. To be called before the
// ORB is made. Nothing when TLS is off. Fails with one line when a file is missing or can't be read, or the transport is not installed.
base::Result<std::vector<std::pair<std::string, std::string>>> prepare_tls(const TlsSettings& settings);

}  // namespace corba
