#include "sim_tick.h"

#include <base/hash64.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

namespace {

// "RTCLaser0.range" as people write it: "RTCLaser0:range".
std::string port_name(std::string_view name) {
  std::string text(name);
  if (const auto dot = text.rfind('.'); dot != std::string::npos) text[dot] = ':';
  return text;
}

}  // namespace

SimTick::~SimTick() {
  if (log_) log_->finish();  // a full disk is told by who reads it
}

std::string SimTick::keep_hashes(const std::string& folder, const std::string& component, std::uint32_t phase) {
  static std::atomic<unsigned> count{0};
  std::string file = component;
  std::ranges::replace(file, '/', '_');
  auto log = base::HashLogWriter::create(folder + "/" + file + "-" + std::to_string(getpid()) + "-" + std::to_string(++count) + ".hashlog");
  if (!log) return log.error().message;
  log_.emplace(std::move(*log));
  phase_ = phase;
  component_ = log_->key({base::HashKey::Kind::component, phase, component, ""});
  return "";
}

// Between two ticks others have filled the caches. What this one will need is asked for now, all at once, instead of waited for one after
// the other.
void SimTick::begin(const shm::Tick& tick) {
  constexpr std::size_t most = 4;
  tick_ = tick;
  if (!log_) return;
  for (std::size_t i = 0; i < std::min(most, leaves_.size()); ++i) {
    __builtin_prefetch(&leaves_[i], 1);
    __builtin_prefetch(leaves_[i].value.data(), 1);
  }
  log_->expect();
}

void SimTick::end(const std::function<std::uint64_t()>& states) {
  // What they add is for the next end.
  auto work = std::exchange(at_end_, {});
  for (auto& each : work) each(*this);
  if (log_) write_log(states());
}

// Ports come in the order in which they came in the tick before, nearly always.
SimTick::Leaf& SimTick::leaf_of(const base::Passage& passage) {
  using Kind = base::HashKey::Kind;
  if (expected_ < leaves_.size()) {
    Leaf& leaf = leaves_[expected_];
    if (leaf.is_out == passage.is_out && leaf.port == passage.port) {
      if (++expected_ < leaves_.size()) __builtin_prefetch(leaves_[expected_].port.data());
      return leaf;
    }
  }
  const std::pair name(passage.is_out, std::string(passage.port));
  auto place = places_.find(name);
  if (place == places_.end()) {
    const std::uint32_t key =
        log_->key({passage.is_out ? Kind::out_port : Kind::in_port, phase_, port_name(passage.port), std::string(passage.type)});
    leaves_.push_back({.port = name.second, .is_out = name.first, .key = key});
    place = places_.emplace(name, leaves_.size() - 1).first;
  }
  expected_ = place->second + 1;
  return leaves_[place->second];
}

void SimTick::passed(const base::Passage& passage) {
  std::size_t size = 0;
  for (const auto& part : passage.octets) size += part.size();
  base::Hash64 hash;
  hash.add(std::uint64_t{size});
  for (const auto& part : passage.octets) hash.add(part);
  const std::uint64_t value = hash.value();
  const bool is_short = size <= base::longest_hash_value;
  if (passage.hash != nullptr && !is_short) *passage.hash = value;  // what is short stands in the log itself
  Leaf& seen = leaf_of(passage);
  add(seen, value);
  if (!is_short) return;
  for (const auto& part : passage.octets) {
    if (!part.empty()) std::memcpy(seen.value.data() + seen.value_size, part.data(), part.size());
    seen.value_size += static_cast<std::uint32_t>(part.size());
  }
}

bool SimTick::passed_again(const base::Passage& passage, std::uint64_t hash) {
  add(leaf_of(passage), hash);
  return true;
}

// The hash of a single sample is that of the tick; those of further ones are chained to it.
void SimTick::add(Leaf& leaf, std::uint64_t hash) {
  leaf.value_size = 0;
  leaf.hash = leaf.samples++ == 0 ? hash : base::chained(leaf.hash, hash);
}

void SimTick::write_log(std::uint64_t states) {
  expected_ = 0;
  log_->begin_tick(tick_.resets, tick_.now);
  if (states_ != states) {
    states_ = states;
    log_->add(component_, states);
  }
  for (Leaf& leaf : leaves_) {
    if (leaf.samples == 0) continue;
    log_->add(leaf.key, leaf.hash, std::span(leaf.value).first(leaf.value_size));
    leaf.samples = 0;
  }
  log_->end_tick();
}
