#include "rtm/CdrBufferBase.h"

#include <utility>

#include "corba/ports/data_port.h"

namespace RTC {

std::shared_ptr<corba::Waiting> CdrBufferBase::waiting() const {
  std::lock_guard lock(mutex_);
  return waiting_.lock();
}

void CdrBufferBase::show(std::weak_ptr<corba::Waiting> waiting, std::size_t length) {
  std::lock_guard lock(mutex_);
  waiting_ = std::move(waiting);
  length_ = length;
}

std::size_t CdrBufferBase::length() const {
  std::lock_guard lock(mutex_);
  return length_;
}

std::size_t CdrBufferBase::readable() const {
  const auto all = waiting();
  return all ? all->unread() : 0;
}

std::size_t CdrBufferBase::writable() const {
  const std::size_t used = readable();
  const std::size_t all = length();
  return used < all ? all - used : 0;
}

void CdrBufferBase::reset() {
  if (const auto all = waiting()) all->drop_unread();
}

}  // namespace RTC
