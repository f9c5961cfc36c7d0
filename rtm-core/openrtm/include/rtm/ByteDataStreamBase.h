// Serializers: encode values of one type as bytes, and decode them. A module registers its own under a name with addSerializer; connections
// choose one with dataport.marshaling_type (dataport.inport.*, dataport.outport.* for one side). A serializer is used by one thread at a
// time; a connection makes as many as it needs. Registering: any thread.
#pragma once

#include <coil/Factory.h>
#include <coil/Properties.h>

#include <string>

namespace RTC {

class ByteDataStreamBase {
 public:
  virtual ~ByteDataStreamBase() = default;
  // The properties of the connection, without the prefix "dataport.".
  virtual void init(const coil::Properties&) {}
  // Octets that came, for deserialize.
  virtual void writeData(const unsigned char* buffer, unsigned long length) = 0;
  // Copies what serialize has made; length is getDataLength().
  virtual void readData(unsigned char* buffer, unsigned long length) const = 0;
  virtual unsigned long getDataLength() const = 0;
  // The byte order of the connection; comes before serialize and deserialize.
  virtual void isLittleEndian(bool /*little_endian*/) {}
};

template <typename DataType>
class ByteDataStream : public ByteDataStreamBase {
 public:
  // False if the value cannot be encoded: the write fails.
  virtual bool serialize(const DataType& data) = 0;
  // False if the octets are no value: the sample is dropped.
  virtual bool deserialize(DataType& data) = 0;
};

// Makes the serializer known to all ports of that type in this process. A name that is taken keeps its serializer.
template <class DataType, class SerializerType>
void addSerializer(const std::string& marshaling_type) {
  coil::GlobalFactory<ByteDataStream<DataType>>::instance().addFactory(
      marshaling_type, coil::Creator<ByteDataStream<DataType>, SerializerType>, coil::Destructor<ByteDataStream<DataType>, SerializerType>);
}

template <class DataType>
void removeSerializer(const std::string& marshaling_type) {
  coil::GlobalFactory<ByteDataStream<DataType>>::instance().removeFactory(marshaling_type);
}

}  // namespace RTC
