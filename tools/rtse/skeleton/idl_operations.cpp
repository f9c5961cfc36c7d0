#include "rtse/skeleton/idl_operations.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "base/id.h"
#include "base/plain_file.h"
#include "base/text.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

// A folder that goes with its owner.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(std::filesystem::temp_directory_path() / ("rtse-" + base::make_uuid())) {
    std::filesystem::create_directory(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;  // what is left in the temporary folder harms nobody
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Where the product's own IDL files are: beside the installed program, else where this one was built.
std::vector<std::filesystem::path> product_idl() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed = program.parent_path().parent_path() / "include/rtm-sim/rtm";
  if (std::filesystem::is_directory(installed / "idl", error)) return {installed / "idl", installed / "ext"};
  return {RTMSIM_IDL_DIR, RTMSIM_IDL_DIR "/ext"};
}

Result<void> run_omniidl(const std::string& file, const std::filesystem::path& folder) {
  // Its example code holds every operation, also the inherited ones, with all names written in full.
  std::vector<std::string> words = {"omniidl", "-bcxx", "-Wbexample", "-C" + folder.string()};
  for (const auto& path : product_idl()) words.push_back("-I" + path.string());
  words.push_back(file);
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, "omniidl", nullptr, nullptr, arguments.data(), environ) != 0)
    return Error{"omniidl: cannot be started; is package omniidl installed?"};
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) return Error{"IDL file " + base::in_quotes(file) + ": omniidl rejected it"};
  return {};
}

std::string answer_for(const std::string& type) {
  if (type == "void") return "return;";
  if (type == "char*") return "return CORBA::string_dup(\"\");";
  if (type == "CORBA::WChar*") return "return CORBA::wstring_dup(L\"\");";
  if (type.ends_with("_slice*")) return "return " + type.substr(0, type.size() - 7) + "_alloc();";
  if (type.ends_with("*")) return "return new " + type.substr(0, type.size() - 1) + "();";
  if (type.ends_with("_ptr")) return "return " + type.substr(0, type.size() - 4) + "::_nil();";
  return "return " + type + "();";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

Result<std::string> read_text(const std::filesystem::path& file) {
  if (const auto problem = base::file_problem(file); !problem.empty())
    return Error{"IDL file " + base::in_quotes(file.string()) + ": " + problem};
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> includes_of(const std::string& text) {
  static const std::regex line(R"re((^|\n)[ \t]*#[ \t]*include[ \t]*["<]([^">\n]+)[">])re");
  std::vector<std::string> names;
  for (std::sregex_iterator found(text.begin(), text.end(), line), end; found != end; ++found) names.push_back((*found)[2]);
  return names;
}

Result<void> collect(const std::filesystem::path& file, std::map<std::string, std::string>& files) {
  auto text = read_text(file);
  if (!text) return text.error();
  const auto name = file.filename().string();
  // It stands in a CMakeLists.txt.
  if (!std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; }))
    return Error{"IDL file " + base::in_quotes(file.string()) + ": its name may hold letters, digits, '_', '-' and '.' only"};
  if (const auto [other, is_new] = files.emplace(name, *text); !is_new) {
    if (other->second == *text) return {};
    return Error{"IDL file " + base::in_quotes(file.string()) + ": another file has this name"};
  }
  for (const auto& include : includes_of(*text)) {
    std::error_code error;
    const auto neighbour = file.parent_path() / include;
    if (!std::filesystem::is_regular_file(neighbour, error)) continue;  // one of the product's, or omniidl says what is missing
    if (include.find('/') != std::string::npos)
      return Error{"IDL file " + base::in_quotes(file.string()) + ": includes " + base::in_quotes(include) + "; put both into one folder"};
    if (const auto done = collect(neighbour, files); !done) return done;
  }
  return {};
}

