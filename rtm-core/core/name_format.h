// Text patterns of names: %n, %h, ... and ${ENVIRONMENT}. Any thread.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace rt {

// Replaces %x by value('x') where that has one, %% by %, and ${NAME} and $(NAME) by the environment variable (nothing if it is not set).
// What `value` does not know stays as it is.
std::string expand_format(std::string_view format, const std::function<std::optional<std::string>(char)>& value);

// A text as one id of a name: /, dot and backslash get a backslash.
std::string escape_name(std::string_view text);

// The digits that an instance name ends with: "ConsoleIn12" -> "12".
std::string_view number_suffix(std::string_view instance_name);

}  // namespace rt
