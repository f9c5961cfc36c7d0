// Data that readers have written into RFID tags since the last reset, by the scoped name of the tag (MODEL::SENSOR). They count in place of
// those of the world's file. Written between two steps by the stepping thread only; read by any thread.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "physics/hash.h"

namespace sim {

class TagData {
 public:
  const std::string& of(const std::string& tag, const std::string& otherwise) const {
    const auto found = data_.find(tag);
    return found == data_.end() ? otherwise : found->second;
  }
  void write(const std::string& tag, const std::string& data) { data_[tag] = data; }
  void forget_model(const std::string& model) {
    std::erase_if(data_, [&](const auto& entry) { return entry.first.starts_with(model + "::"); });
  }
  void reset() { data_.clear(); }
  void add_to(StateHash& hash) const {
    for (const auto& [tag, data] : data_) {
      hash.add(tag);
      hash.add(data);
    }
  }

 private:
  std::map<std::string, std::string> data_;
};

}  // namespace sim
