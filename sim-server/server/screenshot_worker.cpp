#include "server/screenshot_worker.h"

#include <algorithm>
#include <utility>

namespace sim {

ScreenshotWorker::ScreenshotWorker(std::function<void()> on_done) : on_done_(std::move(on_done)) {}

ScreenshotWorker::~ScreenshotWorker() {
  state_.lock()->is_ending = true;
  changed_.notify_all();
}

void ScreenshotWorker::take(Order order) {
  if (!thread_.joinable()) thread_ = std::jthread([this] { run(); });
  ++under_way_;
  state_.lock()->orders.push_back(std::move(order));
  changed_.notify_all();
}

std::vector<ScreenshotWorker::Done> ScreenshotWorker::finished() {
  if (under_way_ == 0) return {};
  auto done = std::exchange(state_.lock()->done, {});
  under_way_ -= done.size();
  return done;
}

void ScreenshotWorker::run() {
  while (true) {
    std::optional<Order> order;
    {
      auto state = state_.lock();
      while (!state.wait_for(changed_, std::chrono::hours(1), [&] { return state->is_ending || !state->orders.empty(); })) {
      }
      if (state->is_ending) break;
      order = std::move(state->orders.front());
      state->orders.erase(state->orders.begin());
    }
    shm::Reply reply = make(*order);
    state_.lock()->done.push_back({order->ticket, std::move(reply)});
    order.reset();
    on_done_();
  }
  renderer_.reset();  // in the thread that it belongs to
}

shm::Reply ScreenshotWorker::make(const Order& order) {
  shm::Reply reply = order.reply;
  const auto fail = [&](const base::Error& error) {
    reply.status = shm::RequestStatus::failed;
    reply.message = error.message;
    return reply;
  };
  const auto* plan = std::get_if<ExportPlan>(&order.work);
  auto octets = plan != nullptr ? write_export(*plan) : draw(std::get<Picture>(order.work));
  if (!octets) return fail(octets.error());
  if (octets->size() > shm::max_text) {
    const std::string what = plan != nullptr ? "export: " : "picture: ";
    return fail({what + std::to_string(octets->size() >> 20U) + " MiB, at most 64 MiB can be handed over"});
  }
  reply.text = std::move(*octets);
  return reply;
}

namespace {

// Red, green and blue, rows from the top down.
std::string pixels_of(const Image& image) {
  std::string pixels(image.size_bytes() / 4 * 3, '\0');
  for (std::size_t from = 0, to = 0; to < pixels.size(); from += 4, to += 3) std::copy_n(&image.rgba[from], 3, &pixels[to]);
  return pixels;
}

}  // namespace

base::Result<std::string> ScreenshotWorker::draw(const Picture& picture) {
  if (!renderer_) {
    auto opened = Renderer::open();
    if (!opened) return opened.error();
    renderer_ = std::move(*opened);
  }
  const auto image = draw_picture(*renderer_, picture.plan);
  if (!image) return image.error();
  if (picture.as_pixels) return pixels_of(*image);
  if (!picture.file.empty()) {
    const auto written = write_png(*image, picture.file);
    return written ? base::Result<std::string>("") : written.error();
  }
  const auto octets = encode_png(*image, "of the world");
  if (!octets) return octets.error();
  return std::string(octets->begin(), octets->end());
}

}  // namespace sim
