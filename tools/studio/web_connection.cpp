// One connection of HTTP: small requests without a body, answered from memory or by a fetch, or turned into a WebSocket.
#include <boost/beast/core.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>

#include "base/peer_account.h"
#include "base/text.h"
#include "studio/foxglove.h"
#include "studio/http_head.h"
#include "studio/web_shared.h"

namespace studio {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;
using Code = boost::system::error_code;
using Response = http::response<http::span_body<const char>>;

constexpr std::chrono::seconds reading_limit{10}, idle_limit{60}, writing_limit{120};
constexpr std::size_t max_buffered = 2 * max_head;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

std::string content_policy(std::string_view host) {
  return "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; font-src 'self'; worker-src 'self' blob:; "
         "connect-src 'self' blob: data: ws://" +
         std::string(host) + " wss://" + std::string(host) + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

std::shared_ptr<const std::string> shared_text(std::string_view text) { return std::make_shared<const std::string>(text); }

// The first of ours that the client speaks; empty: none.
std::string_view agreed_protocol(std::string_view offered) {
  const auto names = base::split_list(offered);
  for (const std::string_view protocol : {studio_protocol, foxglove_sdk_protocol, foxglove_protocol}) {
    if (std::find(names.begin(), names.end(), protocol) != names.end()) return protocol;
  }
  return {};
}

class Connection final : public HttpPeer, public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<WebShared> shared, tcp::socket socket) : shared_(std::move(shared)), stream_(std::move(socket)) {
    standing_.is_own_account = base::is_own_account(base::peer_account(stream_.socket().native_handle()));
    shared_->peers.insert(this);
  }
  ~Connection() { shared_->peers.erase(this); }

  const Standing& standing() const override { return standing_; }
  std::string address() const override {
    Code code;
    const auto end = stream_.socket().remote_endpoint(code);
    return code ? "a connection that is closed" : end.address().to_string() + ":" + std::to_string(end.port());
  }
  void give_way() override {
    shared_->peers.erase(this);
    stream_.close();  // what is under way ends with an error, and then this
  }

  void read() {
    stream_.expires_after(is_first_ ? reading_limit : idle_limit);
    is_first_ = false;
    have_read({});
  }

 private:
  std::string_view unread() const { return {static_cast<const char*>(buffer_.cdata().data()), buffer_.size()}; }

  // Another request may have come together with the one before.
  void have_read(Code code) {
    if (code == boost::asio::error::eof || code == beast::error::timeout) return end();
    if (code) return;
    const auto head = find_head_end(unread());
    if (head.state == HeadEnd::State::too_long) return refuse(431, "the header is longer than 8 KiB");
    if (head.state == HeadEnd::State::malformed) return refuse(400, "this is no HTTP request");
    if (head.state == HeadEnd::State::complete) return have_head(head.size);
    const auto room = std::min<std::size_t>(max_buffered - buffer_.size(), 4096);
    stream_.async_read_some(buffer_.prepare(room), [self = shared_from_this()](Code problem, std::size_t count) {
      self->buffer_.commit(count);
      self->have_read(problem);
    });
  }

  void have_head(std::size_t size) {
    if (const auto problem = check_head(unread().substr(0, size))) return refuse(problem->status, problem->why);
    http::request_parser<http::empty_body> parser;
    parser.eager(true);
    Code code;
    const auto taken = parser.put(boost::asio::buffer(buffer_.cdata(), size), code);
    if (code || taken != size || !parser.is_done()) return refuse(400, "this is no HTTP request");
    buffer_.consume(size);
    request_ = parser.release();
    answer();
  }

  // Of a field that may come several times, which is one list.
  std::string all_of(http::field field) const {
    std::string list;
    const auto [begin, last] = request_.equal_range(field);
    for (auto at = begin; at != last; ++at) list += (list.empty() ? "" : ", ") + std::string(view(at->value()));
    return list;
  }

  void answer() {
    const auto target = origin_form(view(request_.target()));
    const auto question = std::min(target.find('?'), target.size());
    const std::string path(target.substr(0, question));
    const std::string query(target.substr(std::min(question + 1, target.size())));
    const bool is_upgrade = beast::websocket::is_upgrade(request_);
    const auto protocols = all_of(http::field::sec_websocket_protocol);
    Caller caller{view(request_[http::field::host]), view(request_[http::field::origin]), view(request_[http::field::authorization])};
    if (is_upgrade) caller.protocols = protocols, caller.query = query;
    const PageFile* file = is_upgrade ? nullptr : shared_->page.find(path);
    const auto verdict = file != nullptr ? shared_->access.judge_sender(caller) : shared_->access.judge(caller);
    if (verdict != AccessDecision::granted) return refuse(verdict == AccessDecision::no_token ? 401 : 403, to_text(verdict));
    standing_.was_granted = standing_.was_granted || file == nullptr;
    standing_.last_use = std::chrono::steady_clock::now();
    if (is_upgrade) return upgrade(path, protocols);
    if (request_.method() != http::verb::get && request_.method() != http::verb::head) return refuse(405, "only GET and HEAD are answered");
    if (file != nullptr) return send_file(*file, path != "/");
    if (path == "/access") return send_content({204, "", shared_text(""), ""});
    const bool is_fetched = shared_->handlers.fetch(path, query, [self = shared_from_this()](Content content) {
      boost::asio::post(self->stream_.get_executor(), [self, content = std::move(content)] { self->send_content(content); });
    });
    if (!is_fetched) return refuse(404, "no page of this name");
    stream_.expires_never();  // a fetch ends in time
  }

