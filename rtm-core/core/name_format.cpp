#include "core/name_format.h"

#include <cstdlib>

namespace rt {

std::string expand_format(std::string_view format, const std::function<std::optional<std::string>(char)>& value) {
  std::string result;
  for (std::size_t i = 0; i < format.size(); ++i) {
    const char c = format[i];
    const bool has_next = i + 1 < format.size();
    if (c == '%' && has_next && format[i + 1] == '%') {
      result += '%';
      ++i;
    } else if (c == '%' && has_next) {
      if (const auto known = value(format[i + 1])) {
        result += *known;
      } else {
        result += c;
        result += format[i + 1];
      }
      ++i;
    } else if (c == '$' && has_next && (format[i + 1] == '{' || format[i + 1] == '(')) {
      const auto end = format.find(format[i + 1] == '{' ? '}' : ')', i + 2);
      if (end == std::string_view::npos) {
        result += c;
        continue;
      }
      const std::string name(format.substr(i + 2, end - i - 2));
      if (const char* found = std::getenv(name.c_str())) result += found;
      i = end;
    } else {
      result += c;
    }
  }
  return result;
}

std::string escape_name(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '/' || c == '.' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string_view number_suffix(std::string_view instance_name) {
  const auto last = instance_name.find_last_not_of("0123456789");
  return last == std::string_view::npos ? instance_name : instance_name.substr(last + 1);
}

}  // namespace rt
