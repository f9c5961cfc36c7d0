// String functions of the classic component API, in the spellings of 1.x (changes the argument) and 2.x (returns a new string). Any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <istream>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace coil {

using vstring = std::vector<std::string>;
using mapstring = std::map<std::string, std::string>;

// What a string function returns for a string variable. 1.x code calls it as a statement and expects the variable to change, 2.x code uses
// the result and expects the variable to stay: so a result that nobody has looked at is written back when it goes.
class ChangedString {
 public:
  ChangedString(std::string& source, std::string result) : source_(&source), result_(std::move(result)) {}
  ChangedString(const ChangedString&) = delete;
  ChangedString& operator=(const ChangedString&) = delete;
  ~ChangedString() {
    if (source_ != nullptr) *source_ = std::move(result_);
  }

  operator std::string() const { return value(); }
  const std::string& value() const {
    source_ = nullptr;
    return result_;
  }
  const char* c_str() const { return value().c_str(); }
  const char* data() const { return value().data(); }
  std::size_t size() const { return value().size(); }
  std::size_t length() const { return value().size(); }
  bool empty() const { return value().empty(); }
  char operator[](std::size_t i) const { return value()[i]; }
  char at(std::size_t i) const { return value().at(i); }
  std::string substr(std::size_t pos, std::size_t count = std::string::npos) const { return value().substr(pos, count); }
  template <class... A>
  std::size_t find(const A&... what) const {
    return value().find(what...);
  }
  template <class A>
  int compare(const A& other) const {
    return value().compare(other);
  }
  auto begin() const { return value().begin(); }
  auto end() const { return value().end(); }

  friend bool operator==(const ChangedString& a, const ChangedString& b) { return a.value() == b.value(); }
  friend bool operator==(const ChangedString& a, const std::string& b) { return a.value() == b; }
  friend bool operator==(const ChangedString& a, const char* b) { return a.value() == b; }
  friend bool operator==(const std::string& a, const ChangedString& b) { return b == a; }
  friend bool operator==(const char* a, const ChangedString& b) { return b == a; }
  friend bool operator!=(const ChangedString& a, const ChangedString& b) { return !(a == b); }
  friend bool operator!=(const ChangedString& a, const std::string& b) { return !(a == b); }
  friend bool operator!=(const ChangedString& a, const char* b) { return !(a == b); }
  friend bool operator!=(const std::string& a, const ChangedString& b) { return !(b == a); }
  friend bool operator!=(const char* a, const ChangedString& b) { return !(b == a); }
  friend bool operator<(const ChangedString& a, const std::string& b) { return a.value() < b; }
  friend std::string operator+(const ChangedString& a, const std::string& b) { return a.value() + b; }
  friend std::string operator+(const std::string& a, const ChangedString& b) { return a + b.value(); }
  friend std::string operator+(const ChangedString& a, const char* b) { return a.value() + b; }
  friend std::string operator+(const char* a, const ChangedString& b) { return a + b.value(); }
  friend std::ostream& operator<<(std::ostream& out, const ChangedString& s) { return out << s.value(); }

 private:
  mutable std::string* source_;
  std::string result_;
};

std::string toUpper(const std::string& str);
ChangedString toUpper(std::string& str);
std::string toUpper(std::string&& str);
std::string toLower(const std::string& str);
ChangedString toLower(std::string& str);
std::string toLower(std::string&& str);

// The next line without its end, "\n" or "\r\n"; returns its length.
int getlinePortable(std::istream& in, std::string& line);

// Without any blank (space, tab) / those at the head / at the tail / at both ends.
std::string eraseBlank(const std::string& str);
ChangedString eraseBlank(std::string& str);
std::string eraseBlank(std::string&& str);
std::string eraseHeadBlank(const std::string& str);
ChangedString eraseHeadBlank(std::string& str);
std::string eraseHeadBlank(std::string&& str);
std::string eraseTailBlank(const std::string& str);
ChangedString eraseTailBlank(std::string& str);
std::string eraseTailBlank(std::string&& str);
std::string eraseBothEndsBlank(const std::string& str);
ChangedString eraseBothEndsBlank(std::string& str);
std::string eraseBothEndsBlank(std::string&& str);
// Without blanks at both ends, in lower case.
std::string normalize(const std::string& str);
ChangedString normalize(std::string& str);
std::string normalize(std::string&& str);
// With every `from` replaced by `to`; an empty `from` changes nothing.
std::string replaceString(const std::string& str, const std::string& from, const std::string& to);
ChangedString replaceString(std::string& str, const std::string& from, const std::string& to);
std::string replaceString(std::string&& str, const std::string& from, const std::string& to);
// With ${NAME} replaced by the environment variable, by nothing if that is not set.
std::string replaceEnv(const std::string& str);
ChangedString replaceEnv(std::string& str);
std::string replaceEnv(std::string&& str);

