#include "access_policy.h"

#include <arpa/inet.h>

#include "base/peer_account.h"

namespace gateway {
namespace {

bool is_loopback(const std::string& address) {
  in_addr v4;
  in6_addr v6;
  if (::inet_pton(AF_INET, address.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  return ::inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

}  // namespace

Entry AccessPolicy::entry(int socket) const {
  if (is_open || base::is_own_account(base::peer_account(socket))) return Entry::welcome;
  return key.empty() ? Entry::refused : Entry::needs_key;
}

bool AccessPolicy::fits(std::string_view offered) const {
  unsigned char difference = key.empty() || offered.size() != key.size() ? 1 : 0;
  for (std::size_t i = 0; i < max_key; ++i) {
    const auto at = [i](std::string_view text) {
      return i < text.size() ? static_cast<unsigned char>(text[i]) : static_cast<unsigned char>(0);
    };
    difference = static_cast<unsigned char>(difference | (at(key) ^ at(offered)));
  }
  return difference == 0;
}

std::string describe(const AccessPolicy& access, const std::string& address) {
  if (access.is_open)
    return "open: every client that reaches " + address +
           " may drive the robots, look through their cameras and move the models of this simulation";
  if (!access.key.empty()) return "open to other accounts and hosts that reach " + address + " and send the key";
  if (!is_loopback(address))
    return "listening on " + address +
           ", but clients of other hosts and accounts are rejected: expected --auth KEY or --open to accept them";
  return {};
}

std::optional<std::string_view> ClientTimeouts::expired(Time now, bool is_admitted, bool has_part) {
  if (!is_admitted && now - connected_ >= first_request) return "has sent no whole request in 5 s";
  if (!has_part) {
    part_since_.reset();
    return std::nullopt;
  }
  if (!part_since_) part_since_ = now;
  if (now - *part_since_ >= whole_message) return "has not ended a message in 30 s";
  return std::nullopt;
}

}  // namespace gateway
