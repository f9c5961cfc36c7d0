#include "campaign/rows/model_files.h"

#include "base/beneath.h"
#include "base/text.h"

namespace campaign {
namespace fs = std::filesystem;

std::string ModelFiles::absolute(const std::string& uri, const fs::path& at) const {
  const auto found = found_.find({at.string(), std::string(base::trim(uri))});
  return found == found_.end() ? uri : found->second;
}

std::optional<ModelFiles::Opened> ModelFiles::open(pugi::xml_node include, const fs::path& at, const char* kind) const {
  const std::string uri = include.child("uri").text().get();
  if (uri.starts_with("model://")) {
    if (const auto copy = copies_.find(uri.substr(8)); copy != copies_.end())
      return Opened{copy->second->document.child("sdf").child(kind), copy->second->file};
  }
  const auto place = absolute(uri, at);
  auto& document = read_[place];
  if (!document) {
    document = std::make_unique<pugi::xml_document>();
    if (base::check_regular_file(place)) document->load_file(place.c_str());
  }
  const auto found = document->child("sdf").child(kind);
  return found ? std::optional(Opened{found, place}) : std::nullopt;
}

std::optional<ModelFiles::Opened> ModelFiles::copy(pugi::xml_node include, const fs::path& at, const std::string& name) {
  const auto original = open(include, at);
  if (!original) return std::nullopt;
  auto& copy = copies_[name];
  if (!copy) {
    copy = std::make_unique<Copy>();
    copy->document.reset(*read_.at(original->file));
    copy->file = original->file;
  }
  return Opened{copy->document.child("sdf").child("model"), copy->file};
}

std::string ModelFiles::name_of(pugi::xml_node include, const fs::path& at) const {
  if (const std::string name = include.child("name").text().get(); !name.empty()) return name;
  const auto opened = open(include, at);
  return opened ? opened->model.attribute("name").value() : "";
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::string blanks = text;
  for (char& c : blanks) c = c == '\n' || c == '\t' || c == '\r' ? ' ' : c;
  for (const auto& word : base::split_list(blanks, ' ')) {
    const auto number = base::parse_number(word);
    if (!number) break;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace campaign
