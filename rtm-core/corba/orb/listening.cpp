#include "corba/orb/listening.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "base/text.h"

namespace corba {
namespace {

// 0, or errno.
int try_to_bind(const addrinfo& address) {
  const int handle = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (handle < 0) return errno;
  const int on = 1;
  (void)::setsockopt(handle, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool is_good = ::bind(handle, address.ai_addr, address.ai_addrlen) == 0 && ::listen(handle, 1) == 0;
  const int problem = is_good ? 0 : errno;
  ::close(handle);
  return problem;
}

std::string in_words(int problem, const std::string& host, const std::string& port) {
  switch (problem) {
    case EADDRINUSE:
      return "port " + port + " is taken by another process";
    case EADDRNOTAVAIL:
      return "no network interface of this machine has the address " + host +
             (host == "127.0.0.1" || host == "0.0.0.0"
                  ? "; where there is IPv6 alone, set corba.endpoints to [::1], or to [::] for other machines"
                  : "");
    case EAFNOSUPPORT:
      return "this machine has no network of the family of " + host;
    case EACCES:
      return "port " + port + " may be used by root alone";
    default:
      return std::generic_category().message(problem);
  }
}

}  // namespace

std::string listening_problem(std::string_view endpoint) {
  for (const std::string_view kind : {"giop:tcp:", "giop:ssl:"}) {
    if (!endpoint.starts_with(kind)) continue;
    const auto place = endpoint.substr(kind.size());
    const auto colon = place.rfind(':');
    if (colon == std::string_view::npos) return "";
    std::string host(place.substr(0, colon));
    const std::string port(place.substr(colon + 1));
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    if (const int code = ::getaddrinfo(host.empty() ? nullptr : host.c_str(), port.empty() ? "0" : port.c_str(), &wanted, &found);
        code != 0)
      return "host " + base::in_quotes(host) + " is not known: " + gai_strerror(code);
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
    const int problem = try_to_bind(*found);
    return problem == 0 ? "" : in_words(problem, host, port);
  }
  return "";
}

}  // namespace corba
