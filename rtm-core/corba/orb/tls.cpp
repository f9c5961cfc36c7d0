#include "corba/orb/tls.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/text.h"

namespace corba {
namespace {

constexpr char transport[] = "libomnisslTP4.so.2";

base::Result<void> check_file(const char* what, const std::string& file) {
  if (file.empty()) return base::Error{std::string("tls: the ") + what + " is missing: both files are needed, certificate and authority"};
  if (::access(file.c_str(), R_OK) == 0) return {};
  return base::Error{std::string("tls: ") + what + " " + base::in_quotes(file) + ": " + std::strerror(errno)};
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

}  // namespace

TlsSettings tls_of_environment() {
  return {variable("RTMSIM_TLS_CERTIFICATE"), variable("RTMSIM_TLS_AUTHORITY"), variable("RTMSIM_TLS_PASSWORD"), {}};
}

base::Result<std::vector<std::pair<std::string, std::string>>> prepare_tls(const TlsSettings& settings) {
  std::vector<std::pair<std::string, std::string>> arguments;
  if (!settings.is_on()) return arguments;
  if (auto good = check_file("certificate", settings.certificate); !good) return good.error();
  if (auto good = check_file("authority", settings.authority); !good) return good.error();
  // It makes itself known to the ORB by being there. Linked, it would bring OpenSSL into every process.
  if (::dlopen(transport, RTLD_NOW | RTLD_GLOBAL) == nullptr) return base::Error{std::string("tls: ") + ::dlerror()};
  // omniORB reads no key when it is told no password, also one that has none.
  const std::string password = settings.password.empty() ? "none" : settings.password;
  arguments = {{"sslCAFile", settings.authority},
               {"sslKeyFile", settings.certificate},
               {"sslKeyPassword", password},
               {"sslVerifyMode", "peer,fail"}};
  return arguments;
}

}  // namespace corba
