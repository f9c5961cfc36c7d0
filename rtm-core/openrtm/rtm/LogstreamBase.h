// Plug-ins that take log lines: registered with LogstreamFactory, switched on by a node logger.logstream.<type> in rtc.conf.
#pragma once

#include <coil/Factory.h>
#include <coil/Logger.h>
#include <coil/Properties.h>

#include <streambuf>

namespace RTC {

class LogstreamBase {
 public:
  virtual ~LogstreamBase() = default;
  // The node logger.logstream.<type>. False: the plug-in is not used.
  virtual bool init(const coil::Properties& properties) = 0;
  // Whole lines are written to it, by one thread at a time; a coil::LogStreamBuffer gets the parts of each record instead. nullptr if there
  // is none.
  virtual std::streambuf* getStreamBuffer() = 0;
  virtual bool shutdown() { return true; }
};

using LogstreamFactory = coil::GlobalFactory<LogstreamBase>;

}  // namespace RTC
