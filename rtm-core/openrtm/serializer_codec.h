// Adapts a serializer of an author to the encoding of one connection.
#pragma once

#include <coil/Properties.h>
#include <rtm/Serializers.h>

#include <memory>
#include <string>

#include "corba/transport/type_ops.h"

namespace RTC::detail {

// nullptr if nothing of that name is registered, or it throws. `connection`: properties for the serializer's init. The serializers must
// outlive the codec. Any thread.
std::shared_ptr<corba::Codec> make_codec(const Serializers& serializers, const std::string& name, const coil::Properties& connection);

}  // namespace RTC::detail
