// For messages about a name that is not known: the known one that was most likely meant. Any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace base {

// The known name that differs from the word in the fewest letters, in any case, or whose last part after "::" or "/" does. Nothing when
// none is near: of up to 5 letters one may differ, of up to 10 two, and so on; an extension that both have does not count.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

// "; did you mean NAME?", or nothing when none is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace base
