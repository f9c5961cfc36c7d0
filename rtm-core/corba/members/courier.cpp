#include "corba/members/courier.h"

#include <omniORB4/CORBA.h>

#include <algorithm>

#include "base/log.h"
#include "corba/orb/orb.h"

namespace corba {

Courier::Courier(std::string name) : name_(std::move(name)), thread_([this] { run(); }) {}

Courier::~Courier() {
  stop();
  if (thread_.joinable()) thread_.join();
}

void Courier::send(Message message) {
  {
    auto data = shared_.lock();
    if (data->stopping || data->is_finishing || data->gave_up || data->waiting.size() >= max_waiting) return;
    data->waiting.push_back(std::move(message));
  }
  condition_.notify_one();
}

void Courier::repeat(std::vector<Regular> regulars) {
  const Time now = std::chrono::steady_clock::now();
  {
    auto data = shared_.lock();
    data->rescheduled = true;
    data->regulars.clear();
    for (Regular& regular : regulars) data->regulars.push_back({regular, now + regular.interval});
  }
  condition_.notify_one();
}

void Courier::finish(std::chrono::nanoseconds timeout) {
  {
    auto data = shared_.lock();
    data->is_finishing = true;
    data->regulars.clear();
    data.wait_for(finished_, timeout, [&] { return data->stopping || data->gave_up || (data->waiting.empty() && !data->is_carrying); });
  }
  stop();
}

void Courier::stop() {
  std::deque<Message> dropped;  // destroyed without the lock
  {
    auto data = shared_.lock();
    data->stopping = true;
    dropped.swap(data->waiting);
  }
  condition_.notify_one();
  finished_.notify_all();
}

void Courier::run() {
  while (true) {
    Message message;
    {
      auto data = shared_.lock();
      data->is_carrying = false;
      if (data->is_finishing && data->waiting.empty()) finished_.notify_all();
      while (!message) {
        if (data->stopping || data->gave_up) return;
        if (!data->waiting.empty()) {
          message = std::move(data->waiting.front());
          data->waiting.pop_front();
          break;
        }
        const Time now = std::chrono::steady_clock::now();
        data->rescheduled = false;
        Time wake = now + std::chrono::hours(24);
        for (Due& due : data->regulars) {
          if (due.next <= now) {
            due.next = now + due.regular.interval;
            message = due.regular.message;
            break;
          }
          wake = std::min(wake, due.next);
        }
        if (!message) data.wait_until(condition_, wake, [&] { return data->stopping || data->rescheduled || !data->waiting.empty(); });
      }
      data->is_carrying = true;
    }
    if (!carry(message)) return;
  }
}

bool Courier::carry(const Message& message) {
  std::string reason;
  try {
    message();
    return true;
  } catch (const CORBA::Exception& exception) {
    reason = to_text(exception);
  } catch (...) {
    reason = "unknown exception";
  }
  std::deque<Message> dropped;
  {
    auto data = shared_.lock();
    data->gave_up = true;
    dropped.swap(data->waiting);
  }
  finished_.notify_all();
  base::log(base::Level::warn, name_, "the peer does not respond; notifications to it stop: {}", reason);
  return false;
}

}  // namespace corba
