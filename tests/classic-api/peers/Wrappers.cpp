// -*- C++ -*-
// A module without components: encodings for data ports of other modules.

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/ByteDataStreamBase.h>
#include <rtm/CORBA_CdrMemoryStream.h>
#include <coil/Factory.h>
#include <rtm/Manager.h>

#include <cstring>
#include <vector>

// A short goes out as a double and comes in from one.
class WideShort : public RTC::CORBA_CdrSerializer<RTC::TimedShort>
{
public:
  WideShort() = default;

  bool serialize(const RTC::TimedShort& data) override
  {
    RTC::TimedDouble wide;
    wide.tm = data.tm;
    wide.data = static_cast<CORBA::Double>(data.data);
    return m_cdr.serializeCDR(wide);
  }

  bool deserialize(RTC::TimedShort& data) override
  {
    RTC::TimedDouble wide;
    bool ret = m_cdr.deserializeCDR(wide);
    data.tm = wide.tm;
    data.data = static_cast<CORBA::Short>(wide.data);
    return ret;
  }
};

// Two octets per number instead of twelve, most significant first, no time.
template <class DataType>
class Packed : public RTC::ByteDataStream<DataType>
{
public:
  void init(const coil::Properties& prop) override
  {
    m_offset = 0;
    coil::stringTo(m_offset, prop.getProperty("packed.offset", "0").c_str());
  }
  void writeData(const unsigned char* buffer, unsigned long length) override
  {
    m_data.assign(buffer, buffer + length);
  }
  void readData(unsigned char* buffer, unsigned long length) const override
  {
    memcpy(buffer, &m_data[0], length);
  }
  unsigned long getDataLength() const override
  {
    return static_cast<unsigned long>(m_data.size());
  }
  bool serialize(const DataType& data) override
  {
    const long value = data.data + m_offset;
    if (value < 0 || value > 0xffff) { return false; }
    m_data.resize(2);
    m_data[0] = static_cast<unsigned char>(value >> 8);
    m_data[1] = static_cast<unsigned char>(value & 0xff);
    return true;
  }
  bool deserialize(DataType& data) override
  {
    if (m_data.size() != 2) { return false; }
    data.data = (m_data[0] << 8 | m_data[1]) - m_offset;
    return true;
  }

private:
  std::vector<unsigned char> m_data;
  int m_offset;
};

extern "C"
{
  DLL_EXPORT void WrappersInit(RTC::Manager* /*manager*/)
  {
    RTC::addSerializer<RTC::TimedShort, WideShort>("cdr:RTC/TimedDouble:RTC/TimedShort");
    coil::GlobalFactory< ::RTC::ByteDataStream<RTC::TimedLong> >::
        instance().addFactory("packed",
                              ::coil::Creator< ::RTC::ByteDataStream<RTC::TimedLong>, Packed<RTC::TimedLong> >,
                              ::coil::Destructor< ::RTC::ByteDataStream<RTC::TimedLong>, Packed<RTC::TimedLong> >);
  }
}
