// Factories of components: what registerFactory takes and keeps. One thread at a time (the manager holds them behind its lock).
#pragma once

#include <coil/Properties.h>

#include <functional>
#include <string>

namespace RTC {

class Manager;
class RTObject_impl;

using RtcNewFunc = RTObject_impl* (*)(Manager* manager);
using RtcDeleteFunc = void (*)(RTObject_impl* rtc);

// Gives back the creator's reference of a component; it is deleted when the last call in progress has left it.
void releaseComponent(RTObject_impl* rtc);

template <class Component>
RTObject_impl* Create(Manager* manager) {
  return new Component(manager);
}

template <class Component>
void Delete(RTObject_impl* rtc) {
  releaseComponent(rtc);
}

class FactoryBase {
 public:
  explicit FactoryBase(const coil::Properties& profile) : profile_(profile) {}
  virtual ~FactoryBase() = default;
  FactoryBase(const FactoryBase&) = delete;
  FactoryBase& operator=(const FactoryBase&) = delete;

  // nullptr when the author's function fails or throws.
  virtual RTObject_impl* create(Manager* manager) = 0;
  virtual void destroy(RTObject_impl* component) = 0;

  const coil::Properties& profile() const { return profile_; }

 protected:
  coil::Properties profile_;
};

class FactoryCXX final : public FactoryBase {
 public:
  FactoryCXX(const coil::Properties& profile, RtcNewFunc create, RtcDeleteFunc destroy)
      : FactoryBase(profile), create_(create), destroy_(destroy) {}
  RTObject_impl* create(Manager* manager) override;
  void destroy(RTObject_impl* component) override;

 private:
  RtcNewFunc create_;
  RtcDeleteFunc destroy_;
};

}  // namespace RTC
