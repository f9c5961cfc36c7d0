// The numbering policies that come with the library: process_unique, node_unique, ns_unique.
#pragma once

#include <rtm/NumberingPolicyBase.h>

#include <map>
#include <string>

namespace RTM {

// The lowest number that no component of the same type name has in this process.
class ProcessUniquePolicy : public NumberingPolicyBase {
 public:
  std::string onCreate(void* object) override;
  void onDelete(void* object) override;

 protected:
  // Whether somebody outside this process has the instance name already.
  virtual bool is_taken(const std::string& instance_name, void* object);

 private:
  std::map<void*, std::string> names_;
};

// Also free in every other process of this host that registers with the same naming services under this host's name.
class NodeNumberingPolicy : public ProcessUniquePolicy {
 protected:
  bool is_taken(const std::string& instance_name, void* object) override;
};

// Also free everywhere on the naming services.
class NamingServiceNumberingPolicy : public ProcessUniquePolicy {
 protected:
  bool is_taken(const std::string& instance_name, void* object) override;
};

}  // namespace RTM
