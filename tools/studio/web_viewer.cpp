// One WebSocket: reads what the viewer says, and writes what waits for it, a frame at a time.
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "studio/client_message.h"
#include "studio/foxglove.h"
#include "studio/web_shared.h"

namespace studio {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Code = boost::system::error_code;

constexpr std::chrono::seconds handshake_limit{10}, silence_limit{30};
constexpr std::size_t max_octets_waiting = 16 << 20;
constexpr int send_buffer = 256 << 10;  // [octet] what the system keeps for a viewer that is slow
constexpr int unsent_mark = 32 << 10;   // [octet] with so much unsent the next frame waits here, where a newer one takes its place

class SocketViewer final : public Viewer, public std::enable_shared_from_this<SocketViewer> {
 public:
  SocketViewer(std::shared_ptr<WebShared> shared, beast::tcp_stream stream, HttpRequest request, std::string_view protocol)
      : shared_(std::move(shared)),
        socket_(std::move(stream)),
        request_(std::move(request)),
        protocol_(protocol),
        id_(++shared_->last_viewer) {
    ++shared_->viewers;
  }
  ~SocketViewer() override { --shared_->viewers; }

  std::uint64_t id() const override { return id_; }
  bool speaks_studio() const override { return protocol_ == studio_protocol; }

  void accept() {
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = handshake_limit;
    limits.idle_timeout = silence_limit;
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.set_option(websocket::stream_base::decorator([protocol = std::string(protocol_)](websocket::response_type& response) {
      response.set(beast::http::field::server, "rtm-studio");
      response.set(beast::http::field::sec_websocket_protocol, protocol);
    }));
    socket_.read_message_max(max_message);
    socket_.auto_fragment(false);  // some clients expect whole messages
    const int handle = beast::get_lowest_layer(socket_).socket().native_handle();
    setsockopt(handle, SOL_SOCKET, SO_SNDBUF, &send_buffer, sizeof send_buffer);
    setsockopt(handle, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent_mark, sizeof unsent_mark);
    socket_.async_accept(request_, [self = shared_from_this()](Code code) {
      if (code) return;
      self->request_ = {};
      self->is_open_ = true;
      self->shared_->handlers.joined(self);
      self->read();
    });
  }

  void send(Frame frame) override {
    if (!is_open_) return;
    outbox_.put(std::move(frame));
    if (outbox_.is_overfull()) return finish();
    write();
  }
  void send_newest(const std::string& key, Frame frame) override {
    if (!is_open_) return;
    outbox_.put_newest(key, std::move(frame));
    write();
  }
  void send_newest(const std::string& key, Outbox::Maker maker) override {
    if (!is_open_) return;
    outbox_.put_newest(key, std::move(maker));
    write();
  }
  void drop(const std::string& key) override { outbox_.drop(key); }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Code code, std::size_t) { self->have_read(code); });
  }

  void have_read(Code code) {
    if (code || !is_open_) return finish();
    const auto data = buffer_.cdata();
    const std::string_view octets{static_cast<const char*>(data.data()), data.size()};
    socket_.got_text() ? shared_->handlers.said(*this, octets) : shared_->handlers.sent(*this, octets);
    buffer_.consume(buffer_.size());
    if (is_open_) read();
  }

  void write() {
    if (sending_ || !is_open_) return;
    sending_ = outbox_.next();
    if (!sending_) return;
    socket_.binary(sending_->is_binary);
    socket_.async_write(boost::asio::buffer(*sending_->octets), [self = shared_from_this()](Code code, std::size_t) {
      self->sending_.reset();
      if (code) return self->finish();
      self->write();
    });
  }

  // However it ends: the others are told once, and the socket is closed without waiting for the viewer.
  void finish() {
    if (!is_open_) return;
    is_open_ = false;
    shared_->handlers.left(*this);
    beast::get_lowest_layer(socket_).close();
  }

  std::shared_ptr<WebShared> shared_;
  websocket::stream<beast::tcp_stream> socket_;
  HttpRequest request_;
  std::string_view protocol_;
  std::uint64_t id_;
  beast::flat_buffer buffer_{max_message};
  Outbox outbox_{max_octets_waiting};
  std::optional<Frame> sending_;
  bool is_open_ = false;
};

}  // namespace

void serve_viewer(std::shared_ptr<WebShared> shared, beast::tcp_stream stream, HttpRequest request, std::string_view protocol) {
  std::make_shared<SocketViewer>(std::move(shared), std::move(stream), std::move(request), protocol)->accept();
}

}  // namespace studio
