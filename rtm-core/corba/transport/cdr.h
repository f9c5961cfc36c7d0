// Encodes and decodes values: the plain CDR of data ports, without a header, aligned from the first byte, or the encoding of the type's
// codec. Any thread.
#pragma once

#include <memory>
#include <span>

#include "corba/transport/type_ops.h"
#include "core/sample.h"

namespace corba {

std::shared_ptr<rt::Block> encode(const TypeOps& ops, const void* value, rt::ByteOrder order);
std::shared_ptr<rt::Block> encode(const TypeOps& ops, const void* value, rt::ByteOrder order, rt::BlockPool& pool);

// False if the octets are no value of the type: too short, a length beyond the end, an unknown enumerator. `value` may be half written
// then. Octets after the value are allowed.
[[nodiscard]] bool decode(const TypeOps& ops, void* value, std::span<const std::byte> octets, rt::ByteOrder order);

// The same, but `value` stays as it is unless the octets are good, or becomes a default value where keeping it would be dear (above 4 KiB).
[[nodiscard]] bool decode_safely(const TypeOps& ops, void* value, std::span<const std::byte> octets, rt::ByteOrder order);

// Rewinds a stream whose memory was zero at first, and makes it so again: the encoder skips the octets between the members of a value,
// which would show what was encoded before.
void forget_contents(cdrMemoryStream& stream);

// A stream for the generated operators that rejects lengths beyond its end, however large. One thread at a time.
class CheckedStream final : public cdrMemoryStream {
 public:
  CheckedStream() : cdrMemoryStream(0, true) {}
  _CORBA_Boolean checkInputOverrun(_CORBA_ULong item_size, _CORBA_ULong items, omni::alignment_t align = omni::ALIGN_1) override;
};

}  // namespace corba
