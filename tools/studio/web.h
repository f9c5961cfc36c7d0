// HTTP and WebSocket of the studio on one event loop. Everything runs on the thread of the loop; only the answer of a fetch can be given
// from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "studio/access_policy.h"
#include "studio/outbox.h"
#include "studio/page_files.h"

namespace boost::asio {
class io_context;
}

namespace studio {

// One WebSocket. What is sent after its end is lost without a word.
class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual std::uint64_t id() const = 0;  // unique in this process
  // False: it speaks foxglove.websocket.v1 and knows nothing else.
  virtual bool speaks_studio() const = 0;
  virtual void send(Frame frame) = 0;
  virtual void send_newest(const std::string& key, Frame frame) = 0;
  virtual void send_newest(const std::string& key, Outbox::Maker maker) = 0;
  // What waits under this key is not sent.
  virtual void drop(const std::string& key) = 0;
};

// The answer to a fetch.
struct Content {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> octets;
  std::string tag;  // ETag, without quotation marks; empty: none
};
using Answer = std::function<void(Content)>;

struct WebHandlers {
  std::function<void(std::shared_ptr<Viewer>)> joined;
  std::function<void(Viewer&, std::string_view)> said;  // a text frame of at most 1 MiB
  std::function<void(Viewer&, std::string_view)> sent;  // a binary frame of at most 1 MiB
  std::function<void(Viewer&)> left;
  // What is made for each request: a path like "/world.glb" and its query. False: there is no such path, and no answer comes.
  std::function<bool(const std::string& path, const std::string& query, Answer answer)> fetch;
};

struct WebOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8700;                // 0: any free one
  bool may_move = false;                    // take any free port when this one is taken
  std::vector<std::string> hosts, origins;  // see AccessPolicy
};

class WebServer {
 public:
  // Listens; nobody is served before the loop runs. The page and the loop must live longer.
  static base::Result<std::unique_ptr<WebServer>> open(boost::asio::io_context& loop, const WebOptions& options, const PageFiles& page,
                                                       WebHandlers handlers);
  virtual ~WebServer() = default;
  virtual std::uint16_t port() const = 0;
  virtual const AccessPolicy& access() const = 0;
};

}  // namespace studio
