#include "run/same_math.h"

#include <cstdlib>
#include <string_view>

namespace tools {

std::pair<std::string, std::string> same_math() {
  constexpr auto variable = "GLIBC_TUNABLES";
  constexpr std::string_view key = "glibc.cpu.hwcaps=", wanted = "-FMA,-FMA4";
  const char* const given = std::getenv(variable);
  std::string value = given != nullptr ? given : "";
  if (const auto at = value.find(key); at != std::string::npos) {
    value.insert(at + key.size(), std::string(wanted) + ",");
  } else {
    value += (value.empty() ? "" : ":") + std::string(key) + std::string(wanted);
  }
  return {variable, value};
}

}  // namespace tools
