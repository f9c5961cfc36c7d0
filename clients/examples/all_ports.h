// One port of every basic type and of every sequence of a basic type, with the variable that is bound to it.
// One thread at a time, as everything in a component's callbacks.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <string>
#include <tuple>
#include <type_traits>

namespace example {

template <template <class> class Port, class Type>
struct BoundPort {
  BoundPort(const char* port_name) : name(port_name), port(port_name, value) {}
  const char* name;
  Type value{};
  Port<Type> port;
};

template <template <class> class Port>
class AllPorts {
 public:
  // Calls `function` with each BoundPort.
  template <class Function>
  void for_each(Function function) {
    std::apply([&](auto&... bound) { (function(bound), ...); }, ports_);
  }

 private:
  template <class Type>
  using Bound = BoundPort<Port, Type>;

  std::tuple<Bound<RTC::TimedShort>, Bound<RTC::TimedLong>, Bound<RTC::TimedUShort>, Bound<RTC::TimedULong>, Bound<RTC::TimedFloat>,
             Bound<RTC::TimedDouble>, Bound<RTC::TimedChar>, Bound<RTC::TimedWChar>, Bound<RTC::TimedBoolean>, Bound<RTC::TimedOctet>,
             Bound<RTC::TimedString>, Bound<RTC::TimedWString>, Bound<RTC::TimedShortSeq>, Bound<RTC::TimedLongSeq>,
             Bound<RTC::TimedUShortSeq>, Bound<RTC::TimedULongSeq>, Bound<RTC::TimedFloatSeq>, Bound<RTC::TimedDoubleSeq>,
             Bound<RTC::TimedCharSeq>, Bound<RTC::TimedWCharSeq>, Bound<RTC::TimedBooleanSeq>, Bound<RTC::TimedOctetSeq>,
             Bound<RTC::TimedStringSeq>, Bound<RTC::TimedWStringSeq>>
      ports_{"short",     "long",       "ushort",   "ulong",     "float",       "double",    "char",       "wchar",
             "boolean",   "octet",      "string",   "wstring",   "short_seq",   "long_seq",  "ushort_seq", "ulong_seq",
             "float_seq", "double_seq", "char_seq", "wchar_seq", "boolean_seq", "octet_seq", "string_seq", "wstring_seq"};
};

template <class Data>
concept Sequence = requires(Data& data) {
  data.length(CORBA::ULong{});
  data.get_buffer();
};

// Puts the number n into a value: as it is, as the n-th letter, as text, or n, n + 1, n + 2 ... into a sequence of that length.
template <class Data>
void set_number(Data&& data, unsigned long n, CORBA::ULong length) {
  using Plain = std::remove_cvref_t<Data>;
  if constexpr (Sequence<Plain>) {
    data.length(length);
    for (CORBA::ULong i = 0; i < length; ++i) set_number(data[i], n + i, length);
  } else if constexpr (std::is_same_v<Plain, CORBA::Boolean>) {
    data = n % 2 == 1;
  } else if constexpr (std::is_same_v<Plain, CORBA::Char> || std::is_same_v<Plain, CORBA::WChar>) {
    data = static_cast<Plain>('a' + n % 26);
  } else if constexpr (std::is_arithmetic_v<Plain>) {
    data = static_cast<Plain>(n);
  } else if constexpr (requires { data = CORBA::string_dup(""); }) {
    data = CORBA::string_dup(std::to_string(n).c_str());
  } else {
    data = CORBA::wstring_dup(std::to_wstring(n).c_str());
  }
}

// A character of a wide string, as UTF-8.
inline std::string to_utf8(CORBA::WChar c) {
  const auto code = static_cast<unsigned long>(c);
  const auto tail = [&](int shift) { return static_cast<char>(0x80 | ((code >> shift) & 0x3f)); };
  if (code < 0x80) return std::string(1, static_cast<char>(code));
  if (code < 0x800) return {static_cast<char>(0xc0 | (code >> 6)), tail(0)};
  if (code < 0x10000) return {static_cast<char>(0xe0 | (code >> 12)), tail(6), tail(0)};
  return {static_cast<char>(0xf0 | (code >> 18)), tail(12), tail(6), tail(0)};
}

// A value as text; elements of sequences are separated by blanks.
template <class Data>
std::string to_text(const Data& data) {
  if constexpr (Sequence<Data>) {
    std::string text;
    for (CORBA::ULong i = 0; i < data.length(); ++i) text += (i == 0 ? "" : " ") + to_text(data[i]);
    return text;
  } else if constexpr (std::is_same_v<Data, CORBA::WChar>) {
    return to_utf8(data);
  } else if constexpr (std::is_same_v<Data, CORBA::Char>) {
    return std::string(1, static_cast<char>(data));
  } else if constexpr (std::is_arithmetic_v<Data>) {
    return std::to_string(data);
  } else if constexpr (std::is_convertible_v<const Data&, const char*>) {
    return static_cast<const char*>(data);
  } else {
    std::string text;
    for (const CORBA::WChar* c = data; *c != 0; ++c) text += to_utf8(*c);
    return text;
  }
}

}  // namespace example
