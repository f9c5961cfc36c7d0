#include "outbox.h"

#include <algorithm>
#include <utility>

namespace gateway {
namespace {

constexpr int keep_all = 0, newest_replaces = 1, drop = 2;

bool fits(std::int32_t wanted, std::int32_t value) { return wanted == -1 || wanted == value; }

}  // namespace

void Outbox::append(SharedBytes bytes) {
  size_ += bytes->size();
  pieces_.push_back({std::move(bytes), 0});
}

void Outbox::respond(std::string message) { append(std::make_shared<const std::string>(std::move(message))); }

int Outbox::rule_for(const player::Address& device, std::uint8_t subtype) const {
  for (const auto& rule : rules_) {
    if (fits(rule.interface, static_cast<std::uint16_t>(device.interface)) && fits(rule.index, device.index) &&
        fits(rule.type, static_cast<std::uint8_t>(player::Type::data)) && fits(rule.subtype, subtype))
      return rule.replace;
  }
  return newest_replaces;
}

void Outbox::deliver(const player::Address& device, std::uint8_t subtype, SharedBytes message) {
  const int rule = rule_for(device, subtype);
  if (rule == drop) return;
  const auto is_same = [&](const Waiting& one) { return one.device == device && one.subtype == subtype; };
  const auto kept = static_cast<std::size_t>(std::count_if(waiting_.begin(), waiting_.end(), is_same));
  if (kept > 0 && (rule == newest_replaces || kept >= max_kept)) waiting_.erase(std::find_if(waiting_.begin(), waiting_.end(), is_same));
  waiting_.push_back({device, subtype, std::move(message)});
}

void Outbox::forget(const player::Address& device) {
  std::erase_if(waiting_, [&](const Waiting& one) { return one.device == device; });
}

void Outbox::set_mode(player::DataMode mode) {
  mode_ = mode;
  is_asked_ = false;
}

void Outbox::ask_for_data() { is_asked_ = mode_ == player::DataMode::pull; }

bool Outbox::add_rule(const player::ReplaceRule& rule) {
  if (rule.replace < keep_all || rule.replace > drop) return false;
  const auto same = std::find_if(rules_.begin(), rules_.end(), [&](const player::ReplaceRule& one) {
    return one.interface == rule.interface && one.index == rule.index && one.type == rule.type && one.subtype == rule.subtype;
  });
  if (same != rules_.end()) {
    same->replace = rule.replace;
    return true;
  }
  if (rules_.size() >= max_rules) return false;
  rules_.push_back(rule);
  return true;
}

void Outbox::flush(double time) {
  if (waiting_.empty()) return;
  if (mode_ == player::DataMode::push ? !pieces_.empty() : !is_asked_) return;
  for (Waiting& one : waiting_) append(std::move(one.message));
  waiting_.clear();
  if (mode_ == player::DataMode::push) return;
  is_asked_ = false;
  respond(player::encode({.address = {}, .type = player::Type::synch, .subtype = player::synch::ok, .timestamp = time, .size = 0}, robot_));
}

void Outbox::sent(std::size_t bytes) {
  size_ -= bytes;
  while (bytes > 0) {
    Piece& first = pieces_.front();
    const std::size_t part = std::min(bytes, first.bytes->size() - first.sent);
    first.sent += part;
    bytes -= part;
    if (first.sent == first.bytes->size()) pieces_.pop_front();
  }
}

}  // namespace gateway
