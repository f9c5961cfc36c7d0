#include "base/own_account.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>

#include "base/text.h"

namespace base {

std::string own_account_door() {
  Dl_info place{};
  if (dladdr(reinterpret_cast<const void*>(&own_account_door), &place) == 0 || place.dli_fname == nullptr) return {};
  std::string file = place.dli_fname;
  const auto slash = file.rfind('/');
  if (slash == std::string::npos) return {};
  const auto folder = file.substr(0, slash + 1);
  // Built, it is beside this library; installed, in the folder of what no one links.
  for (const char* below : {"", "rtm-sim/"}) {
    file = folder + below + "librtmsim_own_account.so";
    if (access(file.c_str(), R_OK) == 0) return file;
  }
  return {};
}

std::string with_numeric_host(std::string_view address) {
  std::string_view protocol, host = address;
  for (const std::string_view known : {"iiop:", "ssliop:"})
    if (address.starts_with(known)) protocol = known, host = address.substr(known.size());
  const auto name = host.substr(0, std::min(host.find_first_of(":/"), host.size()));
  if (!equal_ignoring_case(name, "localhost")) return std::string(address);
  return std::string(protocol) + "127.0.0.1" + std::string(host.substr(name.size()));
}

}  // namespace base
