// Text that is almost XML made into XML, as people's files commonly need it: attribute values without quotes, with doubled or typographic
// ones, end tags of nothing. The number of lines stays the same. Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sim {

struct RepairedText {
  struct Change {
    std::size_t offset = 0;  // of the first one of its kind, in the old text
    std::string message;
  };
  std::string text;
  std::vector<Change> changes;  // empty: the text is as it was
};

RepairedText repair_xml_text(const std::string& text);

}  // namespace sim