std::wstring string2wstring(const std::string& str);
std::string wstring2string(const std::wstring& wstr);

// Reads a line that may end in \n or \r\n; returns its length, -1 at the end of the input.
int getline(std::istream& istr, std::string& line);

// True if the character at `pos` follows an odd number of backslashes.
bool isEscaped(const std::string& str, std::string::size_type pos);
// Tab, newline, carriage return, form feed, quotes and backslashes as \t \n \r \f \" \' \\, and back.
std::string escape(const std::string& str);
std::string unescape(const std::string& str);

// The parts between delimiters, trimmed. An empty input has no parts.
vstring split(const std::string& input, const std::string& delimiter, bool ignore_empty = false);
std::string flatten(const vstring& sv, const std::string& delimiter = ", ");
// Sorted, each string once.
vstring unique_sv(const vstring& sv);

// True if the text contains `yes`, false if it contains `no`, in any case of letters; else the default.
bool toBool(const std::string& str, const std::string& yes, const std::string& no, bool default_value = true);
bool includes(const vstring& list, const std::string& value, bool ignore_case = true);
// The list is separated by commas.
bool includes(const std::string& list, const std::string& value, bool ignore_case = true);

bool isAbsolutePath(const std::string& str);
bool isURL(const std::string& str);
bool isIPv4(const std::string& str);
bool isIPv6(const std::string& str);
bool isIPPort(const std::string& str);

// `a=1&b=2`, with or without something up to a question mark before it.
mapstring urlparam2map(const std::string& str);

// printf into a string.
std::string sprintf(const char* fmt, ...) __attribute__((format(printf, 1, 2)));

// Arguments in the form that main() gets them; argv() ends with a null pointer and lives as long as this object.
class Argv {
 public:
  Argv() : Argv(vstring{}) {}
  explicit Argv(const vstring& args);
  Argv(const Argv& other) : Argv(other.strings_) {}
  Argv& operator=(const Argv& other);
  std::size_t size() const { return strings_.size(); }
  char** get() { return pointers_.data(); }
  int argc() const { return static_cast<int>(strings_.size()); }
  char** argv() { return pointers_.data(); }

 private:
  vstring strings_;
  std::vector<char*> pointers_;
};
// A copy of the arguments that the caller owns: delete[] each and the array.
char** toArgv(const vstring& args);

template <class T>
std::string otos(const T& value) {
  if constexpr (std::is_convertible_v<T, std::string>) {
    return value;
  } else {
    std::ostringstream out;
    out << value;
    return out.str();
  }
}

namespace detail {
bool read_bool(bool& value, const char* str);
bool read_seconds(double& seconds, const char* str);

template <class T>
struct IsVector : std::false_type {};
template <class T, class A>
struct IsVector<std::vector<T, A>> : std::true_type {};
template <class T>
struct IsDuration : std::false_type {};
template <class R, class P>
struct IsDuration<std::chrono::duration<R, P>> : std::true_type {};
template <class T, class = void>
struct IsReadable : std::false_type {};
template <class T>
struct IsReadable<T, std::void_t<decltype(std::declval<std::istream&>() >> std::declval<T&>())>> : std::true_type {};
}  // namespace detail

// Converts text to a value; false, and the value as it was, if it cannot be read. Durations are read as seconds, vectors as comma lists,
// bool as 0, 1, true, false, yes, no, on, off; everything else with operator>>. May be specialised for own types.
template <typename To>
bool stringTo(To& val, const char* str) {
  if (str == nullptr) return false;
  if constexpr (std::is_same_v<To, std::string>) {
    val = str;
    return true;
  } else if constexpr (std::is_same_v<To, bool>) {
    return detail::read_bool(val, str);
  } else if constexpr (detail::IsDuration<To>::value) {
    double seconds = 0;
    if (!detail::read_seconds(seconds, str)) return false;
    val = std::chrono::duration_cast<To>(std::chrono::duration<double>(seconds));
    return true;
  } else if constexpr (detail::IsVector<To>::value && !detail::IsReadable<To>::value) {
    To values;
    for (const std::string& part : split(str, ",", true)) {
      typename To::value_type value{};
      if (!stringTo(value, part.c_str())) return false;
      values.push_back(std::move(value));
    }
    val = std::move(values);
    return true;
  } else {
    std::istringstream in{std::string(str)};
    To value = val;
    in >> value;
    if (in.fail()) return false;
    val = std::move(value);
    return true;
  }
}

}  // namespace coil
