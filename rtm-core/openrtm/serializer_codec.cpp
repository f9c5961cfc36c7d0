#include "openrtm/serializer_codec.h"

#include <vector>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"

namespace RTC::detail {
namespace {

// Serializers wait here for their next value, so that none is called with a lock held.
class SerializerCodec final : public corba::Codec {
 public:
  SerializerCodec(const Serializers& serializers, std::string name, coil::Properties connection)
      : serializers_(serializers), name_(std::move(name)), connection_(std::move(connection)) {}

  const std::string& name() const override { return name_; }

  // False if there is no such serializer, or it throws.
  bool warm_up() {
    Stream stream = ready();
    if (!stream) return false;
    give_back(std::move(stream));
    return true;
  }

  std::shared_ptr<rt::Block> encode(const void* value, rt::ByteOrder order) override {
    Stream stream = ready();
    if (!stream) return nullptr;
    std::shared_ptr<rt::Block> block;
    guarded("serialize", [&] {
      stream->isLittleEndian(order == rt::ByteOrder::little);
      if (!serializers_.serialize(*stream, value)) return false;
      block = octets_of(*stream);
      return true;
    });
    give_back(std::move(stream));
    return block;
  }

  bool decode(void* value, std::span<const std::byte> octets, rt::ByteOrder order) override {
    Stream stream = ready();
    if (!stream) return false;
    const bool is_good = guarded("deserialize", [&] {
      stream->isLittleEndian(order == rt::ByteOrder::little);
      stream->writeData(reinterpret_cast<const unsigned char*>(octets.data()), octets.size());
      return serializers_.deserialize(*stream, value);
    });
    give_back(std::move(stream));
    return is_good;
  }

 private:
  using Stream = std::shared_ptr<ByteDataStreamBase>;

  Stream ready() {
    if (Stream free = take()) return free;
    Stream made;
    guarded("the constructor", [&] {
      ByteDataStreamBase* stream = serializers_.create(name_);
      if (!stream) return false;
      made = Stream(stream, [all = &serializers_](ByteDataStreamBase* used) { all->destroy(used); });
      made->init(connection_);
      return true;
    });
    return made;
  }
  // Empty if none is free.
  Stream take() {
    auto free = free_.lock();
    if (free->empty()) return nullptr;
    Stream stream = std::move(free->back());
    free->pop_back();
    return stream;
  }
  void give_back(Stream stream) { free_.lock()->push_back(std::move(stream)); }

  // Of a value that has just been serialized.
  std::shared_ptr<rt::Block> octets_of(const ByteDataStreamBase& stream) {
    const unsigned long size = stream.getDataLength();
    auto block = pool_->take(size);
    if (size) stream.readData(reinterpret_cast<unsigned char*>(block->data()), size);
    return block;
  }

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
  void complain(const char* what, const char* thrown) const {
    base::log(base::Level::error, "data port", "{} of serializer {} has thrown: {}", what, base::in_quotes(name_), thrown);
  }

  const Serializers& serializers_;
  const std::string name_;
  const coil::Properties connection_;
  const std::shared_ptr<rt::BlockPool> pool_ = rt::BlockPool::make();
  base::Guarded<std::vector<Stream>, base::Rank::memory> free_;
};

}  // namespace

std::shared_ptr<corba::Codec> make_codec(const Serializers& serializers, const std::string& name, const coil::Properties& connection) {
  auto codec = std::make_shared<SerializerCodec>(serializers, name, connection);
  return codec->warm_up() ? codec : nullptr;
}

}  // namespace RTC::detail
