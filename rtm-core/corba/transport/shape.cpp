#include "corba/transport/shape.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace corba {
namespace {

// Types that hold themselves end here.
constexpr int deepest = 32;

}  // namespace

// Where in the octets, and what was found so far.
class Shape::Walk {
 public:
  Walk(std::span<const std::byte> octets, rt::ByteOrder order) : octets_(octets), order_(order) {}
  // One that clears leftovers.
  Walk(std::span<std::byte> octets, rt::ByteOrder order) : octets_(octets), order_(order), cleared_(octets.data()) {}

  // False once nothing more can be said: is_wrong() tells why.
  bool pass(const Node& node) {
    switch (node.kind) {
      case Kind::number:
        return skip(node.size, 1);
      case Kind::enumeration:
        return pass_enumerator(node);
      case Kind::text:
        return pass_text(node);
      case Kind::sequence:
        return pass_sequence(node);
      case Kind::array:
        return node.size ? skip(node.size, node.count) : pass_times(node.members.front(), node.count);
      case Kind::structure:
        return node.size ? skip(node.size, node.count) : std::ranges::all_of(node.members, [this](const Node& one) { return pass(one); });
      case Kind::unknown:
        break;
    }
    return false;
  }
  bool is_wrong() const { return is_wrong_; }
  bool has_leftovers() const { return has_leftovers_; }

 private:
  bool wrong() {
    is_wrong_ = true;
    return false;
  }

  bool skip(std::size_t size, std::uint64_t count) {
    if (count == 0) return true;
    const std::size_t start = (at_ + size - 1) / size * size;
    if (start > octets_.size() || (octets_.size() - start) / size < count) return wrong();
    for (; at_ < start; ++at_) {
      has_leftovers_ = has_leftovers_ || octets_[at_] != std::byte{0};
      if (cleared_) cleared_[at_] = std::byte{0};
    }
    at_ = start + size * count;
    return true;
  }

  bool read(std::uint32_t& number) {
    if (!skip(sizeof number, 1)) return false;
    std::memcpy(&number, octets_.data() + at_ - sizeof number, sizeof number);
    if ((order_ == rt::ByteOrder::little) != (std::endian::native == std::endian::little)) number = __builtin_bswap32(number);
    return true;
  }

  bool pass_enumerator(const Node& node) {
    std::uint32_t number = 0;
    return read(number) && (number < node.count || wrong());
  }

  bool pass_text(const Node& node) {
    std::uint32_t length = 0;  // with the zero at the end
    if (!read(length)) return false;
    return node.count && length > node.count + 1 ? wrong() : skip(1, length);
  }

  bool pass_sequence(const Node& node) {
    std::uint32_t length = 0;
    if (!read(length)) return false;
    if (node.count && length > node.count) return wrong();
    const Node& element = node.members.front();
    return element.size ? skip(element.size, length * element.count) : pass_times(element, length);
  }

  // Each element takes at least an octet, so a count that is no count ends soon.
  bool pass_times(const Node& element, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i)
      if (!pass(element)) return false;
    return true;
  }

  const std::span<const std::byte> octets_;
  const rt::ByteOrder order_;
  std::byte* const cleared_ = nullptr;
  std::size_t at_ = 0;
  bool is_wrong_ = false;
  bool has_leftovers_ = false;
};

Shape::Node Shape::compile(CORBA::TypeCode_ptr code, int depth) {
  if (depth > deepest) return {};
  const auto number = [](std::uint8_t size) { return Node{Kind::number, size, 1}; };
  switch (code->kind()) {
    case CORBA::tk_boolean:
    case CORBA::tk_char:
    case CORBA::tk_octet:
      return number(1);
    case CORBA::tk_short:
    case CORBA::tk_ushort:
      return number(2);
    case CORBA::tk_long:
    case CORBA::tk_ulong:
    case CORBA::tk_float:
      return number(4);
    case CORBA::tk_longlong:
    case CORBA::tk_ulonglong:
    case CORBA::tk_double:
      return number(8);
    case CORBA::tk_enum:
      return {Kind::enumeration, 0, code->member_count()};
    case CORBA::tk_string:
      return {Kind::text, 0, code->length()};
    case CORBA::tk_alias: {
      const CORBA::TypeCode_var content = code->content_type();
      return compile(content, depth + 1);
    }
    case CORBA::tk_sequence:
    case CORBA::tk_array: {
      const CORBA::TypeCode_var content = code->content_type();
      Node element = compile(content, depth + 1);
      Node node{code->kind() == CORBA::tk_array ? Kind::array : Kind::sequence, 0, code->length()};
      if (node.kind == Kind::array && element.size) {
        node.size = element.size;
        node.count *= element.count;
      }
      node.members.push_back(std::move(element));
      return node;
    }
    case CORBA::tk_struct: {
      Node node{Kind::structure};
      for (CORBA::ULong i = 0; i < code->member_count(); ++i) {
        const CORBA::TypeCode_var member = code->member_type(i);
        node.members.push_back(compile(member, depth + 1));
        node.count += node.members.back().count;
      }
      const std::uint8_t size = node.members.empty() ? 0 : node.members.front().size;
      if (size && std::ranges::all_of(node.members, [size](const Node& one) { return one.size == size; })) node.size = size;
      return node;
    }
    default:
      return {};
  }
}

// With the most octets that may be needed before each part to align it.
std::optional<std::uint64_t> Shape::max_octets(const Node& node) {
  constexpr std::uint64_t number = 4 + 3;  // a length, an enumerator
  constexpr std::uint64_t too_many = std::uint64_t{1} << 31;
  std::uint64_t sum = 0;
  switch (node.kind) {
    case Kind::enumeration:
      return number;
    case Kind::text:
      return node.count ? std::optional(number + node.count + 1) : std::nullopt;
    case Kind::number:
      return 2 * std::uint64_t{node.size};
    case Kind::array:
    case Kind::sequence:
    case Kind::structure:
      break;
    case Kind::unknown:
      return std::nullopt;
  }
  if (node.kind == Kind::sequence && node.count == 0) return std::nullopt;
  for (const Node& member : node.members) {
    const auto most = max_octets(member);
    if (!most || *most > too_many) return std::nullopt;
    sum += *most;
  }
  if (node.kind == Kind::structure) return sum;
  if (node.size) return node.size * (node.count + 1);
  return node.count < too_many ? std::optional(number + sum * node.count) : std::nullopt;
}

Shape::Shape(CORBA::TypeCode_ptr code) : root_(compile(code, 0)) {}

bool Shape::fits(std::span<const std::byte> octets, rt::ByteOrder order, bool* has_leftovers) const {
  Walk walk(octets, order);
  walk.pass(root_);
  if (has_leftovers) *has_leftovers = walk.has_leftovers();
  return !walk.is_wrong();
}

void Shape::clear_leftovers(std::span<std::byte> octets, rt::ByteOrder order) const { Walk(octets, order).pass(root_); }

}  // namespace corba
