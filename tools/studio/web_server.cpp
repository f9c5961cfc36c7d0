// Listens, and hands each connection on.
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "base/log.h"
#include "studio/web_shared.h"

namespace studio {
namespace {

using boost::asio::ip::tcp;
using Code = boost::system::error_code;

constexpr std::chrono::milliseconds recovery{100};  // after an accept that failed: descriptors may be free again
constexpr std::chrono::seconds between_lines{1};    // of the log, about those who had to go

class Listener final : public WebServer {
 public:
  Listener(std::shared_ptr<WebShared> shared, tcp::acceptor acceptor)
      : shared_(std::move(shared)), acceptor_(std::move(acceptor)), timer_(shared_->loop) {}

  std::uint16_t port() const override {
    Code ignored;
    return acceptor_.local_endpoint(ignored).port();
  }
  const AccessPolicy& access() const override { return shared_->access; }

  void accept() {
    acceptor_.async_accept([this](Code code, tcp::socket socket) {
      if (code == boost::asio::error::operation_aborted) return;
      if (!code) serve(std::move(socket));
      if (!code) return accept();
      if (code == boost::asio::error::no_descriptors && make_room()) return accept();
      timer_.expires_after(recovery);
      timer_.async_wait([this](Code stopped) {
        if (!stopped) accept();
      });
    });
  }

 private:
  void serve(tcp::socket socket) {
    Code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    if (shared_->peers.size() + shared_->viewers >= max_connections) (void)make_room();
    serve_connection(shared_, std::move(socket));
  }

  // Viewers stay. False: there is nobody else.
  bool make_room() {
    const auto least = std::ranges::min_element(shared_->peers, {}, [](const HttpPeer* peer) { return peer->standing(); });
    if (least == shared_->peers.end()) return false;
    complain((*least)->address() + " rejected: too many connections, and this one was silent longest");
    (*least)->give_way();
    return true;
  }

  // One line a second at most, however many are sent away.
  void complain(const std::string& line) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_line_ < between_lines) {
      ++unsaid_;
      return;
    }
    last_line_ = now;
    const auto others = std::exchange(unsaid_, 0);
    base::log(base::Level::warn, "web", "{}{}", line, others > 0 ? "; so were " + std::to_string(others) + " others" : "");
  }

  std::shared_ptr<WebShared> shared_;
  tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  std::chrono::steady_clock::time_point last_line_{};
  std::size_t unsaid_ = 0;
};

Code listen(tcp::acceptor& acceptor, const tcp::endpoint& endpoint) {
  Code code;
  acceptor.open(endpoint.protocol(), code);
  if (!code) acceptor.set_option(tcp::acceptor::reuse_address(true), code);
  if (!code) acceptor.bind(endpoint, code);
  if (!code) acceptor.listen(boost::asio::socket_base::max_listen_connections, code);
  if (code && acceptor.is_open()) {
    Code ignored;
    acceptor.close(ignored);
  }
  return code;
}

}  // namespace

base::Result<std::unique_ptr<WebServer>> WebServer::open(boost::asio::io_context& loop, const WebOptions& options, const PageFiles& page,
                                                         WebHandlers handlers) {
  Code code;
  const auto address = boost::asio::ip::make_address(options.address, code);
  if (code) return base::Error{"address " + options.address + ": expected a numeric address, such as 127.0.0.1 or 0.0.0.0"};
  tcp::acceptor acceptor(loop);
  code = listen(acceptor, {address, options.port});
  if (code && options.may_move) code = listen(acceptor, {address, 0});
  if (code) return base::Error{"port " + std::to_string(options.port) + " of " + options.address + ": " + code.message()};
  auto token = AccessPolicy::make_secret();
  if (!token) return token.error();
  AccessPolicy access(std::move(*token), options.hosts, options.origins);
  auto shared = std::make_shared<WebShared>(WebShared{loop, std::move(access), page, std::move(handlers), {}});
  auto listener = std::make_unique<Listener>(std::move(shared), std::move(acceptor));
  listener->accept();
  return std::unique_ptr<WebServer>(std::move(listener));
}

}  // namespace studio
