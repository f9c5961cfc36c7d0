#include "base/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/text.h"

namespace base {
namespace {

void append_escaped(std::string& text, std::string_view octets) {
  for (const char c : octets) {
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
    text += escape;
  }
}

// How many octets at the end begin a character whose rest has not come yet.
std::size_t unfinished(std::string_view text) {
  for (std::size_t size = 1; size <= std::min<std::size_t>(3, text.size()); ++size) {
    const auto first = static_cast<unsigned char>(text[text.size() - size]);
    if ((first & 0xc0U) == 0x80U) continue;
    const std::size_t length = first >= 0xf0U ? 4 : first >= 0xe0U ? 3 : first >= 0xc0U ? 2 : 1;
    return length > size ? size : 0;
  }
  return 0;
}

// Characters may come in pieces: what begins one waits for its rest.
class Filter : public std::streambuf {
 public:
  explicit Filter(std::streambuf& target) : target_(target) {}
  ~Filter() override { put(std::exchange(begun_, {})); }

 protected:
  int_type overflow(int_type c) override {
    const char one = traits_type::to_char_type(c);
    return traits_type::eq_int_type(c, traits_type::eof()) || xsputn(&one, 1) == 1 ? traits_type::not_eof(c) : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    begun_.append(text, static_cast<std::size_t>(size));
    auto whole = std::exchange(begun_, {});
    const auto rest = unfinished(whole);
    begun_ = whole.substr(whole.size() - rest);
    whole.resize(whole.size() - rest);
    return put(whole) ? size : 0;
  }
  int sync() override { return target_.pubsync(); }

 private:
  bool put(const std::string& text) {
    const auto shown = for_terminal(text);
    const auto length = static_cast<std::streamsize>(shown.size());
    return target_.sputn(shown.data(), length) == length;
  }

  std::streambuf& target_;
  std::string begun_;
};

}  // namespace

std::string for_terminal(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const auto character = first_character(text);
    const std::size_t size = character ? character->size : 1;
    const bool is_layout = size == 1 && (text[0] == '\n' || text[0] == '\t');
    // Some terminals obey single octets of C1.
    const bool is_stray_control = !character && static_cast<unsigned char>(text[0]) < 0xa0;
    if (is_stray_control || (character && is_obeyed(character->code) && !is_layout)) {
      append_escaped(result, text.substr(0, size));
    } else {
      result += text.substr(0, size);
    }
    text.remove_prefix(size);
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

}  // namespace base
