#include "rtse/output.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "base/descriptors.h"

namespace editor {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7f'; }

void append_escaped(std::string& text, char c) {
  char escape[8];
  std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
  text += escape;
}

class Filter : public std::streambuf {
 public:
  explicit Filter(std::streambuf& target) : target_(target) {}

 protected:
  int_type overflow(int_type c) override {
    const char one = traits_type::to_char_type(c);
    return traits_type::eq_int_type(c, traits_type::eof()) || xsputn(&one, 1) == 1 ? traits_type::not_eof(c) : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    const auto shown = for_terminal({text, static_cast<std::size_t>(size)});
    const auto length = static_cast<std::streamsize>(shown.size());
    return target_.sputn(shown.data(), length) == length ? size : 0;
  }
  int sync() override { return target_.pubsync(); }

 private:
  std::streambuf& target_;
};

}  // namespace

std::string for_terminal(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_c1 = text[i] == '\xc2' && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    if (is_c1) {
      append_escaped(result, text[++i]);
    } else if (is_control(text[i]) && text[i] != '\n' && text[i] != '\t') {
      append_escaped(result, text[i]);
    } else {
      result += text[i];
    }
  }
  return result;
}

TerminalGuard::TerminalGuard(std::ostream& stream, int descriptor) : stream_(stream), target_(stream.rdbuf()) {
  if (!isatty(descriptor)) return;
  filter_ = std::make_unique<Filter>(*target_);
  stream_.rdbuf(filter_.get());
}

TerminalGuard::~TerminalGuard() {
  if (filter_) stream_.rdbuf(target_);
}

bool flush_output() {
  const bool is_written = std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return is_written || base::output_is_closed();
}

}  // namespace editor
