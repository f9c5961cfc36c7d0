// Addresses of components, ports and contexts on the command line. Values; any thread. Forms:
// /HOST[:PORT]/CONTEXT.KIND/.../NAME.rtc[:PORT-NAME], the same without the leading slash relative to $RTCSH_CWD, or any tail that names one
// thing only (NAME:PORT-NAME, NAME, CONTEXT/NAME). A trailing slash is accepted.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace tools {

struct Address {
  bool is_absolute = false;
  std::vector<std::string> segments;  // absolute: the first is the name server; each "id" or "id.kind"
  std::string port;                   // without the instance prefix; empty: none given

  std::string text() const;
};

// `working` is $RTCSH_CWD or empty. "." and ".." are resolved.
base::Result<Address> parse_address(std::string_view text, std::string_view working);

// Does one segment of an address name this binding? "id.kind" must match both, "id" matches any kind.
bool matches(const std::string& segment, const std::string& id, const std::string& kind);

// The form of naming services: '/', '.' and '\' inside a name are escaped with '\'.
std::string escape_name(const std::string& text);
// "id.kind" split at the first unescaped dot, both unescaped.
std::pair<std::string, std::string> split_kind(const std::string& segment);

// Where paths without a leading '/' begin: RTCSH_CWD, which the tools of the field set.
std::string working_path();

}  // namespace tools
