#include "system/typed_value.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "system/value_codec.h"
#include "system/value_failure.h"

namespace tools {
namespace {

using base::Error;
using base::Result;
using Json = nlohmann::ordered_json;

bool is_time(CORBA::TypeCode_ptr type) { return type->kind() == CORBA::tk_struct && std::string(type->id()) == "IDL:RTC/Time:1.0"; }

Json time_value(std::int64_t now_ns) { return {{"sec", now_ns / 1'000'000'000}, {"nsec", now_ns % 1'000'000'000}}; }

// rtinject's form is Python: calls with members in order, lists, strings, True, False, {time}.
class PythonForm {
 public:
  PythonForm(const std::string& text, std::int64_t now_ns) : text_(text), now_ns_(now_ns) {}

  Json parse(CORBA::TypeCode_ptr type) {
    auto value = expression(type);
    blanks();
    if (at_ != text_.size()) fail("the end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw ValueFailure{"value " + base::in_quotes(text_) + ": expected " + expected + " at character " + std::to_string(at_ + 1)};
  }
  void blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(char c) {
    blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string word() {
    blanks();
    const auto start = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_' || text_[at_] == '.' ||
                                  text_[at_] == '{' || text_[at_] == '}' || text_[at_] == '+' || text_[at_] == '-'))
      ++at_;
    return text_.substr(start, at_ - start);
  }
  std::string quoted(char quote) {
    std::string text;
    while (at_ < text_.size() && text_[at_] != quote) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      text += text_[at_++];
    }
    if (!take(quote)) fail("a closing quote");
    return text;
  }
  Json expression(CORBA::TypeCode_ptr declared) {
    if (++depth_ > deepest) throw ValueFailure{"value: nested too deeply"};
    const auto type = resolved(declared);
    blanks();
    Json value;
    if (take('\'')) {
      value = quoted('\'');
    } else if (take('"')) {
      value = quoted('"');
    } else if (take('[')) {
      value = list(type);
    } else {
      value = named(type, word());
    }
    --depth_;
    return value;
  }
  Json list(CORBA::TypeCode_ptr type) {
    if (type->kind() != CORBA::tk_sequence && type->kind() != CORBA::tk_array) fail("no list here");
    const CORBA::TypeCode_var content = type->content_type();
    Json array = Json::array();
    while (!take(']')) {
      array.push_back(expression(content));
      if (!take(',') && !(at_ < text_.size() && text_[at_] == ']')) fail("',' or ']'");
    }
    return array;
  }
  Json named(CORBA::TypeCode_ptr type, const std::string& text) {
    if (text.empty()) fail("a value");
    if (text == "{time}" && is_time(type)) return time_value(now_ns_);
    if (text == "True" || text == "true") return true;
    if (text == "False" || text == "false") return false;
    if (take('(')) {
      check_name(type, text);
      return members(type);
    }
    if (const auto integer = base::parse_integer(text)) return *integer >= 0 ? Json(static_cast<std::uint64_t>(*integer)) : Json(*integer);
    if (const auto number = base::parse_number(text)) return *number;
    // An enumerator, perhaps with its module: RTC.GPS_FIX_NONE.
    const auto dot = text.rfind('.');
    return dot == std::string::npos ? text : text.substr(dot + 1);
  }
  // RTC.TimedLong, RTC::TimedLong or TimedLong for an RTC::TimedLong; the module is not looked at.
  void check_name(CORBA::TypeCode_ptr type, const std::string& text) const {
    if (type->kind() != CORBA::tk_struct) fail("no call here");
    const auto begin = text.find_last_of(".:");
    if (text.substr(begin == std::string::npos ? 0 : begin + 1) != type->name())
      throw ValueFailure{"value " + base::in_quotes(text_) + ": is a " + text + ", expected a " + std::string(type->name())};
  }
  Json members(CORBA::TypeCode_ptr type) {
    if (type->kind() != CORBA::tk_struct) fail("no call here");
    Json object = Json::object();
    CORBA::ULong i = 0;
    while (!take(')')) {
      if (i >= type->member_count()) fail("')', " + std::string(type->name()) + " has " + std::to_string(i) + " members");
      const CORBA::TypeCode_var member = type->member_type(i);
      object[type->member_name(i)] = expression(member);
      ++i;
      if (!take(',') && !(at_ < text_.size() && text_[at_] == ')')) fail("',' or ')'");
    }
    return object;
  }

  static constexpr int deepest = 64;
  const std::string& text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::int64_t now_ns_;
};

// A string, or a Timed type with one.
bool takes_text(CORBA::TypeCode_ptr type) {
  if (type->kind() == CORBA::tk_string) return true;
  if (type->kind() != CORBA::tk_struct || type->member_count() != 2) return false;
  const CORBA::TypeCode_var first = type->member_type(0), second = type->member_type(1);
  return is_time(first) && resolved(second)->kind() == CORBA::tk_string;
}

// Where the text stops being JSON. NaN and infinities are none.
std::string json_problem(const std::string& text) {
  try {
    return Json::parse(text).is_null() ? "null" : "";
  } catch (const nlohmann::json::parse_error& error) {
    const auto at = std::min(error.byte, text.size());
    return "unexpected " + (at > 0 ? base::in_quotes(text.substr(at - 1, 10)) : std::string("end")) + " at character " + std::to_string(at);
  }
}

}  // namespace

Result<Json> parse_value(CORBA::TypeCode_ptr declared, const std::string& text, std::int64_t now_ns) {
  const auto type = resolved(declared);
  auto value = Json::parse(text, nullptr, false);
  if (value.is_discarded()) {
    try {
      value = PythonForm(text, now_ns).parse(type);
    } catch (const ValueFailure& failure) {
      const auto first = text.find_first_not_of(" \t\n");
      if (takes_text(type) && text.find_first_of("\"'(") == std::string::npos) {
        value = text;  // words need no quotes where only text can stand
      } else if (first != std::string::npos && (text[first] == '{' || text[first] == '[')) {
        return Error{"value " + base::in_quotes(text) + ": is no JSON: " + json_problem(text)};
      } else {
        return Error{failure.message};
      }
    }
  }
  if (type->kind() != CORBA::tk_struct || type->member_count() == 0) return value;
  const CORBA::TypeCode_var first = type->member_type(0);
  if (!is_time(first)) return value;
  const std::string time_name = type->member_name(0);
  if (!value.is_object() && type->member_count() == 2) value = Json{{std::string(type->member_name(1)), value}};
  if (value.is_object() && !value.contains(time_name)) {
    // A bare object for a Timed type may also be its data: {"vx": 0.2} for a TimedVelocity2D.
    const std::string data_name = type->member_count() == 2 ? type->member_name(1) : "";
    const CORBA::TypeCode_var second = data_name.empty() ? CORBA::TypeCode::_nil() : type->member_type(1);
    const bool is_record = !data_name.empty() && resolved(second)->kind() == CORBA::tk_struct;
    if (is_record && !value.contains(data_name) && !value.empty()) value = Json{{data_name, value}};
    value[time_name] = time_value(now_ns);
  }
  return value;
}

}  // namespace tools
