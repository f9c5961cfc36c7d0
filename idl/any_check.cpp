// Reads every `any` that the code generated from our IDL reads. omniORB trusts the lengths and depths that come with one (4.2.5): a length
// near 2^32, a value type, or an any in an any in an any end the process that receives it. So what comes is checked while it is copied, and
// only a copy that checks out is given to omniORB. The linker puts this in the place of CORBA::Any::operator<<= (see CMakeLists.txt).
//
// Refused (MARSHAL) are value types, unions, fixed-point numbers, types that hold themselves, and more than eight anys in each other. Anys
// in interfaces of components' own are read by omniORB alone.
#include "any_check.h"

#include <omniORB4/minorCode.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

extern "C" {
void checked_any(CORBA::Any* any, cdrStream& stream) asm("__wrap__ZN5CORBA3AnylSER9cdrStream");
void omniorb_any(CORBA::Any* any, cdrStream& stream) asm("__real__ZN5CORBA3AnylSER9cdrStream");
}

namespace {

// Far beyond what anybody sends: properties are texts, references, sometimes numbers or a structure.
constexpr int max_levels = 8;  // an any in an any; omniORB's time doubles with each
constexpr int deepest_type = 16;
constexpr std::uint32_t longest_type_code = 1 << 16;  // [octets]

struct Type {
  std::uint32_t kind = CORBA::tk_null;
  std::uint32_t count = 0;      // bound, length or number of enumerators
  std::vector<Type> members{};  // of structures; the element of sequences and arrays; what an alias means
};

bool is_text(std::uint32_t kind) { return kind == CORBA::tk_string || kind == CORBA::tk_wstring; }

bool has_parameters(std::uint32_t kind, bool with_unions) {
  return (with_unions && kind == CORBA::tk_union) || kind == CORBA::tk_objref || kind == CORBA::tk_struct || kind == CORBA::tk_enum ||
         kind == CORBA::tk_alias || kind == CORBA::tk_sequence || kind == CORBA::tk_array;
}

bool is_basic(std::uint32_t kind) {
  switch (kind) {
    case CORBA::tk_short:
    case CORBA::tk_long:
    case CORBA::tk_ushort:
    case CORBA::tk_ulong:
    case CORBA::tk_float:
    case CORBA::tk_double:
    case CORBA::tk_boolean:
    case CORBA::tk_char:
    case CORBA::tk_octet:
    case CORBA::tk_any:
    case CORBA::tk_TypeCode:
    case CORBA::tk_longlong:
    case CORBA::tk_ulonglong:
    case CORBA::tk_wchar:
      return true;
    default:
      return false;  // also an indirection, which only types that hold themselves need
  }
}

[[noreturn]] void refuse(cdrStream& stream) {
  OMNIORB_THROW(MARSHAL, _OMNI_NS(MARSHAL_InvalidTypeCodeKind), static_cast<CORBA::CompletionStatus>(stream.completion()));
}

// Bytes of a discriminator's value; 0 if the type cannot be a discriminator.
std::size_t label_size(const Type& type) {
  switch (type.kind) {
    case CORBA::tk_boolean:
    case CORBA::tk_char:
    case CORBA::tk_octet:
      return 1;
    case CORBA::tk_short:
    case CORBA::tk_ushort:
      return 2;
    case CORBA::tk_long:
    case CORBA::tk_ulong:
    case CORBA::tk_enum:
      return 4;
    case CORBA::tk_longlong:
    case CORBA::tk_ulonglong:
      return 8;
    case CORBA::tk_alias:
      return label_size(type.members.front());
    default:
      return 0;
  }
}

// The parameters of a type code, an encapsulation: CORBA 3.1 part 2, 9.3.5.
class Encapsulation {
 public:
  Encapsulation(cdrStream& whole, std::span<const CORBA::Octet> octets, bool with_unions)
      : whole_(whole), octets_(octets), with_unions_(with_unions) {
    if (octets.empty()) refuse(whole);
    is_swapped_ = (octets[0] != 0) != (omni::myByteOrder != 0);
    at_ = 1;
  }

  std::uint32_t number() {
    at_ = (at_ + 3) & ~std::size_t{3};
    std::uint32_t value = 0;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return is_swapped_ ? __builtin_bswap32(value) : value;
  }
  // As omniORB wants it: what it throws for in the middle of a type code it does not free.
  void skip_text() {
    const auto text = take(number());
    if (text.empty() || text.back() != 0) refuse(whole_);
  }

  Type type(int depth) {
    if (depth > deepest_type) refuse(whole_);
    Type type{number()};
    if (is_text(type.kind))
      type.count = number();
    else if (has_parameters(type.kind, with_unions_))
      parameters(type, whole_, take(number()), depth, with_unions_);
    else if (!is_basic(type.kind))
      refuse(whole_);
    return type;
  }

  // Reads what follows the kind.
  static void parameters(Type& type, cdrStream& whole, std::span<const CORBA::Octet> octets, int depth, bool with_unions) {
    Encapsulation in(whole, octets, with_unions);
    if (type.kind != CORBA::tk_sequence && type.kind != CORBA::tk_array) {
      in.skip_text();  // repository id
      in.skip_text();  // name
    }
    switch (type.kind) {
      case CORBA::tk_struct: {
        const std::uint32_t members = in.number();
        if (members == 0) refuse(whole);  // without octets there is no end to how many there could be
        for (std::uint32_t i = 0; i < members; ++i) {
          in.skip_text();
          type.members.push_back(in.element(depth));
        }
        break;
      }
      case CORBA::tk_union:
        in.cases(type, depth);
        break;
      case CORBA::tk_enum:
        type.count = in.number();
        for (std::uint32_t i = 0; i < type.count; ++i) in.skip_text();
        break;
      case CORBA::tk_alias:
        type.members.push_back(in.element(depth));
        break;
      case CORBA::tk_sequence:
      case CORBA::tk_array:
        type.members.push_back(in.element(depth));
        type.count = in.number();
        if (type.kind == CORBA::tk_array && type.count == 0) refuse(whole);
        break;
      default:
        break;
    }
  }

