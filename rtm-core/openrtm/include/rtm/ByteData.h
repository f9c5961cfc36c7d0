// The bytes of one sample as listeners see them. A value; one thread at a time. A listener receives a view of the bytes. They are copied
// before a caller can change them, by getBuffer() of one that is not const or by setDataLength, and when the object itself is copied.
#pragma once

#include <vector>

namespace RTC {

namespace detail {
struct SampleEvent;
}

class ByteDataStreamBase;

class ByteData {
 public:
  ByteData() = default;
  ByteData(const unsigned char* data, unsigned long length) { writeData(data, length); }
  // What a serializer holds.
  ByteData(const ByteDataStreamBase& stream) { *this = stream; }
  ByteData& operator=(const ByteDataStreamBase& stream);
  // Ports make these for listeners; the event must outlive it.
  explicit ByteData(detail::SampleEvent& event);
  virtual ~ByteData();
  ByteData(const ByteData& other);
  ByteData& operator=(const ByteData& other);

  unsigned char* getBuffer();
  const unsigned char* getBuffer() const;
  unsigned long getDataLength() const;
  virtual void setDataLength(unsigned long length);
  // Replaces the contents.
  virtual void writeData(const unsigned char* data, unsigned long length);
  // Copies at most `length` octets out.
  virtual void readData(unsigned char* data, unsigned long length) const;
  // The byte order of the contents.
  void isLittleEndian(bool little) { is_little_ = little; }
  bool isLittleEndian() const { return is_little_; }
  void setEndian(bool little) { is_little_ = little; }
  bool getEndian() const { return is_little_; }

 private:
  void own();

  detail::SampleEvent* event_ = nullptr;  // shown as long as there is one
  std::vector<unsigned char> octets_;
  bool is_little_ = true;
};

}  // namespace RTC
