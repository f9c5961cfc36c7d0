#include "rtm/ByteData.h"

#include <algorithm>

namespace RTC {

void ByteData::readData(unsigned char* data, unsigned long length) const {
  std::copy_n(octets_.data(), std::min<std::size_t>(length, octets_.size()), data);
}

}  // namespace RTC
