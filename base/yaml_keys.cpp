#include "base/yaml_keys.h"

#include <yaml-cpp/depthguard.h>

#include <ios>
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

YAML::Node load_file(const std::string& path) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAllFromFile(path);
  } catch (const std::ios_base::failure&) {
    throw YAML::BadFile(path);
  } catch (const YAML::DeepRecursion& wrong) {
    throw YAML::Exception(wrong.mark, "the file is nested too deeply");
  }
  if (documents.empty()) return {};
  if (documents.size() > 1) throw YAML::Exception(documents[1].Mark(), "one document is expected, got " + std::to_string(documents.size()));
  expect_unique_keys(documents.front());
  return documents.front();
}

}  // namespace yaml
