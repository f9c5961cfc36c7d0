#include "rtm/ByteData.h"

#include <algorithm>
#include <utility>

#include "openrtm/opaque_types.h"
#include "rtm/ByteDataStreamBase.h"

namespace RTC {
namespace {

// Large copies of one listener after the other use the same memory.
constexpr std::size_t max_kept = 16u << 20;
std::vector<unsigned char>& spare() {
  thread_local std::vector<unsigned char> memory;
  return memory;
}

}  // namespace

ByteData::ByteData(detail::SampleEvent& event) : event_(&event), is_little_(event.data.order() == rt::ByteOrder::little) {}

ByteData::~ByteData() {
  if (octets_.capacity() > spare().capacity() && octets_.capacity() <= max_kept) octets_.swap(spare());
}

ByteData::ByteData(const ByteData& other) : is_little_(other.is_little_) { ByteData::writeData(other.getBuffer(), other.getDataLength()); }

ByteData& ByteData::operator=(const ByteData& other) {
  if (this == &other) return *this;
  ByteData::writeData(other.getBuffer(), other.getDataLength());
  is_little_ = other.is_little_;
  return *this;
}

ByteData& ByteData::operator=(const ByteDataStreamBase& stream) {
  event_ = nullptr;
  octets_.resize(stream.getDataLength());
  stream.readData(octets_.data(), octets_.size());
  return *this;
}

void ByteData::own() {
  if (!event_) return;
  octets_.swap(spare());
  octets_.resize(event_->data.size());
  event_->data.copy_octets(reinterpret_cast<std::byte*>(octets_.data()));
  event_ = nullptr;
}

unsigned char* ByteData::getBuffer() {
  own();
  return octets_.data();
}

const unsigned char* ByteData::getBuffer() const {
  return event_ ? reinterpret_cast<const unsigned char*>(event_->data.octets().data()) : octets_.data();
}

unsigned long ByteData::getDataLength() const { return event_ ? event_->data.size() : octets_.size(); }

void ByteData::setDataLength(unsigned long length) {
  own();
  octets_.resize(length);
}

void ByteData::writeData(const unsigned char* data, unsigned long length) {
  event_ = nullptr;
  octets_.assign(data, data + length);
}

void ByteData::readData(unsigned char* data, unsigned long length) const {
  std::copy_n(getBuffer(), std::min<std::size_t>(length, getDataLength()), data);
}

}  // namespace RTC
