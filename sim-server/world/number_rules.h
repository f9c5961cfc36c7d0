// The table of numbers in SDFormat files: which elements are what kind of number, within which bounds, and what happens to an object with
// an impossible one. Pure functions; any thread.
#pragma once

#include <string>
#include <string_view>

namespace sim {

inline constexpr double largest_length = 1e9;  // [m] and other physical values where a user cannot mean more

struct NumberRule {
  enum class Form { finite, not_negative, positive, number, within, vector2, positive2, vector3, positive3, scale3, direction, pose };
  enum class Remedy { drop_owner, ignore };
  Form form;
  Remedy remedy;
  double min = 0, max = 0;  // of Form::within
};

// The rule of <element> in <parent>; null: none. The prefix of a parent (<gz:dvl>) does not count.
const NumberRule* find_number_rule(std::string_view parent, std::string_view element);
bool fits(const NumberRule& rule, const std::string& text);
// "a positive number".
std::string expectation(const NumberRule& rule);

}  // namespace sim