// Names, keywords and the signs { } ; of an IDL text, without comments, texts and lines of the preprocessor.
std::vector<std::string> idl_words(const std::string& idl) {
  std::vector<std::string> words;
  const auto is_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  const auto after = [&](const std::string& end, std::size_t from) {
    const auto found = idl.find(end, from);
    return found == std::string::npos ? idl.size() : found + end.size();
  };
  for (std::size_t i = 0; i < idl.size();) {
    if (idl.compare(i, 2, "//") == 0 || idl[i] == '#') {
      i = after("\n", i);
    } else if (idl.compare(i, 2, "/*") == 0) {
      i = after("*/", i + 2);
    } else if (idl[i] == '"') {
      i = after("\"", i + 1);
    } else if (is_name(idl[i])) {
      const auto begin = i;
      while (i < idl.size() && is_name(idl[i])) ++i;
      words.push_back(idl.substr(begin, i - begin));
    } else {
      if (idl[i] == '{' || idl[i] == '}' || idl[i] == ';') words.emplace_back(1, idl[i]);
      ++i;
    }
  }
  return words;
}

}  // namespace

Result<std::vector<Operation>> operations_of(const NewService& service) {
  const TemporaryFolder folder;
  if (const auto ran = run_omniidl(service.idl_file, folder.path()); !ran) return ran.error();
  std::ifstream in(folder.path() / (std::filesystem::path(service.idl_file).stem().string() + "_i.cc"));
  const auto implementation = replaced(service.interface, "::", "_") + "_i";
  const auto class_line = "class " + implementation + " : public POA_" + service.interface + " {";
  const auto method = " " + implementation + "::";
  bool exists = false;
  std::vector<Operation> operations;
  for (std::string line; std::getline(in, line);) {
    if (std::string(base::trim(line)) == class_line) exists = true;
    const auto at = line.find(method);
    if (at == std::string::npos || at == 0 || line.front() == ' ' || line.front() == '#' || line.find('(') < at) continue;
    auto type = line.substr(0, at);
    if (type.starts_with("::")) type.erase(0, 2);
    operations.push_back({type + " " + std::string(base::trim(line.substr(at + method.size()))), answer_for(type)});
  }
  if (!exists) return Error{"IDL file " + base::in_quotes(service.idl_file) + ": has no interface " + base::in_quotes(service.interface)};
  return operations;
}

std::vector<std::string> interfaces_in(const std::string& idl) {
  std::vector<std::string> interfaces, scopes;
  std::string kind, name;  // of what a brace would open
  for (const auto& word : idl_words(idl)) {
    if (word == "{") {
      scopes.push_back(name);
      if (kind == "interface") interfaces.push_back(base::join(scopes, "::"));
    } else if (word == "}" && !scopes.empty()) {
      scopes.pop_back();
    }
    if (word == "{" || word == "}" || word == ";") {
      kind.clear();
      name.clear();
    } else if (kind.empty()) {
      if (word == "module" || word == "interface") kind = word;
    } else if (name.empty()) {
      name = word;
    }
  }
  return interfaces;
}

Result<NewService> in_full(const NewService& service) {
  if (service.interface.find("::") != std::string::npos) return service;
  const auto files = with_included({service.idl_file});
  if (!files) return files.error();
  const auto own = std::filesystem::path(service.idl_file).filename().string();
  const auto matches = [&](const std::string& text) {
    auto found = interfaces_in(text);
    std::erase_if(found, [&](const auto& name) { return name != service.interface && !name.ends_with("::" + service.interface); });
    return found;
  };
  auto found = matches(files->at(own));
  for (const auto& [name, text] : *files) {
    if (name == own || !found.empty()) continue;
    for (auto& further : matches(text)) found.push_back(std::move(further));
  }
  if (found.empty() || std::ranges::find(found, service.interface) != found.end()) return service;
  if (found.size() > 1)
    return Error{"service port " + base::in_quotes(service.port) + ": interface " + base::in_quotes(service.interface) + " may be any of " +
                 base::join(found, ", ") + "; name it in full"};
  auto full = service;
  full.interface = found.front();
  return full;
}

Result<std::map<std::string, std::string>> with_included(const std::vector<std::string>& files) {
  std::map<std::string, std::string> all;
  for (const auto& file : files) {
    if (const auto done = collect(file, all); !done) return done.error();
  }
  return all;
}

bool defines_type(const std::map<std::string, std::string>& idl, const std::string& type) {
  const auto colon = type.rfind("::");
  const auto name = colon == std::string::npos ? type : type.substr(colon + 2);
  const std::regex definition("(struct|union)\\s+" + name + "\\b|typedef\\b[^;]*\\b" + name + "\\s*;");
  return std::ranges::any_of(idl, [&](const auto& file) { return std::regex_search(file.second, definition); });
}

}  // namespace tools
