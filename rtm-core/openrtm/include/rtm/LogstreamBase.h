// Plug-ins that take log lines: registered with LogstreamFactory, switched on by a node logger.logstream.<type> in rtc.conf.
#pragma once

#include <coil/Factory.h>
#include <coil/Logger.h>
#include <coil/Properties.h>

#include <streambuf>

#include "rtm/SystemLogger.h"

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

// The log of this process as classic sources spell it: Manager::getLogStreamBuf().addStream(&buffer). A buffer is not called for what it
// logs itself.
class LogStreamBuf {
 public:
  void addStream(std::streambuf* buffer, bool = false) { addLogStreamBuffer(buffer); }
  bool removeStream(std::streambuf* buffer) {
    removeLogStreamBuffer(buffer);
    return true;
  }
};

}  // namespace RTC
