// The shared state of the connections of one server. The loop's thread only.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <compare>
#include <memory>
#include <set>
#include <string>

#include "studio/web.h"

namespace studio {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

inline constexpr std::size_t max_connections = 128;
inline constexpr std::size_t max_viewers = 32;

// A connection of HTTP. It may have to go so that another can come; a viewer never has to.
class HttpPeer {
 public:
  // The least goes first. Only a whole request that was granted counts: who trickles octets or guesses tokens is as good as silent.
  struct Standing {
    bool was_granted = false, is_own_account = false;
    std::chrono::steady_clock::time_point last_use = std::chrono::steady_clock::now();
    auto operator<=>(const Standing&) const = default;
  };
  virtual const Standing& standing() const = 0;
  virtual std::string address() const = 0;
  virtual void give_way() = 0;

 protected:
  ~HttpPeer() = default;
};

struct WebShared {
  boost::asio::io_context& loop;
  AccessPolicy access;
  const PageFiles& page;
  WebHandlers handlers;
  std::set<HttpPeer*> peers;  // before some of them become viewers; none that has given way
  std::size_t viewers = 0;
  std::uint64_t last_viewer = 0;
};

void serve_connection(std::shared_ptr<WebShared> shared, boost::asio::ip::tcp::socket socket);
// Takes the stream over; `protocol` is the subprotocol that was agreed on.
void serve_viewer(std::shared_ptr<WebShared> shared, boost::beast::tcp_stream stream, HttpRequest request, std::string_view protocol);

}  // namespace studio
