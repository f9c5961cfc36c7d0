// See coil/Properties.h.
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>

#include <chrono>
#include <string>
#include <thread>

#define DLL_EXPORT

namespace RTC {

class Manager;
class RTObject_impl;
using RtcBase = RTObject_impl;
using RtcNewFunc = RtcBase* (*)(Manager*);
using RtcDeleteFunc = void (*)(RtcBase*);

class Manager {
 public:
  static Manager* init(int argc, char** argv);
  static Manager& instance();
  bool registerFactory(coil::Properties& profile, RtcNewFunc create, RtcDeleteFunc destroy);
  RtcBase* createComponent(const char* argument);
};

template <class Component>
RtcBase* Create(Manager* manager) {
  return new Component(manager);
}
template <class Component>
void Delete(RtcBase* component) {
  delete component;
}

}  // namespace RTC
