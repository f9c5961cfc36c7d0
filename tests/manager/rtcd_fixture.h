// rtcd in tests: a naming service, an ORB to look at it with, and what every rtcd is started with. Only the loopback interface is used.
#pragma once

#include <gtest/gtest.h>
#include <rtm/RTC.h>
#include <rtm/idl/ManagerStub.h>

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "corba/orb/naming.h"
#include "corba/orb/orb.h"
#include "support/naming_service.h"
#include "support/paths.h"

namespace manager_test {

inline bool eventually(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + support::watchdog;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

inline const std::string program = std::string(paths::bin_dir) + "/rtcd";
inline const std::string modules = std::string(paths::bin_dir) + "/../lib";

// A naming service, an ORB to look at it with, and what every rtcd here is started with.
class Rtcd : public testing::Test {
 protected:
  Rtcd() : orb_(corba::Orb::start({.call_timeout = std::chrono::seconds(20)}).value()) {}

  std::vector<std::string> command(const std::vector<std::string>& further) const {
    std::vector<std::string> words{program, "-i", "-f", "none.conf"};
    for (const auto& setting :
         {"corba.nameservers:" + names_.address(), std::string("naming.formats:%n.rtc"), "manager.modules.load_path:" + modules,
          std::string("manager.naming_formats:%n.mgr"), std::string("naming.update.interval:0.1")}) {
      words.insert(words.end(), {"-o", setting});
    }
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }

  std::set<std::string> entries() const {
    std::set<std::string> result;
    auto root = corba::root_context(orb_->orb(), names_.address(), std::chrono::seconds(5));
    if (!root) return result;
    try {
      for (const auto& name : corba::find_names(root->in(), [](const auto&) { return true; })) result.insert(corba::to_text(name));
    } catch (const CORBA::Exception&) {
      result.clear();
    }
    return result;
  }
  bool has(const std::string& name) const { return entries().contains(name); }

  RTC::RTObject_var component(const std::string& name) const {
    auto root = corba::root_context(orb_->orb(), names_.address(), std::chrono::seconds(5));
    try {
      CORBA::Object_var object = (*root)->resolve(*corba::parse_name(name));
      return RTC::RTObject::_narrow(object);
    } catch (const CORBA::Exception&) {
      return RTC::RTObject::_nil();
    }
  }

  // By its object key; waits until it answers.
  RTM::Manager_var manager_at(int port) const {
    CORBA::Object_var object = orb_->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/manager").c_str());
    RTM::Manager_var manager;
    eventually([&] {
      try {
        manager = RTM::Manager::_narrow(object);
        return !CORBA::is_nil(manager);
      } catch (const CORBA::Exception&) {
        return false;
      }
    });
    return manager;
  }

  support::NamingService names_;
  std::unique_ptr<corba::Orb> orb_;
};

}  // namespace manager_test
