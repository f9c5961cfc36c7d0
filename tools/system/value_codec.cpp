#include "system/value_codec.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "system/value_failure.h"

namespace tools {

CORBA::TypeCode_var resolved(CORBA::TypeCode_ptr type) {
  CORBA::TypeCode_var current = CORBA::TypeCode::_duplicate(type);
  while (current->kind() == CORBA::tk_alias) current = current->content_type();
  return current;
}

namespace {

using base::Error;
using base::Result;
using Json = nlohmann::ordered_json;

std::string from_utf16(std::span<const unsigned char> bytes) {
  bool little = false;
  if (bytes.size() >= 2 && ((bytes[0] == 0xff && bytes[1] == 0xfe) || (bytes[0] == 0xfe && bytes[1] == 0xff))) {
    little = bytes[0] == 0xff;
    bytes = bytes.subspan(2);
  }
  std::string text;
  const auto unit = [&](std::size_t i) {
    return static_cast<std::uint32_t>(little ? bytes[i] | (bytes[i + 1] << 8) : (bytes[i] << 8) | bytes[i + 1]);
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    auto code = unit(i);
    if (code >= 0xd800 && code < 0xdc00 && i + 3 < bytes.size()) {
      code = 0x10000 + ((code - 0xd800) << 10) + (unit(i + 2) - 0xdc00);
      i += 2;
    }
    if (code >= 0xd800 && code < 0xe000) code = 0xfffd;  // half of a pair
    if (code < 0x80) {
      text += static_cast<char>(code);
    } else if (code < 0x800) {
      text += {static_cast<char>(0xc0 | (code >> 6)), static_cast<char>(0x80 | (code & 0x3f))};
    } else if (code < 0x10000) {
      text +=
          {static_cast<char>(0xe0 | (code >> 12)), static_cast<char>(0x80 | ((code >> 6) & 0x3f)), static_cast<char>(0x80 | (code & 0x3f))};
    } else {
      text += {static_cast<char>(0xf0 | ((code >> 18) & 7)), static_cast<char>(0x80 | ((code >> 12) & 0x3f)),
               static_cast<char>(0x80 | ((code >> 6) & 0x3f)), static_cast<char>(0x80 | (code & 0x3f))};
    }
  }
  return text;
}

// `text` is valid UTF-8: the JSON parser has seen to it.
std::u16string to_utf16(const std::string& text) {
  std::u16string units;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    std::uint32_t code = length == 1 ? lead : lead & (0x7fu >> length);
    for (std::size_t n = 1; n < length && i + n < text.size(); ++n) code = (code << 6) | (static_cast<unsigned char>(text[i + n]) & 0x3f);
    i += length;
    if (code >= 0x10000) {
      units.push_back(static_cast<char16_t>(0xd800 + ((code - 0x10000) >> 10)));
      code = 0xdc00 + ((code - 0x10000) & 0x3ff);
    }
    units.push_back(static_cast<char16_t>(code));
  }
  return units;
}

class Reader {
 public:
  Reader(std::span<const unsigned char> bytes, bool little_endian, std::size_t max_values)
      : bytes_(bytes),
        max_values_(max_values),
        values_left_(max_values),
        swap_(little_endian != (std::endian::native == std::endian::little)) {}

  Json read(CORBA::TypeCode_ptr declared) {
    const auto type = resolved(declared);
    switch (type->kind()) {
      case CORBA::tk_short:
        return number<std::int16_t>();
      case CORBA::tk_ushort:
        return number<std::uint16_t>();
      case CORBA::tk_long:
        return number<std::int32_t>();
      case CORBA::tk_ulong:
        return number<std::uint32_t>();
      case CORBA::tk_longlong:
        return number<std::int64_t>();
      case CORBA::tk_ulonglong:
        return number<std::uint64_t>();
      case CORBA::tk_float:
        return number<float>();
      case CORBA::tk_double:
        return number<double>();
      case CORBA::tk_boolean:
        return number<std::uint8_t>() != 0;
      case CORBA::tk_octet:
        return number<std::uint8_t>();
      case CORBA::tk_char:
        return std::string(1, static_cast<char>(number<std::uint8_t>()));
      case CORBA::tk_wchar:
        return wide_character();
      case CORBA::tk_string:
        return string();
      case CORBA::tk_wstring:
        return wide_string();
      case CORBA::tk_enum:
        return enumerator(type);
      case CORBA::tk_struct:
        return structure(type);
      case CORBA::tk_sequence:
        return elements(type, number<std::uint32_t>());
      case CORBA::tk_array:
        return elements(type, type->length());
      default:
        throw ValueFailure{"holds a kind of value that data ports do not carry"};
    }
  }

