#include "rtm/Serializers.h"

#include "base/log.h"
#include "base/text.h"

namespace RTC::detail {

SerializerCodec::Stream SerializerCodec::take() {
  auto free = free_.lock();
  if (free->empty()) return nullptr;
  Stream stream = std::move(free->back());
  free->pop_back();
  return stream;
}

void SerializerCodec::give_back(Stream stream) { free_.lock()->push_back(std::move(stream)); }

std::shared_ptr<rt::Block> SerializerCodec::octets_of(const ByteDataStreamBase& stream) {
  const unsigned long size = stream.getDataLength();
  auto block = pool_->take(size);
  if (size) stream.readData(reinterpret_cast<unsigned char*>(block->data()), size);
  return block;
}

void SerializerCodec::complain(const char* what, const char* thrown) const {
  base::log(base::Level::error, "data port", "{} of serializer {} has thrown: {}", what, base::in_quotes(name_), thrown);
}

}  // namespace RTC::detail