  void upgrade(const std::string& path, std::string_view protocols) {
    const auto protocol = agreed_protocol(protocols);
    if (path != "/ws") return refuse(404, "the WebSocket is at /ws");
    if (protocol.empty())
      return refuse(400, "expected the WebSocket subprotocol rtmsim.studio.v1, foxglove.sdk.v1 or foxglove.websocket.v1");
    if (shared_->viewers >= max_viewers) return refuse(503, "there are 32 viewers already");
    stream_.expires_never();  // the WebSocket has its own
    serve_viewer(shared_, std::move(stream_), std::move(request_), protocol);
  }

  Response response(unsigned status) {
    Response response{http::int_to_status(status), request_.version() == 10 ? 10u : 11u};
    response.set(http::field::server, "rtm-studio");
    response.set("Content-Security-Policy", content_policy(view(request_[http::field::host])));
    response.set("X-Content-Type-Options", "nosniff");
    response.set("X-Frame-Options", "DENY");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set(http::field::cache_control, "no-store");
    response.keep_alive(request_.keep_alive());
    return response;
  }

  // Files of assets/ have new names when they change.
  void send_file(const PageFile& file, bool is_lasting) {
    auto answer = response(200);
    answer.set(http::field::content_type, file.type);
    if (is_lasting) answer.set(http::field::cache_control, "private, max-age=31536000, immutable");
    answer.set(http::field::vary, "Accept-Encoding");
    const bool is_compressed =
        !file.compressed.empty() && view(request_[http::field::accept_encoding]).find("gzip") != std::string_view::npos;
    if (is_compressed) answer.set(http::field::content_encoding, "gzip");
    const auto& octets = is_compressed ? file.compressed : file.octets;
    send(std::move(answer), {std::shared_ptr<void>(), &octets});  // the page outlives us
  }

  void send_content(const Content& content) {
    const auto tag = content.tag.empty() ? "" : "\"" + content.tag + "\"";
    const bool is_known = content.status == 200 && !tag.empty() && view(request_[http::field::if_none_match]) == tag;
    auto answer = response(is_known ? 304 : content.status);
    if (!tag.empty()) {
      answer.set(http::field::etag, tag);
      answer.set(http::field::cache_control, "private, no-cache");
    }
    if (!is_known && !content.type.empty()) answer.set(http::field::content_type, content.type);
    send(std::move(answer), is_known ? shared_text("") : content.octets);
  }

  void refuse(unsigned status, std::string_view why) {
    if (status == 400 || status == 413 || status == 431) request_ = HttpRequest();  // what came is not to be used
    auto answer = response(status);
    answer.set(http::field::content_type, "text/plain; charset=utf-8");
    answer.keep_alive(status != 400 && status != 413 && status != 431 && answer.keep_alive());
    if (status == 405) answer.set(http::field::allow, "GET, HEAD");
    send(std::move(answer), shared_text("rtm-studio: " + std::string(why) + "\n"));
  }

  void send(Response answer, std::shared_ptr<const std::string> octets) {
    octets_ = std::move(octets);
    const bool has_body = answer.result() != http::status::not_modified && answer.result() != http::status::no_content;
    if (has_body) answer.content_length(octets_->size());
    is_last_ = !answer.keep_alive();
    stream_.expires_after(writing_limit);
    if (has_body && request_.method() != http::verb::head) answer.body() = beast::span<const char>(octets_->data(), octets_->size());
    response_ = std::make_unique<Response>(std::move(answer));
    serializer_.emplace(*response_);
    const auto done = [self = shared_from_this()](Code code, std::size_t) { self->have_sent(code); };
    if (request_.method() == http::verb::head) {
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *serializer_, done);
    }
  }

  void have_sent(Code code) {
    serializer_.reset();
    response_.reset();
    if (code) return;
    if (is_last_) return end();
    read();
  }

  void end() {
    Code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  std::shared_ptr<WebShared> shared_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{max_buffered};
  HttpRequest request_;
  std::unique_ptr<Response> response_;
  std::optional<http::serializer<false, http::span_body<const char>>> serializer_;
  std::shared_ptr<const std::string> octets_;  // of the response
  Standing standing_;
  bool is_first_ = true;
  bool is_last_ = false;
};

}  // namespace

void serve_connection(std::shared_ptr<WebShared> shared, tcp::socket socket) {
  std::make_shared<Connection>(std::move(shared), std::move(socket))->read();
}

}  // namespace studio
