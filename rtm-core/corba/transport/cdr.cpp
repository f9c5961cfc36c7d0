#include "corba/transport/cdr.h"

#include <cstdint>
#include <cstring>

#include "corba/transport/payload.h"

namespace corba {
namespace {

constexpr std::size_t cheap_copy = 4096;  // [octets]

// Reads octets where they are. The ORB's own check multiplies with 32 bits, by which a made-up length of 2^29 doubles passes.
class DecodingStream final : public cdrMemoryStream {
 public:
  DecodingStream(void* octets, std::size_t size) : cdrMemoryStream(octets, size), size_(size) {}
  _CORBA_Boolean checkInputOverrun(_CORBA_ULong item_size, _CORBA_ULong items, omni::alignment_t align = omni::ALIGN_1) override {
    return std::uint64_t{item_size} * items <= size_ && cdrMemoryStream::checkInputOverrun(item_size, items, align);
  }

 private:
  std::size_t size_;
};

}  // namespace

bool has_wide_text(CORBA::TypeCode_ptr code) {
  // Recursive types are looked into to a depth that no real type reaches.
  const auto look = [](const auto& self, CORBA::TypeCode_ptr type, int depth) -> bool {
    if (depth > 16) return true;
    switch (type->kind()) {
      case CORBA::tk_wchar:
      case CORBA::tk_wstring:
        return true;
      case CORBA::tk_alias:
      case CORBA::tk_sequence:
      case CORBA::tk_array: {
        const CORBA::TypeCode_var content = type->content_type();
        return self(self, content, depth + 1);
      }
      case CORBA::tk_struct:
      case CORBA::tk_union:
      case CORBA::tk_except:
        for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
          const CORBA::TypeCode_var member = type->member_type(i);
          if (self(self, member, depth + 1)) return true;
        }
        return false;
      case CORBA::tk_any:
      case CORBA::tk_objref:
      case CORBA::tk_TypeCode:
      case CORBA::tk_value:
      case CORBA::tk_value_box:
      case CORBA::tk_abstract_interface:
        return true;  // made on the fly while encoding
      default:
        return false;
    }
  };
  return look(look, code, 0);
}

void stamp(const TypeOps& ops, void* value, std::chrono::nanoseconds time) {
  ops.stamp(value, static_cast<CORBA::ULong>(time.count() / 1'000'000'000), static_cast<CORBA::ULong>(time.count() % 1'000'000'000));
}

std::shared_ptr<rt::Block> encode(const TypeOps& ops, const void* value, rt::ByteOrder order, rt::BlockPool& pool) {
  Payload payload(ops, value);
  return std::const_pointer_cast<rt::Block>(payload.encoded(order, pool).block);
}

std::shared_ptr<rt::Block> encode(const TypeOps& ops, const void* value, rt::ByteOrder order) {
  return encode(ops, value, order, *rt::BlockPool::make());
}

bool decode(const TypeOps& ops, void* value, std::span<const std::byte> octets, rt::ByteOrder order) {
  if (ops.codec) return ops.codec->decode(value, octets, order);
  if (reinterpret_cast<std::uintptr_t>(octets.data()) % 8 != 0) {
    // The decoder aligns by address.
    rt::Block aligned(octets.size());
    std::copy(octets.begin(), octets.end(), aligned.data());
    aligned.set_size(octets.size());
    return decode(ops, value, aligned.octets(), order);
  }
  try {
    static std::byte nothing[8];
    DecodingStream stream(octets.empty() ? nothing : const_cast<std::byte*>(octets.data()), octets.size());
    stream.setByteSwapFlag(order == rt::ByteOrder::little);
    ops.decode(value, stream);
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  } catch (const std::exception&) {  // a length that no memory holds
    return false;
  }
}

void forget_contents(cdrMemoryStream& stream) {
  std::memset(stream.bufPtr(), 0, stream.bufSize());
  stream.rewindPtrs();
}

_CORBA_Boolean CheckedStream::checkInputOverrun(_CORBA_ULong item_size, _CORBA_ULong items, omni::alignment_t align) {
  return std::uint64_t{item_size} * items <= bufSize() && cdrMemoryStream::checkInputOverrun(item_size, items, align);
}

bool decode_safely(const TypeOps& ops, void* value, std::span<const std::byte> octets, rt::ByteOrder order) {
  if (octets.size() > cheap_copy) {
    if (decode(ops, value, octets, order)) return true;
    ops.assign(value, ops.make().get());
    return false;
  }
  const auto scratch = ops.make();
  if (!decode(ops, scratch.get(), octets, order)) return false;
  ops.assign(value, scratch.get());
  return true;
}

}  // namespace corba
