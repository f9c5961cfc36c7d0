// Writes a line as log() does without a sink; for sinks that do more than that. Any thread.
#pragma once

#include "base/log.h"

namespace base {

void log_to_stderr(const LogRecord& record);

}  // namespace base