 private:
  Type element(int depth) { return type(depth + 1); }

  // Reads the parts of a union: the discriminator's type, the number of the default case, and the cases with their labels.
  void cases(Type& type, int depth) {
    const std::size_t size = label_size(element(depth));
    const std::uint32_t chosen = number(), count = number();
    if (size == 0 || count == 0 || (chosen < 0xfffffffeU && chosen >= count)) refuse(whole_);
    for (std::uint32_t i = 0; i < count; ++i) {
      at_ = (at_ + size - 1) & ~(size - 1);
      take(size);
      skip_text();
      type.members.push_back(element(depth));
    }
  }

  std::span<const CORBA::Octet> take(std::size_t size) {
    if (at_ > octets_.size() || size > octets_.size() - at_) refuse(whole_);
    const auto taken = octets_.subspan(at_, size);
    at_ += size;
    return taken;
  }

  cdrStream& whole_;
  const std::span<const CORBA::Octet> octets_;
  const bool with_unions_;
  bool is_swapped_ = false;
  std::size_t at_ = 0;
};

// Everything that is read is also written.
class CheckedCopy {
 public:
  CheckedCopy(cdrStream& from, cdrStream& to, bool with_unions) : from_(from), to_(to), with_unions_(with_unions) {}

  void any(int level) {
    if (level > max_levels) refuse(from_);
    const Type type = type_code();
    if (type.kind != CORBA::tk_null && type.kind != CORBA::tk_void) value(type, level);
  }

  Type type_code() {
    Type type{number()};
    if (is_text(type.kind)) {
      type.count = number();
    } else if (has_parameters(type.kind, with_unions_)) {
      const std::uint32_t size = number();
      if (size > longest_type_code) refuse(from_);
      std::vector<CORBA::Octet> octets(size);
      from_.get_octet_array(octets.data(), static_cast<int>(size));
      to_.put_octet_array(octets.data(), static_cast<int>(size));
      Encapsulation::parameters(type, from_, octets, 1, with_unions_);
    } else if (type.kind != CORBA::tk_null && type.kind != CORBA::tk_void && !is_basic(type.kind)) {
      refuse(from_);
    }
    return type;
  }

 private:
  std::uint32_t number() {
    const CORBA::ULong value = from_.unmarshalULong();
    to_.marshalULong(value);
    return value;
  }

  void value(const Type& type, int level) {
    switch (type.kind) {
      case CORBA::tk_short:
      case CORBA::tk_ushort:
        return to_.marshalUShort(from_.unmarshalUShort());
      case CORBA::tk_long:
      case CORBA::tk_ulong:
        return to_.marshalULong(from_.unmarshalULong());
      case CORBA::tk_longlong:
      case CORBA::tk_ulonglong:
        return to_.marshalULongLong(from_.unmarshalULongLong());
      case CORBA::tk_float:
        return to_.marshalFloat(from_.unmarshalFloat());
      case CORBA::tk_double:
        return to_.marshalDouble(from_.unmarshalDouble());
      case CORBA::tk_boolean:
        return to_.marshalBoolean(from_.unmarshalBoolean());
      case CORBA::tk_octet:
        return to_.marshalOctet(from_.unmarshalOctet());
      case CORBA::tk_char:
        return to_.marshalChar(from_.unmarshalChar());
      case CORBA::tk_wchar:
        return to_.marshalWChar(from_.unmarshalWChar());
      case CORBA::tk_string: {
        const CORBA::String_var text = from_.unmarshalString(static_cast<int>(type.count));
        return to_.marshalString(text, static_cast<int>(type.count));
      }
      case CORBA::tk_wstring: {
        const CORBA::WString_var text = from_.unmarshalWString(static_cast<int>(type.count));
        return to_.marshalWString(text, static_cast<int>(type.count));
      }
      case CORBA::tk_objref: {
        const CORBA::Object_var object = CORBA::Object::_unmarshalObjRef(from_);
        return CORBA::Object::_marshalObjRef(object, to_);
      }
      case CORBA::tk_enum:
        if (number() >= type.count) refuse(from_);
        return;
      case CORBA::tk_any:
        return any(level + 1);
      case CORBA::tk_TypeCode:
        type_code();
        return;
      case CORBA::tk_alias:
        return value(type.members.front(), level);
      case CORBA::tk_struct:
        for (const Type& member : type.members) value(member, level);
        return;
      case CORBA::tk_sequence: {
        const std::uint32_t length = number();
        if (type.count != 0 && length > type.count) refuse(from_);
        return times(length, type.members.front(), level);
      }
      case CORBA::tk_array:
        return times(type.count, type.members.front(), level);
      default:
        refuse(from_);
    }
  }

  // Each takes at least an octet: a count that is no count ends with the message.
  void times(std::uint32_t count, const Type& element, int level) {
    for (std::uint32_t i = 0; i < count; ++i) value(element, level);
  }

  cdrStream& from_;
  cdrStream& to_;
  const bool with_unions_;
};

}  // namespace

void checked_any(CORBA::Any* any, cdrStream& stream) {
  cdrMemoryStream copy;
  CheckedCopy(stream, copy, false).any(1);
  omniorb_any(any, copy);
}

void copy_checked_type_code(cdrStream& from, cdrStream& to) { CheckedCopy(from, to, true).type_code(); }
