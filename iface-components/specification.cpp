#include "specification.h"

#include <base/log.h>
#include <base/text.h>

#include <cstdlib>

namespace iface {
namespace {

int read_server() {
  const char* text = std::getenv("RTMSIM_SERVER_ID");
  if (!text || !*text) return 0;
  const auto number = base::parse_integer(text);
  if (number && *number >= 0 && *number <= highest_server) return static_cast<int>(*number);
  base::log(base::Level::warn, "simulator", "RTMSIM_SERVER_ID must be a number from 0 to {}, got {}", highest_server,
            base::in_quotes(text));
  return 0;
}

}  // namespace

int default_server() {
  static const int server = read_server();
  return server;
}

coil::Properties specification(const char* const spec[]) {
  coil::Properties properties(spec);
  properties["conf.default.server_id"] = std::to_string(default_server());
  return properties;
}

}  // namespace iface
