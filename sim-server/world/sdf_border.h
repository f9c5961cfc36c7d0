// The border to libsdformat: every call to it goes through ask_library(). It throws what is no std::exception (its assertions among it) and
// writes to the streams of the standard library. One thread at a time.
#pragma once

#include <iostream>
#include <new>
#include <sdf/sdf.hh>
#include <streambuf>
#include <string>
#include <type_traits>

#include "base/result.h"
#include "base/text.h"

namespace sim {

// While it lives, what is written to std::cout and std::cerr is lost. We write to neither.
class QuietStreams {
 public:
  QuietStreams() : out_(std::cout.rdbuf(&silence_)), err_(std::cerr.rdbuf(&silence_)) {}
  ~QuietStreams() {
    std::cout.rdbuf(out_);
    std::cerr.rdbuf(err_);
  }
  QuietStreams(const QuietStreams&) = delete;
  QuietStreams& operator=(const QuietStreams&) = delete;

 private:
  class Silence final : public std::streambuf {
    int_type overflow(int_type character) override { return traits_type::not_eof(character); }
    std::streamsize xsputn(const char*, std::streamsize count) override { return count; }
  };

  Silence silence_;
  std::streambuf* out_;
  std::streambuf* err_;
};

inline base::Error reason(std::string message) {
  for (char& c : message) c = static_cast<unsigned char>(c) < 32 ? ' ' : c;
  const std::string_view trimmed = base::trim(message);
  return {trimmed.empty() ? "libsdformat gives no reason" : std::string(trimmed)};
}

// What the call returns, or why it threw. Only std::bad_alloc passes: the caller knows what was too large.
template <class Call>
base::Result<std::invoke_result_t<Call>> ask_library(Call call) {
  const QuietStreams quiet;
  try {
    return call();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const sdf::Exception& problem) {
    return reason(problem.GetErrorStr());
  } catch (const std::exception& problem) {
    return reason(problem.what());
  } catch (...) {
    return reason({});
  }
}

}  // namespace sim
