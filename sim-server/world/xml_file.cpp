#include "world/xml_file.h"

#include <algorithm>
#include <vector>

#include "base/plain_file.h"
#include "base/text.h"
#include "world/xml_repair.h"

namespace sim {

namespace {

constexpr std::uintmax_t max_bytes = 64U << 20U;
constexpr int max_depth = 100;
constexpr std::size_t max_elements = 400000;
constexpr std::size_t max_attributes = 1000;  // of one element; they are found by walking through them

class LineTable {
 public:
  explicit LineTable(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') ends_.push_back(i);
    }
  }
  int line_at(std::size_t offset) const {
    return static_cast<int>(std::lower_bound(ends_.begin(), ends_.end(), offset) - ends_.begin()) + 1;
  }

 private:
  std::vector<std::size_t> ends_;
};

// Marks every element with its line; the error when there are too many or they are nested too deep.
base::Result<void> mark_lines(pugi::xml_document& document, const LineTable& lines, const std::string& file_name, int file) {
  int depth = 0;
  std::size_t elements = 0;
  pugi::xml_node node = document.first_child();
  while (node) {
    if (node.type() == pugi::node_element) {
      if (++elements > max_elements) return base::Error{file_name + ": has more than " + std::to_string(max_elements) + " elements"};
      const int line = lines.line_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)));
      if (static_cast<std::size_t>(std::distance(node.attributes_begin(), node.attributes_end())) > max_attributes) {
        return base::Error{file_name + ":" + std::to_string(line) + ": " + describe(node) + " has more than " +
                           std::to_string(max_attributes) + " attributes"};
      }
      node.remove_attribute(line_mark);
      node.remove_attribute(file_mark);
      node.append_attribute(line_mark) = line;
      if (depth == 0) node.append_attribute(file_mark) = file;
      if (depth >= max_depth) {
        return base::Error{file_name + ":" + std::to_string(line) + ": elements are nested deeper than " + std::to_string(max_depth)};
      }
    }
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    node = node.next_sibling();
  }
  return {};
}

void append_escaped(std::string& out, std::string_view text) {
  for (char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  }
}

void append_xml(std::string& out, pugi::xml_node node, bool with_marks) {
  if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
    append_escaped(out, base::trim(node.value()));
    return;
  }
  if (node.type() != pugi::node_element) return;
  out.append("<").append(node.name());
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const std::string_view name = attribute.name();
    if (!with_marks && (name == line_mark || name == file_mark)) continue;
    out.append(" ").append(name).append("=\"");
    append_escaped(out, attribute.value());
    out += '"';
  }
  if (!node.first_child()) {
    out += "/>";
    return;
  }
  out += '>';
  for (const pugi::xml_node& child : node.children()) append_xml(out, child, with_marks);
  out.append("</").append(node.name()).append(">");
}

// Whether the start of what is no XML has more bytes than a slip of the hand that no text has, in 8 bits a character or in more.
bool is_binary(std::string_view text) {
  constexpr std::size_t looked_at = 4096;
  const std::string_view start = text.substr(0, looked_at);
  const auto zeros = static_cast<std::size_t>(std::count(start.begin(), start.end(), '\0'));
  const auto controls = static_cast<std::size_t>(
      std::count_if(start.begin(), start.end(), [](char c) { return static_cast<unsigned char>(c) < 32 && (c < 9 || c > 13); }));
  const std::size_t first = start.find_first_not_of(std::string_view("\0\xff\xfe", 3));
  const bool is_wide = first < 4 && start[first] == '<' && zeros * 3 > start.size();
  return !is_wide && (zeros > 0 || controls * 50 > start.size());
}

}  // namespace

bool is_lfs_pointer(std::string_view text) { return text.starts_with("version https://git-lfs."); }

bool is_lfs_pointer_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t most = 4096;  // pointers are shorter than that
  std::error_code problem;
  if (std::filesystem::file_size(path, problem) > most || problem) return false;
  const auto start = base::read_plain_file(path, most);
  return start && is_lfs_pointer(*start);
}

base::Result<std::string> read_file(const std::filesystem::path& path) {
  auto text = base::read_plain_file(path, max_bytes);
  if (!text) return base::Error{path.string() + ": " + text.error().message};
  return text;
}

base::Result<pugi::xml_document> parse_xml(const std::string& text, const std::string& file_name, Complaints& complaints) {
  const int file = complaints.add_file(file_name);
  if (text.size() > max_bytes) return base::Error{file_name + ": a text of at most 64 MiB is expected"};
  if (base::trim(text).empty()) return base::Error{file_name + ": is empty"};
  if (is_lfs_pointer(text)) return base::Error{file_name + ": " + std::string(lfs_pointer_fault)};
  // Other encodings (a byte order mark of UTF-16) are left to the parser; lines are then only near.
  const bool is_bytes = text.find('\0') == std::string::npos;
  pugi::xml_document document;
  pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, is_bytes ? pugi::encoding_utf8 : pugi::encoding_auto);
  if (parsed.status == pugi::status_out_of_memory) return base::Error{file_name + ": is too large for the memory"};
  LineTable lines(text);
  if (!parsed && is_bytes) {
    const RepairedText repaired = repair_xml_text(text);
    if (!repaired.changes.empty()) {
      parsed = document.load_buffer(repaired.text.data(), repaired.text.size(), pugi::parse_default, pugi::encoding_utf8);
      lines = LineTable(repaired.text);
      for (const RepairedText::Change& change : repaired.changes) {
        if (parsed) complaints.add(Finding::Severity::warning, {file_name, LineTable(text).line_at(change.offset)}, change.message);
      }
    }
  }
  if (!parsed) {
    if (is_binary(text)) return base::Error{file_name + ": is a binary file; SDFormat is text (XML)"};
    if (const std::size_t code = text.find("<%"); code != std::string::npos) {
      return base::Error{file_name + ":" + std::to_string(LineTable(text).line_at(code)) +
                         ": is an ERB template (<% ... %>); run erb first"};
    }
    return base::Error{file_name + ":" +
                       std::to_string(lines.line_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)))) +
                       ": is not well-formed XML: " + base::to_lower(parsed.description())};
  }
  if (text.find("<!DOCTYPE") != std::string::npos && text.find("<!ENTITY") != std::string::npos) {
    complaints.add(Finding::Severity::warning, {file_name, lines.line_at(text.find("<!ENTITY"))},
                   "entities of the document type are not expanded");
  }
  if (base::Result<void> marked = mark_lines(document, lines, file_name, file); !marked) return marked.error();
  return document;
}

std::string to_xml(pugi::xml_node node, bool with_marks) {
  std::string out;
  append_xml(out, node, with_marks);
  return out;
}

pugi::xml_node child_at(pugi::xml_node node, std::string_view path) {
  while (node && !path.empty()) {
    const std::size_t slash = path.find('/');
    const std::string name(path.substr(0, slash));
    node = node.child(name.c_str());
    path = slash == std::string_view::npos ? std::string_view{} : path.substr(slash + 1);
  }
  return node;
}

std::string text_of(pugi::xml_node node) { return std::string(base::trim(node.child_value())); }

}  // namespace sim
