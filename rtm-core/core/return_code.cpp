#include "core/return_code.h"

namespace rt {

std::string_view to_text(ReturnCode code) {
  switch (code) {
    case ReturnCode::ok:
      return "RTC_OK";
    case ReturnCode::error:
      return "RTC_ERROR";
    case ReturnCode::bad_parameter:
      return "BAD_PARAMETER";
    case ReturnCode::unsupported:
      return "UNSUPPORTED";
    case ReturnCode::out_of_resources:
      return "OUT_OF_RESOURCES";
    case ReturnCode::precondition_not_met:
      return "PRECONDITION_NOT_MET";
  }
  return "unknown return code";
}

}  // namespace rt
