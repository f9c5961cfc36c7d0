// Access control of the studio server: checks the token, the Host and the Origin of a request. Values; any thread.
//
// A page of another site that runs in the user's browser can send requests here. It does not know the token; its Origin is not ours; and
// a name that it has made to lead here (DNS rebinding) is not one of our hosts. Each of the three checks is enough to reject it, and all
// are made. There is no cookie: browsers send one to every port of a host, so a server on another port would get it. The page keeps the
// token, and sends it with each request.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace studio {

enum class AccessDecision {
  granted,
  no_token,      // 401
  wrong_token,   // 403
  wrong_host,    // 403
  wrong_origin,  // 403
};

std::string_view to_text(AccessDecision verdict);

// What a request says about its sender; empty: it does not say it.
struct Caller {
  std::string_view host{};           // "127.0.0.1:8700"
  std::string_view origin{};         // "http://127.0.0.1:8700"
  std::string_view authorization{};  // "Bearer TOKEN"
  std::string_view protocols{};      // of a WebSocket: "rtmsim.studio.v1, token.TOKEN"; browsers can send nothing else with one
  std::string_view query{};          // of a WebSocket: "token=TOKEN", from viewers that are given a URL and nothing else
};

class AccessPolicy {
 public:
  // `hosts`: names besides localhost and numeric addresses that browsers may know us by; `origins`: of third-party pages that may connect.
  AccessPolicy(std::string token, std::vector<std::string> hosts, std::vector<std::string> origins);

  // A secret of 128 random bits in hexadecimal digits.
  static base::Result<std::string> make_secret();

  AccessDecision judge(const Caller& caller) const;
  // Host and Origin alone: enough for the page itself, which is the same for everybody and shows nothing without the token.
  AccessDecision judge_sender(const Caller& caller) const;
  const std::string& token() const { return token_; }

 private:
  bool knows_host(std::string_view host) const;
  bool knows_origin(std::string_view origin, std::string_view host) const;
  AccessDecision judge_token(const Caller& caller) const;

  std::string token_;
  std::vector<std::string> hosts_, origins_;
};

// The value of `name` in "a=1&b=2"; percent signs are decoded. Empty when it is not there.
std::string query_value(std::string_view query, std::string_view name);

}  // namespace studio