 private:
  template <class T>
  T number() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    need(sizeof(T));
    unsigned char raw[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) raw[swap_ ? sizeof(T) - 1 - i : i] = bytes_[at_ + i];
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }
  void need(std::size_t count) const {
    if (at_ > bytes_.size() || count > bytes_.size() - at_) throw ValueFailure{"is cut short at octet " + std::to_string(bytes_.size())};
  }
  std::string string() {
    const auto length = number<std::uint32_t>();
    need(length);
    if (length == 0) return "";
    std::string text(reinterpret_cast<const char*>(bytes_.data()) + at_, length - 1);
    at_ += length;
    return text;
  }
  // GIOP 1.2: octets of UTF-16, big-endian unless a byte order mark says otherwise.
  Json wide(std::uint32_t octets) {
    need(octets);
    const auto bytes = bytes_.subspan(at_, octets);
    at_ += octets;
    return from_utf16(bytes);
  }
  Json wide_character() { return wide(number<std::uint8_t>()); }
  Json wide_string() { return wide(number<std::uint32_t>()); }
  Json enumerator(CORBA::TypeCode_ptr type) {
    const auto value = number<std::uint32_t>();
    if (value >= type->member_count())
      throw ValueFailure{"holds " + std::to_string(value) + " where an enumerator of " + type->name() + " was expected"};
    return std::string(type->member_name(value));
  }
  Json structure(CORBA::TypeCode_ptr type) {
    constexpr std::size_t of_structure = 2, of_member = 3;  // beside the values of the members
    charge(of_structure + of_member * type->member_count());
    Json object = Json::object();
    for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
      const CORBA::TypeCode_var member = type->member_type(i);
      object[type->member_name(i)] = read(member);
    }
    return object;
  }
  Json elements(CORBA::TypeCode_ptr type, std::uint32_t count) {
    if (count > bytes_.size() - std::min(at_, bytes_.size()))
      throw ValueFailure{"announces " + std::to_string(count) + " elements and is shorter"};
    const CORBA::TypeCode_var content = type->content_type();
    charge(count);
    Json array = Json::array();
    array.get_ref<Json::array_t&>().reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) array.push_back(read(content));
    return array;
  }
  void charge(std::size_t values) {
    if (values > values_left_) throw ValueFailure{"has more than " + std::to_string(max_values_) + " values"};
    values_left_ -= values;
  }

  std::span<const unsigned char> bytes_;
  const std::size_t max_values_;
  std::size_t values_left_;
  std::size_t at_ = 0;
  bool swap_;
};

class Writer {
 public:
  explicit Writer(bool little_endian) : swap_(little_endian != (std::endian::native == std::endian::little)) {}

  void write(CORBA::TypeCode_ptr declared, const Json& value, const std::string& where) {
    const auto type = resolved(declared);
    switch (type->kind()) {
      case CORBA::tk_short:
        return integer<std::int16_t>(value, where);
      case CORBA::tk_ushort:
        return integer<std::uint16_t>(value, where);
      case CORBA::tk_long:
        return integer<std::int32_t>(value, where);
      case CORBA::tk_ulong:
        return integer<std::uint32_t>(value, where);
      case CORBA::tk_longlong:
        return integer<std::int64_t>(value, where);
      case CORBA::tk_ulonglong:
        return integer<std::uint64_t>(value, where);
      case CORBA::tk_octet:
        return integer<std::uint8_t>(value, where);
      case CORBA::tk_float:
        return put(single(value, where));
      case CORBA::tk_double:
        return put(real(value, where));
      case CORBA::tk_boolean:
        return boolean(value, where);
      case CORBA::tk_char:
        return character(value, where);
      case CORBA::tk_wchar:
        return wide_character(value, where);
      case CORBA::tk_string:
        return string(value, where);
      case CORBA::tk_wstring:
        return wide_string(value, where);
      case CORBA::tk_enum:
        return enumerator(type, value, where);
      case CORBA::tk_struct:
        return structure(type, value, where);
      case CORBA::tk_sequence:
        return elements(type, value, where, true);
      case CORBA::tk_array:
        return elements(type, value, where, false);
      default:
        throw ValueFailure{where + ": is of a kind that data ports do not carry"};
    }
  }
  std::vector<unsigned char> take() { return std::move(bytes_); }

