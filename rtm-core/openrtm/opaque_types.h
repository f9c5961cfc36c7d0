// Types of the runtime under the names that headers for authors declare and never define.
#pragma once

#include "corba/ports/port_servant.h"
#include "corba/transport/event_data.h"

namespace RTC::detail {

struct PortTerms : corba::ConnectionTerms {};

struct SampleEvent {
  corba::EventData& data;  // outlives it
};

}  // namespace RTC::detail
