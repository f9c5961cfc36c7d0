#include "simulator.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "base/log.h"
#include "shm/process.h"

namespace gateway {
namespace {

// Of the process that serves it.
std::chrono::nanoseconds age_of(const shm::Iface& iface) {
  const std::uint64_t ticks = iface.segment().header().server.start_time;
  timespec now{};
  if (ticks == 0 || ::clock_gettime(CLOCK_BOOTTIME, &now) != 0) return {};
  const double age = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
                     static_cast<double>(ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(age));
}

}  // namespace

std::chrono::nanoseconds age_of(const shm::Stamp& stamp) { return std::chrono::nanoseconds(shm::wall_ns() - stamp.wall_time_ns); }

Simulator::Simulator(std::uint32_t server_id, Errands& errands, RealTime& real_time,
                     std::function<void(const std::vector<ListedIface>&)> on_list, std::function<void()> on_loss)
    : server_id_(server_id), errands_(errands), real_time_(real_time), on_list_(std::move(on_list)), on_loss_(std::move(on_loss)) {}

void Simulator::look() {
  if (world_ && world_->iface().status() != shm::Status::live) lose();
  if (!world_) {
    auto world = Source::open(server_id_, shm::IfaceType::simulation, "world", met_ + 1);
    if (!world) return;
    world_ = std::move(*world);
    ++met_;
    has_list_ = false;
    found_.clear();
    if (world_->iface().read()) {
      const auto& sample = world_->iface().sample<shm::SimulationSample>();
      real_time_.begin(std::chrono::steady_clock::now(), age_of(world_->iface()), sample.paused != 0, sample.steps > 0);
    }
  }
  std::pair<std::uint32_t, std::uint32_t> present = listed_;
  if (world_->iface().read()) {
    const auto& sample = world_->iface().sample<shm::SimulationSample>();
    present = {sample.ifaces, sample.models};
    real_time_.see(std::chrono::steady_clock::now(), sample.paused != 0, age_of(sample.stamp));
  }
  const auto used = sources();
  const bool is_one_gone = std::any_of(used.begin(), used.end(), [](const auto& one) { return one->is_closed(); });
  if (is_listing_ || (has_list_ && present == listed_ && !is_one_gone)) return;
  listed_ = present;  // what comes after the list was asked for is seen at the next look
  list();
}

void Simulator::lose() {
  base::log(base::Level::warn, "player-gateway", "simulator {} has ended; waiting for it", server_id_);
  world_.reset();
  found_.clear();
  on_loss_();
}

void Simulator::list() {
  is_listing_ = true;
  has_list_ = true;
  errands_.post(shm::ListRequest{}, [this, met = met_](const base::Result<shm::Reply>& reply) {
    is_listing_ = false;
    auto ifaces = reply ? parse_list(reply->text) : base::Result<std::vector<ListedIface>>(reply.error());
    if (ifaces && met == met_ && world_) return on_list_(*ifaces);
    has_list_ = false;  // asked again at the next look
  });
}

std::shared_ptr<Source> Simulator::find(shm::IfaceType type, const std::string& name) {
  if (!world_) return nullptr;
  if (type == shm::IfaceType::simulation) return world_;
  auto& known = found_[{type, name}];
  if (auto source = known.lock(); source && !source->is_closed()) return source;
  auto source = Source::open(server_id_, type, name, met_);
  if (!source) {
    base::log(base::Level::warn, "player-gateway", "{}", source.error().message);
    return nullptr;
  }
  known = *source;
  return *source;
}

std::vector<std::shared_ptr<Source>> Simulator::sources() {
  std::vector<std::shared_ptr<Source>> used;
  std::erase_if(found_, [&](const auto& entry) {
    auto source = entry.second.lock();
    if (source) used.push_back(std::move(source));
    return entry.second.expired();
  });
  return used;
}

}  // namespace gateway
