// The simulator that the gateway shows: found when it starts, lost when it ends, listed again when a model or an iface was added or
// removed. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/errands.h"
#include "common/source.h"
#include "mapping.h"
#include "real_time.h"

namespace gateway {

// Since it was published.
std::chrono::nanoseconds age_of(const shm::Stamp& stamp);

class Simulator {
 public:
  // `on_list` is called with what there is each time that is known anew, `on_loss` when the simulator has ended.
  Simulator(std::uint32_t server_id, Errands& errands, RealTime& real_time, std::function<void(const std::vector<ListedIface>&)> on_list,
            std::function<void()> on_loss);

  // Looks whether it is there and still the same; to be called some times a second.
  void look();
  // The iface, opened once; nothing when it is not there.
  std::shared_ptr<Source> find(shm::IfaceType type, const std::string& name);
  // All that were found and are used.
  std::vector<std::shared_ptr<Source>> sources();
  // Counts the simulators that were met.
  std::uint64_t met() const { return met_; }
  bool is_there() const { return world_ != nullptr; }

 private:
  void lose();
  void list();

  const std::uint32_t server_id_;
  Errands& errands_;
  RealTime& real_time_;
  const std::function<void(const std::vector<ListedIface>&)> on_list_;
  const std::function<void()> on_loss_;
  std::shared_ptr<Source> world_;  // the simulation iface
  std::uint64_t met_ = 0;
  std::pair<std::uint32_t, std::uint32_t> listed_{};  // ifaces and models when it was listed last
  bool is_listing_ = false, has_list_ = false;
  std::map<std::pair<shm::IfaceType, std::string>, std::weak_ptr<Source>> found_;
};

}  // namespace gateway
