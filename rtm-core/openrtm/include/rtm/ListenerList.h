// The listeners of one kind of event: kept with a note of who deletes them, called without a lock. Any thread; a removed listener that owns
// itself here is deleted when no call to it runs any more.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

namespace RTC {

template <class Listener>
class ListenerList {
 public:
  // With autoclean the list deletes the listener when it is removed; otherwise the caller keeps it alive until then.
  void addListener(Listener* listener, bool autoclean = true) {
    if (listener == nullptr) return;
    Entry entry = autoclean ? Entry(listener) : Entry(listener, [](Listener*) {});
    std::lock_guard lock(mutex_);
    auto changed = listeners_ ? std::make_shared<std::vector<Entry>>(*listeners_) : std::make_shared<std::vector<Entry>>();
    changed->push_back(std::move(entry));
    listeners_ = std::move(changed);
  }

  void removeListener(Listener* listener) {
    std::shared_ptr<const std::vector<Entry>> old;  // what is deleted is deleted after the lock
    std::lock_guard lock(mutex_);
    if (!listeners_) return;
    auto changed = std::make_shared<std::vector<Entry>>(*listeners_);
    changed->erase(std::remove_if(changed->begin(), changed->end(), [&](const Entry& entry) { return entry.get() == listener; }),
                   changed->end());
    old = std::move(listeners_);
    if (!changed->empty()) listeners_ = std::move(changed);
  }

  template <class... Args>
  void notify(Args&&... args) const {
    std::shared_ptr<const std::vector<Entry>> listeners;
    {
      std::lock_guard lock(mutex_);
      if (!listeners_) return;
      listeners = listeners_;
    }
    for (const Entry& entry : *listeners) (*entry)(args...);
  }

  bool empty() const {
    std::lock_guard lock(mutex_);
    return !listeners_;
  }
  std::size_t size() const {
    std::lock_guard lock(mutex_);
    return listeners_ ? listeners_->size() : 0;
  }

 private:
  using Entry = std::shared_ptr<Listener>;
  mutable std::mutex mutex_;
  std::shared_ptr<const std::vector<Entry>> listeners_;  // null when empty; replaced as a whole
};

}  // namespace RTC
