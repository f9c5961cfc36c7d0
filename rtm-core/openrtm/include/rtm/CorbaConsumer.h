// The place where a component calls a service of another one: empty until a connection brings the reference. Any thread.
#pragma once

#include <deque>
#include <mutex>

#include "rtm/idl/RTCStub.h"

namespace RTC {

class CorbaConsumerBase {
 public:
  CorbaConsumerBase() = default;
  CorbaConsumerBase(const CorbaConsumerBase& other) : object_(CORBA::Object::_duplicate(other.load())) {}
  CorbaConsumerBase& operator=(const CorbaConsumerBase& other);
  virtual ~CorbaConsumerBase() = default;

  // Takes the reference over, with the call time-out of ports. False for nil and, in CorbaConsumer, for objects of another interface;
  // nothing changes then.
  virtual bool setObject(CORBA::Object_ptr object);
  // Borrowed: good until the consumer dies or has been bound anew 16 times.
  virtual CORBA::Object_ptr getObject();
  virtual void releaseObject();

 protected:
  // A reference of its own to the same object, whose calls end after the call time-out of ports; nil for nil.
  static CORBA::Object_ptr with_timeout(CORBA::Object_ptr object);
  void store(CORBA::Object_ptr object);
  CORBA::Object_var load() const;

 private:
  mutable std::mutex mutex_;
  CORBA::Object_var object_;
  std::deque<CORBA::Object_var> retired_;  // lent by getObject or _ptr, perhaps still in use
};

template <class ObjectType, typename ObjectTypePtr = typename ObjectType::_ptr_type,
          typename ObjectTypeVar = typename ObjectType::_var_type>
class CorbaConsumer : public CorbaConsumerBase {
 public:
  // Keeps the reference alive for one expression, whoever rebinds the consumer meanwhile.
  class Held {
   public:
    explicit Held(ObjectTypePtr object) : object_(object) {}
    ObjectTypePtr operator->() const { return object_.in(); }
    // Good to the end of the expression: CORBA::is_nil(consumer.operator->()).
    operator ObjectTypePtr() const { return object_.in(); }

   private:
    ObjectTypeVar object_;
  };

  bool setObject(CORBA::Object_ptr object) override {
    const CORBA::Object_var timed = with_timeout(object);
    try {
      ObjectTypeVar narrowed = ObjectType::_narrow(timed);
      if (CORBA::is_nil(narrowed)) return false;
      store(narrowed);
      return true;
    } catch (const CORBA::OBJECT_NOT_EXIST&) {  // a provider that is not active yet cannot say what it is
      const ObjectTypeVar narrowed = ObjectType::_unchecked_narrow(timed);
      store(narrowed);
      return true;
    } catch (const CORBA::Exception&) {
      return false;
    }
  }

  // Borrowed like getObject(); nil while unbound.
  ObjectTypePtr _ptr() {
    CORBA::Object_ptr object = getObject();
    if (CORBA::is_nil(object)) return ObjectType::_nil();
    return static_cast<ObjectTypePtr>(object->_PR_getobj()->_ptrToObjRef(ObjectType::_PD_repoId));
  }
  ObjectTypePtr operator*() { return _ptr(); }
  // While unbound a call ends in CORBA::INV_OBJREF.
  Held operator->() { return Held(ObjectType::_unchecked_narrow(load())); }
};

}  // namespace RTC
