#include "world/xml_repair.h"

#include <array>
#include <optional>
#include <string_view>

namespace sim {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Quotes as word processors and web pages make them.
constexpr std::array<std::string_view, 6> typographic_quotes{"\u201c", "\u201d", "\u201e", "\u2018", "\u2019", "\u2033"};

class XmlRepair {
 public:
  explicit XmlRepair(const std::string& text) : text_(text) { repaired_.reserve(text.size() + 64); }

  RepairedText run() {
    while (at_ < text_.size()) {
      if (text_[at_] != '<') {
        repaired_ += text_[at_++];
      } else if (!copy_through("<!--", "-->") && !copy_through("<![CDATA[", "]]>") && !copy_through("<?", "?>") &&
                 !copy_through("<!", ">")) {
        copy_tag();
      }
    }
    RepairedText out;
    out.text = std::move(repaired_);
    const auto say = [&](const std::optional<std::size_t>& at, const char* message) {
      if (at) out.changes.push_back({*at, message});
    };
    say(without_quotes_, "attribute values without quotes are corrected");
    say(odd_quotes_, "attribute values with doubled or typographic quotes are corrected");
    say(stray_ends_, "end tags of elements that have ended are left out");
    return out;
  }

 private:
  bool copy_through(std::string_view begin, std::string_view end) {
    if (text_.compare(at_, begin.size(), begin) != 0) return false;
    const std::size_t stop = text_.find(end, at_);
    const std::size_t next = stop == std::string::npos ? text_.size() : stop + end.size();
    repaired_.append(text_, at_, next - at_);
    at_ = next;
    return true;
  }
  bool is_tag_end(std::size_t at) const { return text_[at] == '>' || (text_[at] == '/' && at + 1 < text_.size() && text_[at + 1] == '>'); }
  // Nothing, a blank or the end of the tag: where a value may be over.
  bool is_gap(std::size_t at) const { return at >= text_.size() || is_blank(text_[at]) || is_tag_end(at) || text_[at] == '?'; }
  static void note(std::optional<std::size_t>& first, std::size_t at) {
    if (!first) first = at;
  }

  void copy_tag() {
    if (at_ + 1 < text_.size() && text_[at_ + 1] == '/') {
      const std::size_t end = text_.find('>', at_);
      const std::size_t next = end == std::string::npos ? text_.size() : end + 1;
      if (depth_ > 0) {
        --depth_;
        repaired_.append(text_, at_, next - at_);
      } else {
        note(stray_ends_, at_);
        for (std::size_t i = at_; i < next; ++i) repaired_ += text_[i] == '\n' ? '\n' : ' ';
      }
      at_ = next;
      return;
    }
    while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '>') repaired_ += text_[at_++];
    while (at_ < text_.size() && text_[at_] != '>') {
      if (text_[at_] == '=') {
        copy_value();
      } else {
        repaired_ += text_[at_++];
      }
    }
    if (at_ < text_.size() && text_[at_ - 1] != '/') ++depth_;
  }

  std::string_view typographic_quote_at(std::size_t at) const {
    for (std::string_view quote : typographic_quotes) {
      if (text_.compare(at, quote.size(), quote) == 0) return quote;
    }
    return {};
  }

  void copy_value() {
    repaired_ += text_[at_++];
    while (at_ < text_.size() && is_blank(text_[at_])) repaired_ += text_[at_++];
    if (at_ >= text_.size()) return;
    const char quote = text_[at_];
    if (!typographic_quote_at(at_).empty()) return copy_typographic();
    if (quote == '"' || quote == '\'') return copy_quoted(quote);
    note(without_quotes_, at_);
    repaired_ += '"';
    while (at_ < text_.size() && !is_blank(text_[at_]) && !is_tag_end(at_)) repaired_ += text_[at_++];
    repaired_ += '"';
  }

  void copy_quoted(char quote) {
    std::size_t begin = at_ + 1, end = text_.find(quote, begin);
    if (end == begin && !is_gap(begin + 1)) {
      const std::string doubled(2, quote);
      if (const std::size_t second = text_.find(doubled, begin + 1);
          second != std::string::npos && is_gap(second + 2) && text_.find('>', begin) > second) {
        note(odd_quotes_, at_);
        begin += 1;
        repaired_.append(1, quote).append(text_, begin, second - begin).append(1, quote);
        at_ = second + 2;
        return;
      }
    }
    const std::size_t next = end == std::string::npos ? text_.size() : end + 1;
    repaired_.append(text_, at_, next - at_);
    at_ = next;
    if (at_ < text_.size() && text_[at_] == quote && is_gap(at_ + 1)) note(odd_quotes_, at_++);
    if (at_ < text_.size() && !is_gap(at_)) repaired_ += ' ';
  }

  void copy_typographic() {
    note(odd_quotes_, at_);
    at_ += typographic_quote_at(at_).size();
    repaired_ += '"';
    while (at_ < text_.size() && text_[at_] != '"' && text_[at_] != '>' && typographic_quote_at(at_).empty()) repaired_ += text_[at_++];
    repaired_ += '"';
    if (at_ >= text_.size() || text_[at_] == '>') return;
    at_ += text_[at_] == '"' ? 1 : typographic_quote_at(at_).size();
    if (!is_gap(at_)) repaired_ += ' ';
  }

  const std::string& text_;
  std::string repaired_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::optional<std::size_t> without_quotes_, odd_quotes_, stray_ends_;
};

}  // namespace

RepairedText repair_xml_text(const std::string& text) { return XmlRepair(text).run(); }

}  // namespace sim
