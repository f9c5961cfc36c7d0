// Draws and writes screenshots, and writes exports, in a thread of its own: a screenshot takes as long as many steps, and the simulation
// continues meanwhile. The stepping thread only, but for what `on_done` does.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <variant>
#include <vector>

#include "base/guarded.h"
#include "server/exchange.h"
#include "server/picture.h"
#include "shm/request_board.h"

namespace sim {

class ScreenshotWorker {
 public:
  // Called on the worker's thread after each image.
  explicit ScreenshotWorker(std::function<void()> on_done);
  // Waits for the image in progress; later orders are dropped.
  ~ScreenshotWorker();
  ScreenshotWorker(const ScreenshotWorker&) = delete;
  ScreenshotWorker& operator=(const ScreenshotWorker&) = delete;

  struct Picture {
    PicturePlan plan;
    std::filesystem::path file;  // empty: the PNG becomes the text of the reply
    bool as_pixels = false;      // red, green and blue bytes become the text instead
  };
  struct Order {
    shm::RequestTicket ticket;
    std::variant<Picture, ExportPlan> work;
    shm::Reply reply;  // when all goes well; an export becomes its text
  };
  void take(Order order);
  // One load when nothing is ordered.
  struct Done {
    shm::RequestTicket ticket;
    shm::Reply reply;
  };
  std::vector<Done> finished();

 private:
  struct State {
    std::vector<Order> orders;
    std::vector<Done> done;
    bool is_ending = false;
  };
  void run();
  shm::Reply make(const Order& order);
  // The text of the reply.
  base::Result<std::string> draw(const Picture& picture);

  std::function<void()> on_done_;
  std::size_t under_way_ = 0;
  std::unique_ptr<Renderer> renderer_;  // the thread's; opened with the first picture
  base::Guarded<State, base::Rank::queue> state_;
  std::condition_variable changed_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace sim
