#include "sim_tick.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
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

void SimTick::begin(const shm::Tick& tick) { tick_ = tick; }

void SimTick::end(const std::function<std::uint64_t()>& states) {
  // What they add is for the next end.
  auto work = std::exchange(at_end_, {});
  for (auto& each : work) each(*this);
  if (log_) write_log(states());
}

SimTick::Leaf& SimTick::leaf_of(const base::Passage& passage) {
  using Kind = base::HashKey::Kind;
  Leaves& leaves = passage.is_out ? written_ : read_;
  auto leaf = leaves.find(passage.port);
  if (leaf == leaves.end()) {
    leaf = leaves.emplace(std::string(passage.port), Leaf{}).first;
    leaf->second.key =
        log_->key({passage.is_out ? Kind::out_port : Kind::in_port, phase_, port_name(passage.port), std::string(passage.type)});
  }
  return leaf->second;
}

void SimTick::passed(const base::Passage& passage) {
  Leaf& seen = leaf_of(passage);
  std::size_t size = 0;
  for (const auto& part : passage.octets) size += part.size();
  seen.hash.add(std::uint64_t{size});
  seen.value.clear();
  for (const auto& part : passage.octets) {
    seen.hash.add(part);
    if (size <= base::longest_hash_value) seen.value.append(reinterpret_cast<const char*>(part.data()), part.size());
  }
  const bool is_first = ++seen.samples == 1;
  if (is_first && passage.hash != nullptr && size > base::longest_hash_value)
    *passage.hash = std::make_shared<const base::Hash64>(seen.hash);
}

// A hash of several samples goes through the octets of each; nearly always there is one.
bool SimTick::passed_again(const base::Passage& passage, const base::Hash64& hash) {
  Leaf& seen = leaf_of(passage);
  if (seen.samples != 0) return false;
  seen.hash = hash;
  seen.value.clear();
  ++seen.samples;
  return true;
}

void SimTick::write(Leaves& leaves) {
  for (auto& [port, leaf] : leaves) {
    if (leaf.samples == 0) continue;
    log_->add(leaf.key, leaf.hash.value(), std::as_bytes(std::span(leaf.value)));
    leaf.hash = {};
    leaf.samples = 0;
  }
}

void SimTick::write_log(std::uint64_t states) {
  log_->begin_tick(tick_.resets, tick_.now);
  if (states_ != states) {
    states_ = states;
    log_->add(component_, states);
  }
  write(read_);
  write(written_);
  log_->end_tick();
}
