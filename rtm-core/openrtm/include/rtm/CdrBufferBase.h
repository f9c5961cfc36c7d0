// The samples that wait in a connection to be read or sent, as ConnectorBase::getBuffer shows it. The samples themselves are read from the
// port. Any thread; the counts may have changed when the caller looks at them.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace RTC {

class ByteData;

template <class DataType>
class BufferBase;

template <>
class BufferBase<ByteData> {
 public:
  // Places for samples: dataport.buffer.length.
  std::size_t length() const;
  // Samples that wait; 0 once the connection is gone, and for a subscription flush, which keeps none.
  std::size_t readable() const;
  std::size_t writable() const;
  bool empty() const { return readable() == 0; }
  bool full() const { return readable() >= length(); }
  // Throws away what waits, and the last value that would be read again.
  void reset();

 private:
  friend class RuntimeAccess;

  mutable std::mutex mutex_;
  std::weak_ptr<void> waiting_;
  std::size_t length_ = 0;
};

using CdrBufferBase = BufferBase<ByteData>;

}  // namespace RTC
