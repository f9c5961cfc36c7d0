// RTC::BufferBase<RTC::ByteData>, for sources that include the header of that name.
#pragma once

#include <rtm/CdrBufferBase.h>