 private:
  [[noreturn]] static void refuse(const std::string& where, const std::string& expected, const Json& value) {
    throw ValueFailure{where + ": must be " + expected + ", got " + base::in_quotes(value.dump())};
  }
  template <class T>
  void put(T value) {
    bytes_.resize((bytes_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    unsigned char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(raw[swap_ ? sizeof(T) - 1 - i : i]);
  }
  template <class T>
  void integer(const Json& value, const std::string& where) {
    const auto expected =
        "an integer from " + std::to_string(std::numeric_limits<T>::min()) + " to " + std::to_string(std::numeric_limits<T>::max());
    if (value.is_null()) return put(T{0});
    if (value.is_number_unsigned()) {
      const auto number = value.get<std::uint64_t>();
      if (number > static_cast<std::uint64_t>(std::numeric_limits<T>::max())) refuse(where, expected, value);
      return put(static_cast<T>(number));
    }
    if (!value.is_number_integer()) refuse(where, expected, value);
    const auto number = value.get<std::int64_t>();
    if (number < 0 && (!std::is_signed_v<T> || number < static_cast<std::int64_t>(std::numeric_limits<T>::min())))
      refuse(where, expected, value);
    put(static_cast<T>(number));
  }
  static double real(const Json& value, const std::string& where) {
    if (value.is_null()) return 0;
    if (!value.is_number()) refuse(where, "a number", value);
    return value.get<double>();
  }
  static float single(const Json& value, const std::string& where) {
    const double number = real(value, where);
    if (std::abs(number) > std::numeric_limits<float>::max()) refuse(where, "a number of at most 3.4e38", value);
    return static_cast<float>(number);
  }
  void boolean(const Json& value, const std::string& where) {
    if (value.is_null()) return put(std::uint8_t{0});
    if (value.is_boolean()) return put(static_cast<std::uint8_t>(value.get<bool>()));
    if (value.is_number_integer() && (value == 0 || value == 1)) return put(value.get<std::uint8_t>());
    refuse(where, "true or false", value);
  }
  void character(const Json& value, const std::string& where) {
    if (value.is_null()) return put(std::uint8_t{0});
    if (!value.is_string() || value.get_ref<const std::string&>().size() != 1) refuse(where, "one character", value);
    put(static_cast<std::uint8_t>(value.get_ref<const std::string&>()[0]));
  }
  void string(const Json& value, const std::string& where) {
    if (!value.is_null() && !value.is_string()) refuse(where, "a string", value);
    const auto text = value.is_null() ? std::string() : value.get<std::string>();
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  std::u16string wide(const Json& value, const std::string& where) {
    if (!value.is_null() && !value.is_string()) refuse(where, "a string", value);
    return value.is_null() ? std::u16string() : to_utf16(value.get<std::string>());
  }
  void wide_character(const Json& value, const std::string& where) {
    auto units = wide(value, where);
    if (units.empty()) units.push_back(0);
    if (units.size() != 1) refuse(where, "one character of 16 bits", value);
    put(std::uint8_t{2});
    bytes_.push_back(static_cast<unsigned char>(units[0] >> 8));
    bytes_.push_back(static_cast<unsigned char>(units[0]));
  }
  void wide_string(const Json& value, const std::string& where) {
    const auto units = wide(value, where);
    put(static_cast<std::uint32_t>(units.empty() ? 0 : 2 * units.size() + 2));
    if (!units.empty()) bytes_.insert(bytes_.end(), {0xff, 0xfe});  // byte order mark: little-endian
    for (const auto unit : units) {
      bytes_.push_back(static_cast<unsigned char>(unit));
      bytes_.push_back(static_cast<unsigned char>(unit >> 8));
    }
  }
  void enumerator(CORBA::TypeCode_ptr type, const Json& value, const std::string& where) {
    if (value.is_null()) return put(std::uint32_t{0});
    std::vector<std::string> names;
    for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
      names.emplace_back(type->member_name(i));
      if (value.is_string() ? value == names.back() : value.is_number_unsigned() && value == i) return put(static_cast<std::uint32_t>(i));
    }
    refuse(where, "one of " + base::join(names, ", "), value);
  }
  void structure(CORBA::TypeCode_ptr type, const Json& value, const std::string& where) {
    if (!value.is_null() && !value.is_object()) refuse(where, std::string("an object with the members of ") + type->name(), value);
    std::size_t used = 0;
    for (CORBA::ULong i = 0; i < type->member_count(); ++i) {
      const std::string name = type->member_name(i);
      const CORBA::TypeCode_var member = type->member_type(i);
      const bool given = value.is_object() && value.contains(name);
      used += given;
      write(member, given ? value[name] : Json(), where.empty() ? name : where + "." + name);
    }
    if (!value.is_object() || used == value.size()) return;
    for (const auto& [key, unused] : value.items()) {
      bool known = false;
      for (CORBA::ULong i = 0; i < type->member_count(); ++i) known = known || key == type->member_name(i);
      if (!known)
        throw ValueFailure{(where.empty() ? "" : where + ": ") + std::string(type->name()) + " has no member " + base::in_quotes(key)};
    }
  }
  void elements(CORBA::TypeCode_ptr type, const Json& value, const std::string& where, bool is_sequence) {
    if (!value.is_null() && !value.is_array()) refuse(where, "an array", value);
    const CORBA::TypeCode_var content = type->content_type();
    const std::size_t count = is_sequence ? value.size() : type->length();
    if (!is_sequence && !value.is_null() && value.size() != count) refuse(where, "an array of " + std::to_string(count), value);
    if (is_sequence) put(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) write(content, value.is_null() ? Json() : value[i], where + "[" + std::to_string(i) + "]");
  }

  std::vector<unsigned char> bytes_;
  bool swap_;
};

}  // namespace

Result<Json> decode(CORBA::TypeCode_ptr type, std::span<const unsigned char> payload, bool little_endian, std::size_t max_values) {
  try {
    return Reader(payload, little_endian, max_values).read(type);
  } catch (const ValueFailure& failure) {
    return Error{std::string("payload of ") + type->id() + " " + failure.message};
  }
}

Result<std::vector<unsigned char>> encode(CORBA::TypeCode_ptr type, const Json& value, bool little_endian) {
  try {
    Writer writer(little_endian);
    writer.write(type, value, "");
    return writer.take();
  } catch (const ValueFailure& failure) {
    return Error{std::string("value for ") + type->id() + ": " + failure.message};
  }
}

std::string member_problem(const std::string& repository_id, const std::vector<std::string>& path) {
  constexpr const char* nothing = "no more";
  const auto type = type_code_of(repository_id);
  if (CORBA::is_nil(type)) return "";
  CORBA::TypeCode_var at = resolved(type);
  std::string way;
  for (const auto& step : path) {
    const auto kind = at->kind();
    if (kind == CORBA::tk_sequence || kind == CORBA::tk_array) {
      if (!base::parse_integer(step)) return way + "[0]";
      at = resolved(CORBA::TypeCode_var(at->content_type()));
      way += "[" + step + "]";
      continue;
    }
    if (kind == CORBA::tk_union) return "";
    if (kind != CORBA::tk_struct) return nothing;
    CORBA::TypeCode_var next;
    std::vector<std::string> names;
    for (CORBA::ULong i = 0; i < at->member_count(); ++i) {
      names.push_back(way + (way.empty() ? "" : ".") + at->member_name(i));
      if (step == at->member_name(i)) next = at->member_type(i);
    }
    if (CORBA::is_nil(next)) return base::join(names, ", ");
    at = resolved(next);
    way += (way.empty() ? "" : ".") + step;
  }
  switch (at->kind()) {
    case CORBA::tk_struct: {
      std::vector<std::string> names;
      for (CORBA::ULong i = 0; i < at->member_count(); ++i) names.push_back(way + "." + at->member_name(i));
      return base::join(names, ", ");
    }
    case CORBA::tk_sequence:
    case CORBA::tk_array:
      return way + "[0]";
    case CORBA::tk_string:
    case CORBA::tk_wstring:
    case CORBA::tk_enum:
      return nothing;
    default:
      return "";
  }
}

}  // namespace tools
