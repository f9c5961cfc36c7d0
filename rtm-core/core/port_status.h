// The result of sending or receiving one sample. Any thread.
#pragma once

#include <string_view>

namespace rt {

enum class PortStatus {
  ok,
  error,
  buffer_error,
  buffer_full,
  buffer_empty,
  buffer_timeout,
  send_full,     // the receiver's buffer is full
  send_timeout,  // the receiver's buffer stayed full for its time-out
  recv_empty,    // the sender has nothing
  recv_timeout,
  invalid_args,
  precondition_not_met,
  connection_lost,
  unknown_error
};

// "PORT_OK", "CONNECTION_LOST", ...
std::string_view to_text(PortStatus status);

}  // namespace rt
