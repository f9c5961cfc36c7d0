#include "recording/sample_export.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "base/text.h"
#include "recording/mcap/mcap.h"
#include "recording/picture_export.h"
#include "recording/sample_text.h"

namespace recorder {

namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

// Names of files for channels: each its own, and none longer than file systems take.
class FileNames {
 public:
  const std::string& of(const std::string& topic, std::uint16_t channel) {
    std::string& name = names_[channel];
    if (!name.empty()) return name;
    constexpr std::size_t longest = 200;
    const std::string wanted = harmless(topic.substr(topic.starts_with("/") ? 1 : 0, longest));
    name = wanted;
    for (int n = 2; !used_.insert(name).second; ++n) name = wanted + "-" + std::to_string(n);
    return name;
  }

 private:
  // No path, no option of a command, nothing hidden, and nothing that a terminal obeys when it lists the files.
  static std::string harmless(std::string_view text) {
    std::string name;
    while (!text.empty()) {
      const auto character = base::first_character(text);
      const std::size_t size = character ? character->size : 1;
      if (text[0] == '/')
        name += '.';
      else if (!character || base::is_obeyed(character->code))
        name += '_';
      else
        name += text.substr(0, size);
      text.remove_prefix(size);
    }
    if (name.empty()) return "_";
    if (name[0] == '.' || name[0] == '-') name[0] = '_';
    return name;
  }

  std::map<std::uint16_t, std::string> names_;
  std::set<std::string> used_;
};

constexpr std::size_t max_columns = std::size_t{1} << 18;

// A table: time and the members of the first sample are its columns.
class Table {
 public:
  Table(const std::filesystem::path& file, const std::vector<std::pair<std::string, Json>>& first) : file_(file), out_(file) {
    out_ << "time";
    for (const auto& [name, value] : first) {
      columns_.push_back(name);
      out_ << ',' << quoted(name);
    }
    out_ << '\n';
  }
  void add(mcap::Time time, const Json& value) {
    std::map<std::string, Json> members;
    for (auto& [name, member] : members_of(value, max_columns)) members[name] = std::move(member);
    out_ << seconds_text(time);
    for (const std::string& column : columns_) {
      const auto member = members.find(column);
      out_ << ',';
      if (member != members.end())
        out_ << (member->second.is_string() ? quoted(member->second.get<std::string>()) : json_text(member->second));
    }
    out_ << '\n';
  }
  base::Result<void> close() {
    out_.close();
    if (out_.fail()) return base::Error{base::in_quotes(file_.string()) + ": cannot be written"};
    return {};
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::vector<std::string> columns_;
};

}  // namespace

base::Result<Exported> export_tables(const ExportOptions& options, tools::Reporter& reporter) {
  auto reader = open(options.selection.file, reporter);
  if (!reader) return reader.error();
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) return base::Error{base::in_quotes(options.folder) + ": cannot be made: " + error.message()};
  Exported exported;
  std::map<std::uint16_t, std::unique_ptr<Table>> tables;
  std::set<std::uint16_t> unreadable;
  FileNames names;
  SampleValues values(*reader);
  const auto broken = for_each(*reader, options.selection, [&](const mcap::Message& message) {
    const std::string& topic = reader->channels().at(message.channel).topic;
    const auto fail = [&](const base::Error& why) {
      if (unreadable.insert(message.channel).second) exported.errors.push_back(why);
      return true;
    };
    const auto value = values.of(message);
    if (!value) return fail(value.error());
    auto found = tables.find(message.channel);
    if (found == tables.end()) {
      const auto first = members_of(*value, max_columns + 1);
      if (first.size() > max_columns)
        return fail({"channel " + base::in_quotes(topic) + ": has more than " + std::to_string(max_columns) +
                     " members, which is too much for a table; recording cat prints them"});
      const auto file = std::filesystem::path(options.folder) / (names.of(topic, message.channel) + ".csv");
      found = tables.emplace(message.channel, std::make_unique<Table>(file, first)).first;
    }
    found->second->add(message.log_time, *value);
    return true;
  });
  exported.errors.insert(exported.errors.end(), broken.begin(), broken.end());
  for (auto& [id, table] : tables) {
    if (const auto done = table->close(); !done) {
      exported.errors.push_back(done.error());
    } else {
      ++exported.files;
    }
  }
  return exported;
}

base::Result<Exported> export_pictures(const ExportOptions& options, tools::Reporter& reporter) {
  auto reader = open(options.selection.file, reporter);
  if (!reader) return reader.error();
  Exported exported;
  std::map<std::uint16_t, std::uint64_t> written;
  std::set<std::uint16_t> unreadable;
  FileNames names;
  SampleValues values(*reader);
  const auto type_of = [&](std::uint16_t channel) {
    const auto schema = reader->schemas().find(reader->channels().at(channel).schema);
    return schema == reader->schemas().end() ? std::string() : schema->second.name;
  };
  const auto broken = for_each(*reader, options.selection, [&](const mcap::Message& message) {
    if (!has_pictures(type_of(message.channel)) || unreadable.contains(message.channel)) return true;
    const std::string& topic = reader->channels().at(message.channel).topic;
    const auto fail = [&](const base::Error& error) {
      exported.errors.push_back({"channel " + base::in_quotes(topic) + ": " + error.message});
      unreadable.insert(message.channel);
      return true;
    };
    const auto value = values.of(message);
    if (!value) return fail(value.error());
    const auto picture = picture_of(type_of(message.channel), *value);
    if (!picture) return fail(picture.error());
    const auto folder = std::filesystem::path(options.folder) / names.of(topic, message.channel);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    char name[32];
    std::snprintf(name, sizeof name, "%06llu.png", static_cast<unsigned long long>(++written[message.channel]));
    const auto done = write_png(*picture, (folder / name).string());
    return done ? true : fail(done.error());
  });
  exported.errors.insert(exported.errors.end(), broken.begin(), broken.end());
  for (const auto& [channel, count] : written) exported.files += count;
  if (exported.files == 0 && exported.errors.empty())
    exported.errors.push_back({base::in_quotes(options.selection.file) + ": has no pictures in these channels"});
  return exported;
}

}  // namespace recorder
