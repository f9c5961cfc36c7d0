// Base class of log plug-ins that receive records one by one: registered like any stream buffer, but instead of lines they get the parts.
#pragma once

#include <coil/config_coil.h>

#include <streambuf>
#include <string>

namespace coil {

class LogStreamBuffer : public std::streambuf {
 public:
  // One record: level is one of RTC::Logger::RTL_*, date is formatted as logger.date_format says. One thread at a time; what it logs itself
  // is not handed to it.
  virtual void write(int level, const std::string& name, const std::string& date, const std::string& message) {
    static_cast<void>(level), static_cast<void>(name), static_cast<void>(date), static_cast<void>(message);
  }
};

}  // namespace coil
