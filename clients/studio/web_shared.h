// What the connections of one server share. The loop's thread only.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <memory>

#include "web.h"

namespace studio {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

inline constexpr std::size_t most_connections = 128;
inline constexpr std::size_t most_viewers = 32;

struct WebShared {
  boost::asio::io_context& loop;
  Door door;
  const PageFiles& page;
  WebHandlers handlers;
  std::size_t connections = 0;  // of HTTP, before some of them become viewers
  std::size_t viewers = 0;
  std::uint64_t last_viewer = 0;
};

void serve_connection(std::shared_ptr<WebShared> shared, boost::asio::ip::tcp::socket socket);
// Takes the stream over; `protocol` is the subprotocol that was agreed on.
void serve_viewer(std::shared_ptr<WebShared> shared, boost::beast::tcp_stream stream, HttpRequest request, std::string_view protocol);

}  // namespace studio
