// A CDR encoder that does not copy long arrays, and stores their addresses instead. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <vector>

#include "corba/transport/payload.h"
#include "core/sample.h"

namespace corba {

class GatherStream final : public cdrMemoryStream {
 public:
  GatherStream() : cdrMemoryStream(0, true) {}
  // Forgets what was encoded before. Without `gathers` everything is copied.
  void start(rt::ByteOrder order, bool gathers);
  // What has been encoded since; good until the next start and as long as the encoded value stays as it is.
  Pieces pieces() const;

  void put_octet_array(const _CORBA_Octet* octets, int size, omni::alignment_t align = omni::ALIGN_1) override;

 private:
  // An array of the value that follows the copied octets up to `copied_end`; copying goes on at `copied_start`.
  struct Borrowed {
    std::size_t copied_end;
    std::size_t copied_start;
    std::span<const std::byte> octets;
  };
  std::vector<Borrowed> borrowed_;
  bool gathers_ = true;
};

}  // namespace corba
