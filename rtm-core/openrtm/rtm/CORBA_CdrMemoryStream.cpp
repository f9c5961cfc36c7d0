#include "rtm/CORBA_CdrMemoryStream.h"

#include <algorithm>
#include <cstring>

#include "corba/transport/cdr.h"

namespace RTC {

CORBA_CdrMemoryStream::CORBA_CdrMemoryStream() : cdr_(std::make_unique<corba::CheckedStream>()) { cdr_->setByteSwapFlag(true); }
CORBA_CdrMemoryStream::CORBA_CdrMemoryStream(const CORBA_CdrMemoryStream& other) : CORBA_CdrMemoryStream() { *this = other; }
CORBA_CdrMemoryStream::~CORBA_CdrMemoryStream() = default;

CORBA_CdrMemoryStream& CORBA_CdrMemoryStream::operator=(const CORBA_CdrMemoryStream& other) {
  if (this == &other) return *this;
  is_little_ = other.is_little_;
  writeCdrData(static_cast<const unsigned char*>(other.cdr_->bufPtr()), other.cdr_->bufSize());
  return *this;
}

void CORBA_CdrMemoryStream::start() {
  corba::forget_contents(*cdr_);
  cdr_->setByteSwapFlag(is_little_);
}

void CORBA_CdrMemoryStream::writeCdrData(const unsigned char* buffer, unsigned long length) {
  start();
  if (length) cdr_->put_octet_array(buffer, static_cast<int>(length));
}

void CORBA_CdrMemoryStream::readCdrData(unsigned char* buffer, unsigned long length) const {
  const std::size_t size = std::min<std::size_t>(length, cdr_->bufSize());
  if (size) std::memcpy(buffer, cdr_->bufPtr(), size);
}

}  // namespace RTC
