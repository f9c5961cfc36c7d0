// The registered serializers of one type as its ports use them. Not for component authors. Any thread.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "corba/type_ops.h"
#include "rtm/CORBA_CdrMemoryStream.h"

namespace RTC::detail {

class Serializers {
 public:
  virtual ~Serializers() = default;
  // "cdr", then the others in alphabetical order.
  virtual std::vector<std::string> names() const = 0;
  // nullptr if nothing of that name is registered. `connection`: properties for the serializer's init.
  virtual std::shared_ptr<corba::Codec> make(const std::string& name, const coil::Properties& connection) const = 0;
};

// The part of a codec that knows no type: serializers wait here for their next value, so that none is called with a lock held.
class SerializerCodec : public corba::Codec {
 public:
  explicit SerializerCodec(std::string name) : name_(std::move(name)) {}
  const std::string& name() const override { return name_; }

 protected:
  using Stream = std::shared_ptr<ByteDataStreamBase>;
  // Empty if none is free.
  Stream take();
  void give_back(Stream stream);
  // Of a value that has just been serialized.
  std::shared_ptr<rt::Block> octets_of(const ByteDataStreamBase& stream);
  // Calls the author's code; false also if it throws, which is logged.
  template <class Call>
  bool guarded(const char* what, Call call) const {
    try {
      return call();
    } catch (const std::exception& e) {
      complain(what, e.what());
    } catch (const CORBA::Exception& e) {
      complain(what, e._name());
    } catch (...) {
      complain(what, "something that is no std::exception");
    }
    return false;
  }

 private:
  void complain(const char* what, const char* thrown) const;

  const std::string name_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  base::Guarded<std::vector<Stream>, base::Rank::registry> free_;
};

template <class DataType>
class TypedCodec final : public SerializerCodec {
  using Factory = coil::GlobalFactory<ByteDataStream<DataType>>;
  using Typed = ByteDataStream<DataType>;

 public:
  TypedCodec(std::string name, coil::Properties connection) : SerializerCodec(std::move(name)), connection_(std::move(connection)) {}

  // False if there is no such serializer, or it throws.
  bool warm_up() { return static_cast<bool>(keep(ready())); }

  std::shared_ptr<rt::Block> encode(const void* value, rt::ByteOrder order) override {
    const Stream stream = ready();
    if (!stream) return nullptr;
    std::shared_ptr<rt::Block> block;
    guarded("serialize", [&] {
      stream->isLittleEndian(order == rt::ByteOrder::little);
      if (!static_cast<Typed&>(*stream).serialize(*static_cast<const DataType*>(value))) return false;
      block = octets_of(*stream);
      return true;
    });
    keep(stream);
    return block;
  }
  bool decode(void* value, std::span<const std::byte> octets, rt::ByteOrder order) override {
    const Stream stream = ready();
    if (!stream) return false;
    const bool is_good = guarded("deserialize", [&] {
      stream->isLittleEndian(order == rt::ByteOrder::little);
      stream->writeData(reinterpret_cast<const unsigned char*>(octets.data()), octets.size());
      return static_cast<Typed&>(*stream).deserialize(*static_cast<DataType*>(value));
    });
    keep(stream);
    return is_good;
  }

 private:
  Stream ready() {
    if (Stream free = take()) return free;
    Stream made;
    guarded("the constructor", [&] {
      auto* stream = Factory::instance().createObject(name());
      if (!stream) return false;
      made = Stream(stream, [stream](ByteDataStreamBase*) {
        Typed* object = stream;
        Factory::instance().deleteObject(object);
      });
      made->init(connection_);
      return true;
    });
    return made;
  }
  Stream keep(Stream stream) {
    if (stream) give_back(stream);
    return stream;
  }

  const coil::Properties connection_;
};

template <class DataType>
class TypedSerializers final : public Serializers {
 public:
  TypedSerializers() { CdrMemoryStreamInit<DataType>(); }
  std::vector<std::string> names() const override {
    std::vector<std::string> all{"cdr"};
    for (auto& name : coil::GlobalFactory<ByteDataStream<DataType>>::instance().getIdentifiers()) {
      if (name != all.front()) all.push_back(std::move(name));
    }
    return all;
  }
  std::shared_ptr<corba::Codec> make(const std::string& name, const coil::Properties& connection) const override {
    auto codec = std::make_shared<TypedCodec<DataType>>(name, connection);
    return codec->warm_up() ? codec : nullptr;
  }
};

template <class DataType>
const Serializers& serializers_of() {
  static const TypedSerializers<DataType> all;
  return all;
}

}  // namespace RTC::detail
