// A sample of one type as CDR octets that can be encoded and decoded. One thread at a time.
#pragma once

#include "corba/cdr.h"
#include "rtm/ByteData.h"

namespace RTC {

template <class DataType>
class CORBA_CdrMemoryStream : public ByteDataStream<DataType> {
 public:
  bool serialize(const DataType& data) override {
    try {
      const auto block = corba::encode(corba::type_ops<DataType>(), &data, order());
      this->writeData(reinterpret_cast<const unsigned char*>(block->data()), block->size());
      return true;
    } catch (const CORBA::SystemException&) {
      return false;
    }
  }
  bool deserialize(DataType& data) override {
    return corba::decode_safely(corba::type_ops<DataType>(), &data, std::as_bytes(std::span(this->getBuffer(), this->getDataLength())),
                                order());
  }

 private:
  rt::ByteOrder order() const { return this->isLittleEndian() ? rt::ByteOrder::little : rt::ByteOrder::big; }
};

}  // namespace RTC
