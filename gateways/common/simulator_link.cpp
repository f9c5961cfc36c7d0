#include "common/simulator_link.h"

#include <algorithm>

#include "base/log.h"

namespace gateway {

SimulatorLink::SimulatorLink(std::uint32_t server_id, const char* program, std::function<void()> on_loss)
    : server_id_(server_id), program_(program), on_loss_(std::move(on_loss)) {}

void SimulatorLink::look() {
  if (clock_ && clock_->iface().status() != shm::Status::live) lose();
  if (!clock_) {
    auto clock = Source::open(server_id_, shm::IfaceType::simulation, "world", met_ + 1);
    if (!clock) return;
    clock_ = std::move(*clock);
    ++met_;
    has_list_ = false;
    found_.clear();
    on_met();
  }
  auto present = listed_;
  if (clock_->iface().read()) {
    const auto& sample = clock_->iface().sample<shm::SimulationSample>();
    present = {sample.ifaces, sample.models};
    on_sample();
  }
  const auto used = sources();
  const bool is_one_closed = std::ranges::any_of(used, [](const auto& one) { return one->is_closed(); });
  if (is_listing_ || (has_list_ && !lists_again_ && present == listed_ && !is_one_closed)) return;
  listed_ = present;  // what comes after the list was asked for is seen at the next look
  // An iface closes before the sample counts one less: another model in its place would leave the counts as they were.
  lists_again_ = is_one_closed;
  is_listing_ = has_list_ = true;
  list();
}

void SimulatorLink::listed(bool is_known) {
  is_listing_ = false;
  has_list_ = is_known;
}

void SimulatorLink::lose() {
  base::log(base::Level::warn, program_, "simulator {} has ended; waiting for it", server_id_);
  clock_.reset();
  found_.clear();
  on_loss_();
}

std::shared_ptr<Source> SimulatorLink::find(shm::IfaceType type, const std::string& name) {
  if (!clock_ || type == shm::IfaceType::simulation) return clock_;
  auto& known = found_[{type, name}];
  if (auto source = known.lock(); source && !source->is_closed()) return source;
  auto source = Source::open(server_id_, type, name, met_);
  if (!source) {
    base::log(base::Level::warn, program_, "{}", source.error().message);
    return nullptr;
  }
  known = *source;
  return *source;
}

std::vector<std::shared_ptr<Source>> SimulatorLink::sources() {
  std::vector<std::shared_ptr<Source>> used;
  std::erase_if(found_, [&](const auto& entry) {
    auto source = entry.second.lock();
    if (source) used.push_back(std::move(source));
    return entry.second.expired();
  });
  return used;
}

}  // namespace gateway
