// A running tick of simulated time: the samples to send at its end, and the hashes of the data that pass. The context's thread
// only.
//
// The hash log of a context (base/hash_log.h) has the data that its components read and wrote in each tick, port by port, and the states of
// its components when they change.
#pragma once

#include <base/hash_log.h>
#include <base/tick.h>
#include <shm/lockstep.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

class SimTick final : public base::Tick {
 public:
  SimTick() = default;
  ~SimTick() override;
  SimTick(const SimTick&) = delete;
  SimTick& operator=(const SimTick&) = delete;

  // From now on into a new file of this folder; a problem is the answer. Once.
  std::string keep_hashes(const std::string& folder, const std::string& component, std::uint32_t phase);

  void begin(const shm::Tick& tick);
  // After the callbacks. `states`: a hash of those of the context's components, kept when it has changed.
  void end(const std::function<std::uint64_t()>& states);

  std::chrono::nanoseconds time() const override { return tick_.now; }
  std::uint64_t phase_counter() const override { return tick_.phase_counter; }
  void at_end(std::function<void(Tick&)> work) override { at_end_.push_back(std::move(work)); }
  bool keeps_data() const override { return log_.has_value(); }
  void passed(const base::Passage& passage) override;
  bool passed_again(const base::Passage& passage, std::uint64_t hash) override;

 private:
  // A port. What each tick looks at is one line of a cache, and its values follow.
  struct alignas(64) Leaf {
    std::string port;
    bool is_out = false;
    std::uint32_t key = 0;
    std::uint32_t samples = 0;     // in this tick
    std::uint32_t value_size = 0;  // 0: the last one was too long, or came as a hash
    std::uint64_t hash = 0;        // of this tick's samples
    std::array<std::byte, base::longest_hash_value> value{};
  };

  Leaf& leaf_of(const base::Passage& passage);
  void add(Leaf& leaf, std::uint64_t hash);
  void write_log(std::uint64_t states);

  shm::Tick tick_;
  std::vector<std::function<void(Tick&)>> at_end_;
  std::optional<base::HashLogWriter> log_;
  std::uint32_t phase_ = 0, component_ = 0;
  std::optional<std::uint64_t> states_;
  std::vector<Leaf> leaves_;                                                 // in the order in which data passed for the first time
  std::map<std::pair<bool, std::string>, std::size_t, std::less<>> places_;  // in leaves_, by is_out and port
  std::size_t expected_ = 0;                                                 // who comes next, when all is as in the tick before
};
