#include "coil/Properties.h"

#include <algorithm>
#include <istream>
#include <memory>
#include <ostream>
#include <utility>

#include "coil/stringutil.h"

namespace coil {
namespace {

const std::string empty_string;

constexpr std::string_view blanks = " \t\r\n\f";

std::string_view trimmed(std::string_view text) {
  auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

bool is_escaped(std::string_view text, std::size_t pos) {
  std::size_t backslashes = 0;
  while (pos > backslashes && text[pos - backslashes - 1] == '\\') ++backslashes;
  return backslashes % 2 == 1;
}

// Splits off the first step of a path; dots after a backslash belong to the name.
std::pair<std::string_view, std::string_view> first_step(std::string_view path) {
  for (auto dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.', dot + 1)) {
    if (!is_escaped(path, dot)) return {path.substr(0, dot), path.substr(dot + 1)};
  }
  return {path, {}};
}

// A value with trailing blanks removed, except an escaped one.
std::string_view without_tail_blanks(std::string_view text) {
  while (!text.empty() && blanks.find(text.back()) != std::string_view::npos && !is_escaped(text, text.size() - 1)) text.remove_suffix(1);
  return text;
}

std::pair<std::string_view, std::string_view> split_line(std::string_view line) {
  auto separator = std::string_view::npos;
  for (std::string_view candidates : {":=", " \t"}) {
    for (auto pos = line.find_first_of(candidates); pos != std::string_view::npos; pos = line.find_first_of(candidates, pos + 1)) {
      if (is_escaped(line, pos)) continue;
      separator = pos;
      break;
    }
    if (separator != std::string_view::npos) break;
  }
  if (separator == std::string_view::npos) return {line, {}};
  auto value = line.substr(separator + 1);
  auto start = value.find_first_not_of(blanks);
  value = start == std::string_view::npos ? std::string_view{} : without_tail_blanks(value.substr(start));
  return {without_tail_blanks(line.substr(0, separator)), value};
}

// Reads one logical line: joined where a line ends in a backslash, without leading blanks. False at the end of the input.
bool read_logical_line(std::istream& in, std::string& line) {
  line.clear();
  std::string part;
  bool any = false;
  while (std::getline(in, part)) {
    any = true;
    if (!part.empty() && part.back() == '\r') part.pop_back();
    auto start = part.find_first_not_of(blanks);
    part.erase(0, start == std::string::npos ? part.size() : start);
    bool is_comment = line.empty() && !part.empty() && (part[0] == '#' || part[0] == '!');
    if (!is_comment && !part.empty() && part.back() == '\\' && !is_escaped(part, part.size() - 1)) {
      line.append(part, 0, part.size() - 1);
      continue;
    }
    line += part;
    return true;
  }
  return any;
}

// What load() reads back as the same text.
std::string escaped_for_line(const std::string& text, bool is_key) {
  std::string out;
  for (char c : text) {
    if (c == '\n')
      out += "\\n";
    else if (c == '\r')
      out += "\\r";
    else if (c == '\t')
      out += "\\t";
    else if (c == '\f')
      out += "\\f";
    else {
      if (c == '"' || c == '\\' || (is_key && (c == ':' || c == '=' || c == ' '))) out += '\\';
      out += c;
    }
  }
  if (!is_key && !out.empty() && out.front() == ' ') out.insert(0, 1, '\\');
  if (!is_key && out.size() > 1 && out.back() == ' ') out.insert(out.size() - 1, 1, '\\');
  return out;
}

}  // namespace

Properties::Properties(const char* key, const char* value) : name_(key ? key : ""), value_(value ? value : "") {}

Properties::Properties(const std::string& key, const std::string& value) : name_(key), value_(value) {}

Properties::Properties(const std::map<std::string, std::string>& defaults) {
  for (const auto& [key, value] : defaults) setDefault(key, value);
}

Properties::Properties(const char* const* defaults, long count) { setDefaults(defaults, count); }

Properties::Properties(const Properties& other) : Properties(other, WithoutChildren{}) { copy_descendants(other); }

Properties::Properties(const Properties& other, WithoutChildren)
    : name_(other.name_), value_(other.value_), default_value_(other.default_value_) {}

Properties::Properties(Properties&& other) noexcept
    : name_(std::move(other.name_)), value_(std::move(other.value_)), default_value_(std::move(other.default_value_)) {
  adopt_children(other);
}

Properties& Properties::operator=(const Properties& other) {
  if (this == &other) return *this;
  return *this = Properties(other);  // By way of a copy: the other may be a node below this one.
}

Properties& Properties::operator=(Properties&& other) noexcept {
  if (this == &other) return *this;
  Properties taken(std::move(other));
  clear();
  if (root_ == nullptr) name_ = std::move(taken.name_);
  value_ = std::move(taken.value_);
  default_value_ = std::move(taken.default_value_);
  adopt_children(taken);
  return *this;
}

Properties::~Properties() { clear(); }

const std::string& Properties::getProperty(const std::string& key) const {
  const Properties* node = find(key);
  if (node == nullptr) return empty_string;
  return node->value_.empty() ? node->default_value_ : node->value_;
}

std::string Properties::getProperty(const std::string& key, const std::string& def) const {
  const Properties* node = find(key);
  return node == nullptr || node->value_.empty() ? def : node->value_;
}

std::string& Properties::operator[](const std::string& key) {
  Properties& node = make(key);
  if (node.value_.empty()) node.value_ = node.default_value_;
  return node.value_;
}

const std::string& Properties::getDefault(const std::string& key) const {
  const Properties* node = find(key);
  return node == nullptr ? empty_string : node->default_value_;
}

std::string Properties::setProperty(const std::string& key, const std::string& value) { return std::exchange(make(key).value_, value); }

std::string Properties::setDefault(const std::string& key, const std::string& value) {
  return std::exchange(make(key).default_value_, value);
}

void Properties::setDefaults(const char* const* defaults, long count) {
  if (defaults == nullptr) return;
  for (long i = 0; i + 1 < count && defaults[i] != nullptr && defaults[i][0] != '\0'; i += 2) {
    if (defaults[i + 1] == nullptr) return;
    setDefault(std::string(trimmed(defaults[i])), std::string(trimmed(defaults[i + 1])));
  }
}

void Properties::load(std::istream& in) {
  std::string line;
  while (read_logical_line(in, line)) {
    if (line.empty() || line[0] == '#' || line[0] == '!') continue;
    auto [key, value] = split_line(line);
    if (!key.empty()) setProperty(unescape(std::string(key)), unescape(std::string(value)));
  }
}

void Properties::store(std::ostream& out, const std::string& header) const {
  if (!header.empty()) out << "# " << header << '\n';
  for (const std::string& name : propertyNames()) {
    out << escaped_for_line(name, true) << ": " << escaped_for_line(getProperty(name), false) << '\n';
  }
}

// Every descendant, parents before children, in order; without recursion, since names from peers decide how deep a tree is.
template <class Visit>
void Properties::walk(Visit visit) const {
  struct Level {
    const Properties* node;
    std::size_t next_child;
  };
  std::vector<Level> way{{this, 0}};
  while (!way.empty()) {
    if (way.back().next_child == way.back().node->leaf_.size()) {
      way.pop_back();
      continue;
    }
    const Properties* node = way.back().node->leaf_[way.back().next_child++];
    visit(*node, way.size() - 1);
    way.push_back({node, 0});
  }
}

std::vector<std::string> Properties::propertyNames() const {
  std::vector<std::string> names;
  std::string path;
  std::vector<std::size_t> parents;  // the length of `path` up to each node on the way
  walk([&](const Properties& node, std::size_t depth) {
    parents.resize(depth);
    path.resize(depth == 0 ? 0 : parents.back());
    if (depth > 0) path += '.';
    path += node.name_;
    parents.push_back(path.size());
    if (node.leaf_.empty() || !node.value_.empty() || !node.default_value_.empty()) names.push_back(path);
  });
  return names;
}

int Properties::size() const { return static_cast<int>(propertyNames().size()); }

Properties* Properties::findNode(const std::string& key) const {
  if (key.empty()) return nullptr;
  return const_cast<Properties*>(find(key));  // The classic signature hands out children of a const tree.
}

Properties& Properties::getNode(const std::string& key) { return make(key); }

bool Properties::createNode(const std::string& key) {
  if (key.empty() || find(key) != nullptr) return false;
  make(key);
  return true;
}

Properties* Properties::removeNode(const std::string& leaf_name) {
  auto it = std::find_if(leaf_.begin(), leaf_.end(), [&](const Properties* node) { return node->name_ == leaf_name; });
  if (it == leaf_.end()) return nullptr;
  Properties* node = *it;
  leaf_.erase(it);
  if (index_) index_->erase(leaf_name);
  node->root_ = nullptr;
  return node;
}

Properties* Properties::hasKey(const std::string& key) const { return child(key); }

void Properties::clear() {
  index_.reset();
  auto doomed = std::exchange(leaf_, {});
  while (!doomed.empty()) {
    const std::unique_ptr<Properties> node(doomed.back());
    doomed.pop_back();
    doomed.insert(doomed.end(), node->leaf_.begin(), node->leaf_.end());
    node->index_.reset();
    node->leaf_.clear();
  }
}

Properties& Properties::operator<<(const Properties& other) {
  if (this == &other) return *this;
  const Properties source(other);
  for (const std::string& name : source.propertyNames()) make(name).value_ = source.getProperty(name);
  return *this;
}

Properties* Properties::child(std::string_view name) const {
  if (index_) {
    const auto found = index_->find(name);
    return found == index_->end() ? nullptr : found->second;
  }
  for (Properties* node : leaf_) {
    if (node->name_ == name) return node;
  }
  return nullptr;
}

const Properties* Properties::find(std::string_view path) const {
  const Properties* node = this;
  while (node != nullptr && !path.empty()) {
    auto [step, rest] = first_step(path);
    node = node->child(step);
    path = rest;
  }
  return node;
}

Properties& Properties::make(std::string_view path) {
  Properties* node = this;
  while (!path.empty()) {
    auto [step, rest] = first_step(path);
    Properties* next = node->child(step);
    if (next == nullptr) {
      auto made = std::make_unique<Properties>(std::string(step));
      made->root_ = node;
      next = made.get();
      node->add_child(made.release());
    }
    node = next;
    path = rest;
  }
  return *node;
}

void Properties::add_child(Properties* node) {
  constexpr std::size_t many = 32;
  leaf_.push_back(node);
  if (!index_ && leaf_.size() > many) {
    index_ = std::make_unique<Index>();
    for (Properties* known : leaf_) index_->emplace(known->name_, known);
  } else if (index_) {
    index_->emplace(node->name_, node);
  }
}

void Properties::copy_descendants(const Properties& other) {
  std::vector<std::pair<const Properties*, Properties*>> open{{&other, this}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    to->leaf_.reserve(from->leaf_.size());
    for (const Properties* node : from->leaf_) {
      std::unique_ptr<Properties> copy(new Properties(*node, WithoutChildren{}));
      copy->root_ = to;
      to->add_child(copy.get());
      open.emplace_back(node, copy.release());
    }
  }
}

void Properties::adopt_children(Properties& other) noexcept {
  leaf_ = std::exchange(other.leaf_, {});
  index_ = std::move(other.index_);
  for (Properties* node : leaf_) node->root_ = this;
}

void Properties::list(std::ostream& out) const {
  constexpr std::size_t deepest_indent = 40;  // a tree of any depth is printed in proportion to its size
  walk([&](const Properties& node, std::size_t depth) {
    const std::string& value = node.value_.empty() ? node.default_value_ : node.value_;
    out << std::string(2 * std::min(depth, deepest_indent), ' ') << "- " << node.name_;
    if (!value.empty()) out << ": " << value;
    out << '\n';
  });
}

std::ostream& operator<<(std::ostream& out, const Properties& properties) {
  properties.list(out);
  return out;
}

}  // namespace coil
