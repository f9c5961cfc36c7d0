#include "base/own_account.h"

#include <dlfcn.h>
#include <unistd.h>

namespace base {

std::string own_account_door() {
  Dl_info place{};
  if (dladdr(reinterpret_cast<const void*>(&own_account_door), &place) == 0 || place.dli_fname == nullptr) return {};
  std::string file = place.dli_fname;
  const auto slash = file.rfind('/');
  if (slash == std::string::npos) return {};
  file = file.substr(0, slash + 1) + "librtmsim_own_account.so";
  return access(file.c_str(), R_OK) == 0 ? file : std::string();
}

}  // namespace base
