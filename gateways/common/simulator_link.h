// The connection of a gateway to its simulator. It is made when the simulator starts, and lost when the simulator exits. When models or
// ifaces are added or deleted, it lists them again. A gateway derives a class that reads the list. One thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/source.h"

namespace gateway {

class SimulatorLink {
 public:
  SimulatorLink(const SimulatorLink&) = delete;
  SimulatorLink& operator=(const SimulatorLink&) = delete;

  // Looks whether it is there and still the same; to be called some times a second.
  void look();
  bool is_there() const { return clock_ != nullptr; }
  // The simulation iface; nothing while there is no simulator.
  const std::shared_ptr<Source>& clock() const { return clock_; }
  // The iface, opened once; nothing, with a line in the log, if it cannot be opened.
  std::shared_ptr<Source> find(shm::IfaceType type, const std::string& name);
  // All that were found and are used.
  std::vector<std::shared_ptr<Source>> sources();
  // Counts the simulators that were met.
  std::uint64_t met() const { return met_; }

 protected:
  // `program`: a literal, for the log. `on_loss`: the simulator has ended.
  SimulatorLink(std::uint32_t server_id, const char* program, std::function<void()> on_loss);
  virtual ~SimulatorLink() = default;

  // A simulator was found. Its clock may have no sample yet.
  virtual void on_met() {}
  // The clock was read.
  virtual void on_sample() {}
  // Requests the list, and calls listed() with the answer, or with false to request it again at the next look.
  virtual void list() = 0;
  void listed(bool is_known);
  std::uint32_t server_id() const { return server_id_; }

 private:
  void lose();

  const std::uint32_t server_id_;
  const char* const program_;
  const std::function<void()> on_loss_;
  std::shared_ptr<Source> clock_;
  std::uint64_t met_ = 0;
  std::pair<std::uint32_t, std::uint32_t> listed_{};  // ifaces and models when it was listed last
  bool is_listing_ = false, has_list_ = false, lists_again_ = false;
  std::map<std::pair<shm::IfaceType, std::string>, std::weak_ptr<Source>> found_;
};

}  // namespace gateway
