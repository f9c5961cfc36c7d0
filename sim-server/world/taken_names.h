// Names of things of one kind, which must differ. A value.
#pragma once

#include <map>
#include <set>
#include <string>

namespace sim {

class TakenNames {
 public:
  bool contains(const std::string& name) const { return names_.contains(name); }
  void insert(const std::string& name) { names_.insert(name); }
  // `name`, or the first of name_1, name_2, ... that is not taken.
  std::string free(const std::string& name);

 private:
  std::set<std::string> names_;
  std::map<std::string, int> next_;  // numbers below are taken: a thousand things of one name are numbered in no time
};

}  // namespace sim
