#include "rtm/CdrBufferBase.h"

#include <utility>

#include "component/runtime_access.h"
#include "corba/ports/data_port.h"

namespace RTC {

std::shared_ptr<corba::Waiting> RuntimeAccess::waiting(const CdrBufferBase& buffer) {
  std::lock_guard lock(buffer.mutex_);
  return std::static_pointer_cast<corba::Waiting>(buffer.waiting_.lock());
}

void RuntimeAccess::show(CdrBufferBase& buffer, const std::weak_ptr<corba::Waiting>& waiting, std::size_t length) {
  std::lock_guard lock(buffer.mutex_);
  buffer.waiting_ = waiting;
  buffer.length_ = length;
}

std::size_t CdrBufferBase::length() const {
  std::lock_guard lock(mutex_);
  return length_;
}

std::size_t CdrBufferBase::readable() const {
  const auto all = RuntimeAccess::waiting(*this);
  return all ? all->unread() : 0;
}

std::size_t CdrBufferBase::writable() const {
  const std::size_t used = readable();
  const std::size_t all = length();
  return used < all ? all - used : 0;
}

void CdrBufferBase::reset() {
  if (const auto all = RuntimeAccess::waiting(*this)) all->drop_unread();
}

}  // namespace RTC
