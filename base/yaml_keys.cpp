#include "base/yaml_keys.h"

#include <set>
#include <string>
#include <vector>

#include "base/text.h"

namespace yaml {

// By a list, not by calls: a file may nest as deep as its reader lets it. Aliases can make a small file a tree without end; what comes
// after so many nodes is not looked at.
void expect_unique_keys(const YAML::Node& root) {
  constexpr std::size_t most = 1'000'000;
  std::vector<YAML::Node> left = {root};
  for (std::size_t count = 0; !left.empty() && count < most; ++count) {
    const YAML::Node node = left.back();
    left.pop_back();
    if (!node.IsMap() && !node.IsSequence()) continue;
    std::set<std::string> keys;
    for (const auto& entry : node) {
      if (!node.IsMap()) {
        left.push_back(entry);
        continue;
      }
      if (entry.first.IsScalar() && !keys.insert(entry.first.Scalar()).second)
        throw YAML::Exception(entry.first.Mark(), "the key " + base::in_quotes(entry.first.Scalar()) + " appears twice");
      left.push_back(entry.second);
    }
  }
}

}  // namespace yaml
