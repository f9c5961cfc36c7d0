// Encodes and decodes payloads. Pure; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/xdr.h"

namespace player {

template <class Put>
std::string written(Put put_all) {
  XdrWriter out;
  put_all(out);
  return std::move(out.bytes());
}

// The value that `take` reads, if the payload is exactly that.
template <class Take>
auto whole(std::string_view payload, Take take) {
  XdrReader in(payload);
  auto value = take(in);
  return in.is_complete() ? std::optional(std::move(value)) : std::nullopt;
}

}  // namespace player
