#include "campaign/slurm/task_folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/id.h"
#include "base/text.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

std::string first_line(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

Result<void> write_file(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) return Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return {};
}

std::optional<RowNumbers> parse_rows(const std::string& text) {
  RowNumbers rows;
  for (const auto& word : base::split_list(text, ' ')) {
    const auto dots = word.find("..");
    const auto first = base::parse_integer(word.substr(0, dots));
    const auto last = dots == std::string::npos ? first : base::parse_integer(word.substr(dots + 2));
    if (!first || !last || *first < 1 || *last < *first || *last > 1'000'000) return std::nullopt;
    for (auto number = *first; number <= *last; ++number) rows.push_back(static_cast<std::size_t>(number));
  }
  return rows;
}

}  // namespace

std::string to_text(const RowNumbers& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    text += (text.empty() ? "" : " ") + std::to_string(rows[i]) + (end - i > 1 ? ".." + std::to_string(rows[end - 1]) : "");
    i = end;
  }
  return text;
}

Result<void> TaskFolder::open(const std::string& base_key) {
  std::error_code error;
  for (const char* inner : {"/parts", "/logs"}) {
    fs::create_directories(folder_ + inner, error);
    if (error) return Error{"folder " + base::in_quotes(folder_) + ": " + error.message()};
  }
  name_ = first_line(folder_ + "/name");
  if (name_.empty()) {
    name_ = "rtse-" + base::make_uuid().substr(0, 13);
    if (const auto written = write_file(folder_ + "/name", name_ + "\n"); !written) return written;
  }
  const auto key = first_line(folder_ + "/key");
  is_other_ = !key.empty() && key != base_key;
  if (is_other_) return {};
  if (key.empty()) {
    if (const auto written = write_file(folder_ + "/key", base_key + "\n"); !written) return written;
  }
  attempts_ = 0;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    const auto number = entry.path().extension() == ".todo" ? base::parse_integer(entry.path().stem().string()) : std::nullopt;
    if (number) attempts_ = std::max(attempts_, static_cast<int>(*number));
  }
  list_parts();
  return {};
}

void TaskFolder::remove() const {
  std::error_code ignored;  // what stays is taken away by the next call
  fs::remove_all(folder_, ignored);
}

void TaskFolder::list_parts() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_ + "/parts", error)) parts_.try_emplace(entry.path().string(), 0);
}

Result<int> TaskFolder::begin_attempt(const std::vector<RowNumbers>& tasks, const std::string& script) {
  const int attempt = attempts_ + 1;
  std::string todo;
  for (const auto& rows : tasks) todo += to_text(rows) + "\n";
  if (const auto written = write_file(folder_ + "/" + std::to_string(attempt) + ".todo", todo); !written) return written.error();
  if (const auto written = write_file(this->script(attempt), script); !written) return written.error();
  // They are there before anybody looks for them: a file that a client of a network file system has once missed, it misses for a while.
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    if (const auto written = write_file(part(attempt, task), ""); !written) return written.error();
    parts_.try_emplace(part(attempt, task), 0);
  }
  attempts_ = attempt;
  return attempt;
}

std::vector<OutcomeLine> TaskFolder::news() {
  std::vector<OutcomeLine> lines;
  for (auto& [file, read] : parts_) {
    std::ifstream in(file, std::ios::binary);
    if (!in.seekg(static_cast<std::streamoff>(read))) continue;
    std::string text;
    while (std::getline(in, text) && !in.eof()) {  // a line without its end is still being written
      read += text.size() + 1;
      if (auto line = from_line(text)) lines.push_back(std::move(*line));
    }
  }
  return lines;
}

Result<void> TaskFolder::check_key(const std::string& base_key) const {
  const auto key = first_line(folder_ + "/key");
  if (key.empty()) return Error{"folder " + base::in_quotes(folder_) + ": cannot be read, or belongs to no sweep"};
  if (key == base_key) return {};
  return Error{"folder " + base::in_quotes(folder_) + ": programs, modules, world or plan of this machine are not those of the sweep"};
}

Result<RowNumbers> TaskFolder::rows_of(int attempt, std::size_t task) const {
  const auto file = folder_ + "/" + std::to_string(attempt) + ".todo";
  std::ifstream in(file);
  std::string line;
  for (std::size_t i = 0; i <= task; ++i) {
    if (!std::getline(in, line)) return Error{"file " + base::in_quotes(file) + ": has no rows for task " + std::to_string(task)};
  }
  auto rows = parse_rows(line);
  if (!rows || rows->empty())
    return Error{"file " + base::in_quotes(file) + ": expected rows for task " + std::to_string(task) + ", got " + base::in_quotes(line)};
  return *rows;
}

}  // namespace campaign
