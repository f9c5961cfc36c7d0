// The manager's names on name servers. Any thread; each wait for a name server has a short timeout.
#pragma once

#include <rtm/CorbaNaming.h>
#include <rtm/ManagerServant.h>
#include <rtm/RTC.h>
#include <rtm/RTObject.h>
#include <rtm/SystemLogger.h>

#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/Task.h>
#include <coil/stringutil.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace RTM {
class ManagerServant;
}

namespace RTC {

class Manager;
class RTObject_impl;
class PortBase;

class NamingManager {
 public:
  explicit NamingManager(Manager* manager);
  ~NamingManager();
  NamingManager(const NamingManager&) = delete;
  NamingManager& operator=(const NamingManager&) = delete;

  // method: "corba"; name_server: host, host:port or a corbaloc URL. Or "manager": names are looked for at the manager there and its
  // slaves; nothing is bound on it.
  void registerNameServer(const char* method, const char* name_server);
  // Binds under `name` on every naming service, now or when it comes (back).
  void bindObject(const char* name, const RTObject_impl* rtobj);
  void bindObject(const char* name, const RTM::ManagerServant* servant);
  // The same, but a name that another living manager has is left to it until it is free.
  void bindUnlessTaken(const char* name, const RTM::ManagerServant* servant);
  void bindObject(const std::string& name, CORBA::Object_ptr object);
  void bindPortObject(const char* name, PortService_ptr port);
  void unbindObject(const char* name);
  void unbindAll();
  // Looks after all bindings soon; the timer does it anyway.
  void update();

  // The components that a name stands for: an instance name of this process, or of the managers that are registered,
  // `rtcname://host:port/path/instance`, `rtcname://*/instance`, `rtcloc://host:port/category/instance`.
  RTCList string_to_component(const std::string& name);
  // What is bound with that kind below a context, on all naming services that answer.
  std::vector<CORBA::Object_var> list(const std::string& context, const std::string& kind);
  // The components of the managers that are registered.
  RTCList componentsOfManagers();
  // The object bound under a full name on any of the naming services; nil if there is none that answers.
  CORBA::Object_ptr resolve(const std::string& name);
  // True if something alive that is not ours is bound under an entry of that instance name, under this host's name or anywhere.
  bool isInstanceTaken(const std::string& instance_name, bool this_host_only);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace RTC
