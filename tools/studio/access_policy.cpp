#include "studio/access_policy.h"

#include <arpa/inet.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/text.h"

namespace studio {
namespace {

// Takes as long for every wrong guess of the right length.
bool is_secret(std::string_view guess, std::string_view secret) {
  if (guess.size() != secret.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < secret.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(guess[i]) ^ static_cast<unsigned char>(secret[i]));
  return difference == 0;
}

// "[::1]:8700" -> "::1", "name:8700" -> "name"; empty when it is neither.
std::string_view without_port(std::string_view host) {
  const auto is_port = [](std::string_view text) {
    return text.empty() || (text.front() == ':' && text.size() <= 6 && text.find_first_not_of("0123456789", 1) == std::string_view::npos);
  };
  if (host.starts_with('[')) {
    const auto end = host.find(']');
    return end != std::string_view::npos && is_port(host.substr(end + 1)) ? host.substr(1, end - 1) : std::string_view();
  }
  const auto colon = std::min(host.find(':'), host.size());
  return is_port(host.substr(colon)) ? host.substr(0, colon) : std::string_view();
}

// Nobody can make a number lead elsewhere.
bool is_numeric(std::string_view host) {
  const std::string text(host);
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, text.c_str(), address.data()) == 1 || inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

std::string_view bearer(std::string_view authorization) {
  constexpr std::string_view scheme = "bearer ";
  if (authorization.size() <= scheme.size() || !base::equal_ignoring_case(authorization.substr(0, scheme.size()), scheme)) return {};
  return base::trim(authorization.substr(scheme.size()));
}

// Of the subprotocols that a WebSocket offers, the one that is none.
std::string protocol_token(std::string_view protocols) {
  constexpr std::string_view begin = "token.";
  for (const auto& name : base::split_list(protocols)) {
    if (name.starts_with(begin)) return name.substr(begin.size());
  }
  return {};
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_escape = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
    if (!is_escape) {
      result += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
    i += 2;
  }
  return result;
}

}  // namespace

std::string_view to_text(AccessDecision verdict) {
  switch (verdict) {
    case AccessDecision::granted:
      return "granted";
    case AccessDecision::no_token:
      return "open the URL that rtm-studio printed: it has the token without which nothing is shown";
    case AccessDecision::wrong_token:
      return "this token is not that of this rtm-studio; open the URL that it printed last";
    case AccessDecision::wrong_host:
      return "rtm-studio is not known by this host name; use a numeric address or localhost, or start it with --host NAME";
    case AccessDecision::wrong_origin:
      return "pages of this origin may not connect; rtm-studio --allow-origin ORIGIN lets them";
  }
  return "?";
}

AccessPolicy::AccessPolicy(std::string token, std::vector<std::string> hosts, std::vector<std::string> origins)
    : token_(std::move(token)), hosts_(std::move(hosts)), origins_(std::move(origins)) {}

base::Result<std::string> AccessPolicy::make_secret() {
  std::array<unsigned char, 16> octets{};
  if (getrandom(octets.data(), octets.size(), 0) != static_cast<ssize_t>(octets.size()))
    return base::Error{std::string("no random numbers: ") + std::strerror(errno)};
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned octet : octets) text += {digits[octet / 16], digits[octet % 16]};
  return text;
}

AccessDecision AccessPolicy::judge(const Caller& caller) const {
  const auto sender = judge_sender(caller);
  return sender == AccessDecision::granted ? judge_token(caller) : sender;
}

AccessDecision AccessPolicy::judge_sender(const Caller& caller) const {
  if (!knows_host(caller.host)) return AccessDecision::wrong_host;
  return caller.origin.empty() || knows_origin(caller.origin, caller.host) ? AccessDecision::granted : AccessDecision::wrong_origin;
}

bool AccessPolicy::knows_host(std::string_view host) const {
  const auto name = without_port(host);
  if (name.empty()) return false;
  if (base::equal_ignoring_case(name, "localhost") || is_numeric(name)) return true;
  return std::any_of(hosts_.begin(), hosts_.end(), [&](const std::string& known) { return base::equal_ignoring_case(name, known); });
}

bool AccessPolicy::knows_origin(std::string_view origin, std::string_view host) const {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme) && base::equal_ignoring_case(origin.substr(scheme.size()), host)) return true;
  }
  return std::find(origins_.begin(), origins_.end(), origin) != origins_.end();
}

// Each that is brought must be right: an old one in a URL is told, whatever a header says.
AccessDecision AccessPolicy::judge_token(const Caller& caller) const {
  bool is_brought = false, is_right = true;
  for (const auto& guess :
       {std::string(bearer(caller.authorization)), protocol_token(caller.protocols), query_value(caller.query, "token")}) {
    if (guess.empty()) continue;
    is_brought = true;
    is_right = is_secret(guess, token_) && is_right;
  }
  if (!is_brought) return AccessDecision::no_token;
  return is_right ? AccessDecision::granted : AccessDecision::wrong_token;
}

std::string query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const auto end = std::min(query.find('&'), query.size());
    const auto pair = query.substr(0, end);
    const auto equals = std::min(pair.find('='), pair.size());
    if (pair.substr(0, equals) == name) return decoded(pair.substr(std::min(equals + 1, pair.size())));
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

}  // namespace studio
