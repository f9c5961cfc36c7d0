// The registered serializers of one type, as the ports of that type use them. Not for component authors. Any thread; one serializer is used
// by one thread at a time.
#pragma once

#include <string>
#include <vector>

#include "rtm/ByteDataStreamBase.h"
#include "rtm/CORBA_CdrMemoryStream.h"

namespace RTC {
namespace detail {

// Calls of an author's code may throw anything.
class Serializers {
 public:
  virtual ~Serializers() = default;
  // "cdr", then the others in alphabetical order.
  virtual std::vector<std::string> names() const = 0;
  // nullptr if nothing of that name is registered.
  virtual ByteDataStreamBase* create(const std::string& name) const = 0;
  // The stream is one of create().
  virtual void destroy(ByteDataStreamBase* stream) const = 0;
  virtual bool serialize(ByteDataStreamBase& stream, const void* value) const = 0;
  virtual bool deserialize(ByteDataStreamBase& stream, void* value) const = 0;
};

template <class DataType>
class TypedSerializers final : public Serializers {
  using Typed = ByteDataStream<DataType>;
  using Factory = coil::GlobalFactory<Typed>;

 public:
  TypedSerializers() { CdrMemoryStreamInit<DataType>(); }
  std::vector<std::string> names() const override {
    std::vector<std::string> all{"cdr"};
    for (auto& name : Factory::instance().getIdentifiers()) {
      if (name != all.front()) all.push_back(std::move(name));
    }
    return all;
  }
  ByteDataStreamBase* create(const std::string& name) const override { return Factory::instance().createObject(name); }
  void destroy(ByteDataStreamBase* stream) const override {
    auto* typed = static_cast<Typed*>(stream);
    Factory::instance().deleteObject(typed);
  }
  bool serialize(ByteDataStreamBase& stream, const void* value) const override {
    return static_cast<Typed&>(stream).serialize(*static_cast<const DataType*>(value));
  }
  bool deserialize(ByteDataStreamBase& stream, void* value) const override {
    return static_cast<Typed&>(stream).deserialize(*static_cast<DataType*>(value));
  }
};

template <class DataType>
const Serializers& serializers_of() {
  static const TypedSerializers<DataType> all;
  return all;
}

}  // namespace detail
}  // namespace RTC
