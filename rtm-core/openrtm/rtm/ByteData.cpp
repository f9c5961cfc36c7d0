#include "rtm/ByteData.h"

#include <algorithm>

#include "rtm/ByteDataStreamBase.h"

namespace RTC {

ByteData& ByteData::operator=(const ByteDataStreamBase& stream) {
  octets_.resize(stream.getDataLength());
  stream.readData(octets_.data(), octets_.size());
  return *this;
}

void ByteData::readData(unsigned char* data, unsigned long length) const {
  std::copy_n(octets_.data(), std::min<std::size_t>(length, octets_.size()), data);
}

}  // namespace RTC
