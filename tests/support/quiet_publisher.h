// A publisher for hooks that use what lies on the test's stack. Publisher leaves a thread that is in a hook to itself; this one is gone
// when that thread has ended. One thread, as Publisher.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>

#include "core/publisher.h"

namespace rt {

// Held by the hooks, which live as long as the thread.
class HooksAlive {
 protected:
  HooksAlive() = default;
  HooksAlive(const HooksAlive&) = delete;
  HooksAlive& operator=(const HooksAlive&) = delete;
  ~HooksAlive() {
    std::unique_lock lock(end_->mutex);
    EXPECT_TRUE(end_->come.wait_for(lock, std::chrono::seconds(60), [&] { return end_->has_come; })) << "the publisher's thread goes on";
  }

  Publisher::Hooks hold(Publisher::Hooks hooks) {
    auto token = std::shared_ptr<void>(nullptr, [end = end_](void*) {
      std::lock_guard lock(end->mutex);
      end->has_come = true;
      end->come.notify_all();
    });
    hooks.send = [send = std::move(hooks.send), token = std::move(token)](const Sample& sample) { return send(sample); };
    return hooks;
  }

 private:
  struct End {
    std::mutex mutex;
    std::condition_variable come;
    bool has_come = false;
  };
  std::shared_ptr<End> end_ = std::make_shared<End>();
};

class QuietPublisher : private HooksAlive, public Publisher {
 public:
  QuietPublisher(Subscription subscription, const PublisherSettings& publisher, const BufferSettings& buffer, Hooks hooks,
                 const SteadyTime& time = machine_time())
      : Publisher(subscription, publisher, buffer, hold(std::move(hooks)), time) {}
};

}  // namespace rt
