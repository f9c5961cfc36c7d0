#include "iface_link.h"

#include <base/waiting.h>

#include "simulated_time.h"

namespace iface {
namespace {

constexpr std::chrono::milliseconds retry_period{200};
constexpr std::chrono::milliseconds longest_wait{50};

}  // namespace

std::chrono::nanoseconds wait_limit() { return in_simulated_time() ? std::chrono::nanoseconds(0) : std::chrono::nanoseconds(longest_wait); }

IfaceLink::IfaceLink(shm::IfaceType type, Say say) : type_(type), say_(std::move(say)) {}

base::Result<void> IfaceLink::attach(const Device& device, bool subscribe) {
  detach();
  if (device.server_id < 0) return base::Error{"server_id must not be negative, got " + std::to_string(device.server_id)};
  auto iface = shm::Iface::open(static_cast<std::uint32_t>(device.server_id), type_, device.device_id);
  if (!iface) return iface.error();
  if (subscribe) {
    if (auto subscribed = iface->subscribe(); !subscribed) return subscribed;
  }
  iface_.emplace(std::move(*iface));
  device_ = device;
  subscribe_ = subscribe;
  lost_ = false;
  last_ = 0;
  ++attachments_;
  return {};
}

void IfaceLink::detach() {
  iface_.reset();
  lost_ = false;
}

void IfaceLink::lose(const std::string& why) {
  if (!lost_)
    say_(true, "iface " + device_.device_id + " of server " + std::to_string(device_.server_id) + " is lost: " + why + "; waiting for it");
  lost_ = true;
  next_try_ = Clock::now() + retry_period;
}

shm::Iface* IfaceLink::live() {
  if (!iface_) return nullptr;
  if (!lost_) {
    const auto status = iface_->status();
    if (status == shm::Status::live) return &*iface_;
    lose(status == shm::Status::dead ? "the simulator exited" : "the simulator has closed it");
  }
  // Simulated time goes on only when this returns: a wait by the clock on the wall could last for all of a run.
  if (!in_simulated_time() && Clock::now() < next_try_) return nullptr;
  next_try_ = Clock::now() + retry_period;
  if (!iface_->reopen()) return nullptr;
  last_ = 0;
  lost_ = false;
  ++attachments_;
  say_(false, "iface " + device_.device_id + " of server " + std::to_string(device_.server_id) + " is there again");
  return &*iface_;
}

bool IfaceLink::wait_for_newer(shm::Iface& iface, std::chrono::nanoseconds limit) {
  const auto what = [&] {
    const base::ScopedWait waiting;
    return iface.wait(last_, limit);
  }();
  if (what == shm::Wait::closed) lose("the simulator has exited");
  return what == shm::Wait::fresh;
}

shm::Iface* IfaceLink::fresh(std::chrono::nanoseconds limit) {
  auto* iface = live();
  if (!iface || !wait_for_newer(*iface, limit)) return nullptr;
  last_ = iface->sample<shm::Stamp>().sequence;
  return iface;
}

std::optional<shm::HeldFrame> IfaceLink::fresh_frame(std::chrono::nanoseconds limit) {
  auto* iface = live();
  if (!iface || !wait_for_newer(*iface, limit)) return std::nullopt;
  auto frame = iface->hold();
  if (frame) last_ = frame->sequence();
  return frame;
}

}  // namespace iface
