// Octets of one sample as listeners see them. A value; one thread at a time.
#pragma once

#include <vector>

namespace RTC {

class ByteDataStreamBase;

class ByteData {
 public:
  ByteData() = default;
  ByteData(const unsigned char* data, unsigned long length) { writeData(data, length); }
  // What a serializer holds.
  ByteData(const ByteDataStreamBase& stream) { *this = stream; }
  ByteData& operator=(const ByteDataStreamBase& stream);
  virtual ~ByteData() = default;
  ByteData(const ByteData&) = default;
  ByteData& operator=(const ByteData&) = default;

  unsigned char* getBuffer() { return octets_.data(); }
  const unsigned char* getBuffer() const { return octets_.data(); }
  unsigned long getDataLength() const { return octets_.size(); }
  virtual void setDataLength(unsigned long length) { octets_.resize(length); }
  // Replaces the contents.
  virtual void writeData(const unsigned char* data, unsigned long length) { octets_.assign(data, data + length); }
  // Copies at most `length` octets out.
  virtual void readData(unsigned char* data, unsigned long length) const;
  // The byte order of the contents.
  void isLittleEndian(bool little) { is_little_ = little; }
  bool isLittleEndian() const { return is_little_; }
  void setEndian(bool little) { is_little_ = little; }
  bool getEndian() const { return is_little_; }

 private:
  std::vector<unsigned char> octets_;
  bool is_little_ = true;
};

}  // namespace RTC
