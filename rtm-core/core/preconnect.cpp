#include "core/preconnect.h"

#include <algorithm>
#include <cctype>

#include "base/text.h"

namespace rt {
namespace {

// "port", "port0", "port1", ...
bool is_port_key(std::string_view key) {
  if (!key.starts_with("port")) return false;
  key.remove_prefix(4);
  return std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isdigit(c); });
}

}  // namespace

base::Result<PortAddress> parse_port_address(std::string_view text) {
  text = base::trim(text);
  const auto slash = text.rfind('/');
  const auto dot = text.find('.', slash == std::string_view::npos ? 0 : slash);
  const auto start = slash == std::string_view::npos ? 0 : slash + 1;
  if (dot == std::string_view::npos || dot == start || dot + 1 == text.size()) {
    return base::Error{"port " + base::in_quotes(text) + ": expected component.port"};
  }
  return PortAddress{std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

base::Result<ConnectionRequest> parse_connection(std::string_view text) {
  text = base::trim(text);
  const auto question = text.find('?');
  auto port = parse_port_address(text.substr(0, question));
  if (!port) return port.error();
  ConnectionRequest request{std::string(text), std::move(*port), {}, {}};
  const auto rest = question == std::string_view::npos ? std::string_view() : text.substr(question + 1);
  for (const auto& piece : base::split_list(rest, '&')) {
    const auto equals = piece.find('=');
    if (equals == std::string::npos || equals == 0) {
      return base::Error{"connection " + base::in_quotes(text) + ": expected key=value, got " + base::in_quotes(piece)};
    }
    std::string key(base::trim(piece.substr(0, equals)));
    std::string value(base::trim(std::string_view(piece).substr(equals + 1)));
    if (is_port_key(key)) {
      auto other = parse_port_address(value);
      if (!other) return other.error();
      request.others.push_back(std::move(*other));
    } else {
      if (key.starts_with("dataport.")) key.erase(0, 9);
      request.properties.emplace_back(std::move(key), std::move(value));
    }
  }
  if (request.others.empty()) return base::Error{"connection " + base::in_quotes(text) + ": expected port=component.port"};
  return request;
}

}  // namespace rt
