#include "studio/outbox.h"

#include <algorithm>
#include <utility>

namespace studio {

Frame text_frame(std::string text) { return {false, std::make_shared<const std::string>(std::move(text))}; }
Frame binary_frame(std::string octets) { return {true, std::make_shared<const std::string>(std::move(octets))}; }

void Outbox::put(Frame frame) {
  octets_ += frame.octets->size();
  entries_.push_back({"", std::move(frame)});
}

void Outbox::put_newest(const std::string& key, Frame frame) { replace(key, std::move(frame)); }
void Outbox::put_newest(const std::string& key, Maker maker) { replace(key, std::move(maker)); }

void Outbox::replace(const std::string& key, std::variant<Frame, Maker> what) {
  const auto waiting = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
  if (waiting != entries_.end()) {
    waiting->what = std::move(what);
  } else {
    entries_.push_back({key, std::move(what)});
  }
}

void Outbox::drop(const std::string& key) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
}

std::optional<Frame> Outbox::next() {
  while (!entries_.empty()) {
    Entry entry = std::move(entries_.front());
    entries_.pop_front();
    if (auto* frame = std::get_if<Frame>(&entry.what)) {
      if (entry.key.empty()) octets_ -= frame->octets->size();
      return std::move(*frame);
    }
    if (auto made = std::get<Maker>(entry.what)()) return made;
  }
  return std::nullopt;
}

}  // namespace studio
