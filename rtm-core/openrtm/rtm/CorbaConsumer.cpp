#include "rtm/CorbaConsumer.h"

#include "corba/orb/call_timeout.h"
#include "corba/orb/principal.h"
#include "corba/transport/transport.h"

namespace RTC {
namespace {

constexpr std::size_t max_retired = 16;

}  // namespace

CorbaConsumerBase& CorbaConsumerBase::operator=(const CorbaConsumerBase& other) {
  if (this != &other) store(other.load());
  return *this;
}

CORBA::Object_ptr CorbaConsumerBase::with_timeout(CORBA::Object_ptr object) {
  if (CORBA::is_nil(object)) return CORBA::Object::_nil();
  // A reference of its own, so that the time-out touches nobody else's calls.
  const CORBA::ORB_var orb = corba::orb();
  const CORBA::String_var text = orb->object_to_string(object);
  CORBA::Object_var own = orb->string_to_object(text);
  corba::limit_calls(own, corba::port_call_timeout());
  return own._retn();
}

bool CorbaConsumerBase::setObject(CORBA::Object_ptr object) {
  const CORBA::Object_var own = with_timeout(object);
  if (CORBA::is_nil(own) || !corba::may_keep(own)) return false;
  store(own);
  return true;
}

CORBA::Object_ptr CorbaConsumerBase::getObject() {
  std::lock_guard lock(mutex_);
  return object_.in();
}

void CorbaConsumerBase::releaseObject() { store(CORBA::Object::_nil()); }

void CorbaConsumerBase::store(CORBA::Object_ptr object) {
  corba::limit_calls(object, corba::port_call_timeout());  // a narrowed reference does not inherit it
  CORBA::Object_var dropped;
  std::lock_guard lock(mutex_);
  if (!CORBA::is_nil(object_)) retired_.push_back(object_);
  object_ = CORBA::Object::_duplicate(object);
  if (retired_.size() > max_retired) {
    dropped = retired_.front();
    retired_.pop_front();
  }
}

CORBA::Object_var CorbaConsumerBase::load() const {
  std::lock_guard lock(mutex_);
  return object_;
}

}  // namespace RTC
