// CDR as a serializer, and what own serializers are made from. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <exception>
#include <memory>

#include "rtm/ByteData.h"
#include "rtm/ByteDataStreamBase.h"

namespace RTC {

// CDR octets of values of any type of the IDL. Copies are independent.
class CORBA_CdrMemoryStream {
 public:
  CORBA_CdrMemoryStream();
  CORBA_CdrMemoryStream(const CORBA_CdrMemoryStream& other);
  ~CORBA_CdrMemoryStream();
  CORBA_CdrMemoryStream& operator=(const CORBA_CdrMemoryStream& other);

  // Replaces the contents. False if the value cannot be encoded.
  template <class Value>
  bool serializeCDR(const Value& value) {
    try {
      start();
      value >>= *cdr_;
      return true;
    } catch (const CORBA::Exception&) {
      return false;
    }
  }
  // Takes the next value out. False if the octets are no value of the type; `value` may be half written then.
  template <class Value>
  bool deserializeCDR(Value& value) {
    try {
      value <<= *cdr_;
      return true;
    } catch (const CORBA::Exception&) {
      return false;
    } catch (const std::exception&) {  // a length that no memory holds
      return false;
    }
  }
  // Of the next serializeCDR or writeCdrData.
  void setEndian(bool little_endian) { is_little_ = little_endian; }
  const unsigned char* getBuffer() { return static_cast<const unsigned char*>(cdr_->bufPtr()); }
  unsigned long getCdrDataLength() const { return cdr_->bufSize(); }
  cdrMemoryStream& getCdr() { return *cdr_; }
  // Replaces the contents.
  void writeCdrData(const unsigned char* buffer, unsigned long length);
  // Copies at most `length` octets out.
  void readCdrData(unsigned char* buffer, unsigned long length) const;

 private:
  void start();

  std::unique_ptr<cdrMemoryStream> cdr_;
  bool is_little_ = true;
};

// The encoding of connections that choose none. Own serializers derive from it and override serialize and deserialize.
template <class DataType>
class CORBA_CdrSerializer : public ByteDataStream<DataType> {
 public:
  void writeData(const unsigned char* buffer, unsigned long length) override { m_cdr.writeCdrData(buffer, length); }
  void readData(unsigned char* buffer, unsigned long length) const override { m_cdr.readCdrData(buffer, length); }
  unsigned long getDataLength() const override { return m_cdr.getCdrDataLength(); }
  bool serialize(const DataType& data) override { return m_cdr.serializeCDR(data); }
  bool deserialize(DataType& data) override { return m_cdr.deserializeCDR(data); }
  void isLittleEndian(bool little_endian) override { m_cdr.setEndian(little_endian); }

 protected:
  CORBA_CdrMemoryStream m_cdr;
};

}  // namespace RTC

// Puts the serializer "cdr" of that type where authors find it (coil::GlobalFactory). Ports do it by themselves.
template <class DataType>
void CdrMemoryStreamInit() {
  RTC::addSerializer<DataType, RTC::CORBA_CdrSerializer<DataType>>("cdr");
}
