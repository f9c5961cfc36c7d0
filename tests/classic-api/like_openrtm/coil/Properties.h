// What components use of OpenRTM-aist 2.x, declared with its names, its order of includes and nothing more. Our samples must compile against
// this (target samples_like_openrtm); nothing is linked.
#pragma once

#include <string>

namespace coil {

class Properties {
 public:
  Properties(const char* key = "", const char* value = "");
  Properties(const char* const* defaults, long count = 2147483647L);
  const std::string& getProperty(const std::string& key) const;
  std::string setProperty(const std::string& key, const std::string& value);
  std::string& operator[](const std::string& key);
};

}  // namespace coil
