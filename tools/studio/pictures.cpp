#include "studio/pictures.h"

#include <algorithm>
#include <optional>

#include "channels/views/iface_view.h"
#include "shm/client.h"
#include "studio/foxglove.h"
#include "studio/shown_picture.h"

namespace studio {
namespace {

using namespace std::chrono_literals;

constexpr auto look_period = 20ms;
constexpr auto return_period = 500ms;  // a camera that is away is looked for so often
constexpr char picture_octet = static_cast<char>(0x83);

}  // namespace

// One camera, its newest frame encoded once.
class Pictures::Camera {
 public:
  Camera(std::uint32_t server_id, std::string name) : server_id_(server_id), name_(std::move(name)) {}

  void look() {
    if (!iface_ && !open()) return;
    if (iface_->status() != shm::Status::live) {
      iface_.reset();
      problem_ = "camera " + name_ + ": the simulator has exited, or has removed it";
      return;
    }
    if (iface_->sequence() == sequence_) return;
    const auto frame = iface_->hold();
    if (!frame) return;
    sequence_ = frame->sequence();
    time_ = std::chrono::nanoseconds(frame->head().stamp.sim_time_ns);
    const auto& head = frame->head();
    auto jpeg = jpeg_of({head.width,
                         head.height,
                         head.stride,
                         channels::encoding_of(static_cast<shm::Format>(head.format)),
                         {reinterpret_cast<const char*>(frame->data().data()), frame->data().size()}},
                        jpeg_);
    problem_ = jpeg ? "" : "camera " + name_ + ": " + jpeg.error().message;
    if (jpeg) picture_ = std::move(*jpeg);
  }

  const std::string& problem() const { return problem_; }
  std::uint64_t sequence() const { return picture_.empty() ? 0 : sequence_; }
  std::string frame(std::uint32_t watch) const {
    std::string frame{picture_octet, 0, 0, 0};
    put_u32(frame, watch);
    put_u64(frame, static_cast<std::uint64_t>(time_.count()));
    return frame + picture_;
  }

 private:
  base::Result<shm::Iface> open_as(const std::string& type, const std::string& name) const {
    return shm::Iface::open(server_id_, type == "depth" ? shm::IfaceType::depth : shm::IfaceType::camera, name);
  }

  bool open() {
    if (Clock::now() < next_try_) return false;
    next_try_ = Clock::now() + return_period;
    const auto name = camera_name(name_);
    auto found = open_as(name.types.front(), name.iface);
    if (!found && name.types.size() > 1) {
      if (auto other = open_as(name.types.back(), name.iface)) found = std::move(other);
    }
    if (!found) return problem_ = found.error().message, false;
    if (const auto subscribed = found->subscribe(); !subscribed) return problem_ = subscribed.error().message, false;
    problem_.clear();
    sequence_ = 0;
    iface_ = std::move(*found);
    return true;
  }

  const std::uint32_t server_id_;
  const std::string name_;
  std::optional<shm::Iface> iface_;
  base::JpegEncoder jpeg_;
  std::uint64_t sequence_ = 0;
  std::chrono::nanoseconds time_{0};
  std::string picture_, problem_;
  Clock::time_point next_try_{};
};

Pictures::Pictures(std::uint32_t server_id, Tellers tell) : server_id_(server_id), tell_(std::move(tell)), thread_([this] { run(); }) {}

Pictures::~Pictures() {
  data_.lock()->is_ending = true;
  changed_.notify_all();
  thread_.join();
}

void Pictures::watch(const WatchKey& key, PictureOrder order) {
  data_.lock()->orders[key] = std::move(order);
  changed_.notify_all();
}

void Pictures::unwatch(const WatchKey& key) { data_.lock()->orders.erase(key); }

void Pictures::unwatch_all(std::uint64_t viewer) {
  auto data = data_.lock();
  std::erase_if(data->orders, [&](const auto& entry) { return entry.first.viewer == viewer; });
}

void Pictures::run() {
  for (auto next = Clock::now();; next = Clock::now() + look_period) {
    std::map<WatchKey, PictureOrder> orders;
    {
      auto data = data_.lock();
      data.wait(changed_, [&] { return data->is_ending || !data->orders.empty() || !cameras_.empty(); });
      data.wait_until(changed_, next, [&] { return data->is_ending; });
      if (data->is_ending) return;
      orders = data->orders;
    }
    show(orders);
  }
}

void Pictures::show(const std::map<WatchKey, PictureOrder>& orders) {
  std::erase_if(shown_, [&](const auto& entry) { return !orders.contains(entry.first); });
  std::erase_if(cameras_, [&](const auto& entry) {
    return std::none_of(orders.begin(), orders.end(), [&](const auto& order) { return order.second.iface == entry.first; });
  });
  for (const auto& [key, order] : orders) {
    auto& camera = cameras_[order.iface];
    if (!camera) camera = std::make_unique<Camera>(server_id_, order.iface);
  }
  for (auto& [name, camera] : cameras_) camera->look();
  for (const auto& [key, order] : orders) {
    const Camera& camera = *cameras_[order.iface];
    Shown& shown = shown_[key];
    if (camera.problem() != shown.problem) {
      shown.problem = camera.problem();
      if (!shown.problem.empty()) tell_.problem(key, to_text({{"op", "values"}, {"watch", key.watch}, {"error", shown.problem}}));
    }
    if (camera.sequence() == shown.sequence || Clock::now() < shown.next) continue;
    shown.sequence = camera.sequence();
    shown.next = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / order.hz));
    tell_.picture(key, camera.frame(key.watch));
  }
}

}  // namespace studio
