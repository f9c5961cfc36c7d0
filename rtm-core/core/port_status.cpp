#include "core/port_status.h"

namespace rt {

std::string_view to_text(PortStatus status) {
  switch (status) {
    case PortStatus::ok:
      return "PORT_OK";
    case PortStatus::error:
      return "PORT_ERROR";
    case PortStatus::buffer_error:
      return "BUFFER_ERROR";
    case PortStatus::buffer_full:
      return "BUFFER_FULL";
    case PortStatus::buffer_empty:
      return "BUFFER_EMPTY";
    case PortStatus::buffer_timeout:
      return "BUFFER_TIMEOUT";
    case PortStatus::send_full:
      return "SEND_FULL";
    case PortStatus::send_timeout:
      return "SEND_TIMEOUT";
    case PortStatus::recv_empty:
      return "RECV_EMPTY";
    case PortStatus::recv_timeout:
      return "RECV_TIMEOUT";
    case PortStatus::invalid_args:
      return "INVALID_ARGS";
    case PortStatus::precondition_not_met:
      return "PRECONDITION_NOT_MET";
    case PortStatus::connection_lost:
      return "CONNECTION_LOST";
    case PortStatus::unknown_error:
      return "UNKNOWN_ERROR";
  }
  return "UNKNOWN_ERROR";
}

}  // namespace rt
