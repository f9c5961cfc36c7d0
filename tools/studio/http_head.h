// The head of an HTTP request as it was received, before a parser reads it. A head that two programs could read in two ways is rejected: a
// proxy or a browser before us might have judged another request than the one that we would answer. Values; any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace studio {

inline constexpr std::size_t max_head = 8192;  // [byte] with the empty line at its end

// How much of what has come is a head.
struct HeadEnd {
  enum class State {
    incomplete,
    complete,
    too_long,   // 431
    malformed,  // 400: a line ends in something else than CR LF, or there is a control character
  } state = State::incomplete;
  std::size_t size = 0;  // [byte] of a complete one
};
HeadEnd find_head_end(std::string_view octets);

struct HeadProblem {
  unsigned status = 400;
  std::string_view why;
};
// Of a complete head; nothing for a good one. RFC 9112: a request line of three words, HTTP/1.0 or 1.1; fields without folds, whose names
// are tokens right before the colon; exactly one Host, which HTTP/1.0 may leave out; a target "/..." or one of the same host; fields that
// rights or lengths hang on once at most; no body.
std::optional<HeadProblem> check_head(std::string_view head);

// The target without scheme and host.
std::string_view origin_form(std::string_view target);

}  // namespace studio
