#include "world/complaints.h"

#include <algorithm>

#include "base/text.h"

namespace sim {

namespace {
constexpr std::size_t max_findings = 500;
}

std::string Place::text() const { return line > 0 ? file + ":" + std::to_string(line) : file; }

int Complaints::add_file(const std::string& name) {
  const auto found = std::find(files_.begin(), files_.end(), name);
  if (found != files_.end()) return static_cast<int>(found - files_.begin());
  files_.push_back(name);
  return static_cast<int>(files_.size()) - 1;
}

Place Complaints::place_of(pugi::xml_node node) const {
  Place place;
  for (pugi::xml_node at = node; at; at = at.parent()) {
    if (place.line == 0) place.line = at.attribute(line_mark).as_int();
    if (const pugi::xml_attribute file = at.attribute(file_mark)) {
      const unsigned index = file.as_uint();
      if (index < files_.size()) place.file = files_[index];
      break;
    }
  }
  return place;
}

void Complaints::add(Finding::Severity severity, const Place& place, std::string message) {
  dropped_ = dropped_ || severity == Finding::Severity::dropped;
  if (findings_.size() >= max_findings) {
    ++cut_;
    return;
  }
  Finding finding{severity, place.file, place.line, std::move(message)};
  if (seen_.insert(finding.text()).second) findings_.push_back(std::move(finding));
}

std::vector<Finding> Complaints::take() {
  if (cut_ > 0) findings_.push_back({Finding::Severity::note, {}, 0, std::to_string(cut_) + " more findings are not listed"});
  cut_ = 0;
  seen_.clear();
  return std::exchange(findings_, {});
}

std::string describe(pugi::xml_node node) {
  const pugi::xml_attribute name = node.attribute("name");
  if (!name) return "<" + std::string(node.name()) + ">";
  return std::string(node.name()) + " " + base::in_quotes(name.value());
}

std::string describe_in_context(pugi::xml_node node) {
  std::string text = describe(node);
  int named = node.attribute("name") ? 1 : 0;
  for (pugi::xml_node at = node.parent(); at && named < 3; at = at.parent()) {
    if (!at.attribute("name") || std::string_view(at.name()) == "world") continue;
    text += " of " + describe(at);
    ++named;
  }
  return text;
}

}  // namespace sim
