#include "idl_operations.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "base/id.h"
#include "base/text.h"

namespace editor {
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

Result<void> run_omniidl(const std::string& file, const std::filesystem::path& folder) {
  std::vector<std::string> words = {"omniidl", "-bcxx", "-C" + folder.string(), file};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, "omniidl", nullptr, nullptr, arguments.data(), environ) != 0)
    return Error{"omniidl: cannot be started; is package omniidl installed?"};
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) return Error{"IDL file " + base::in_quotes(file) + ": omniidl refused it"};
  return {};
}

std::string answer_for(const std::string& type) {
  if (type == "void") return "return;";
  if (type == "char*") return "return CORBA::string_dup(\"\");";
  if (type.ends_with("*")) return "return new " + type.substr(0, type.size() - 1) + "();";
  if (type.ends_with("_ptr")) return "return " + type.substr(0, type.size() - 4) + "::_nil();";
  return "return " + type + "();";
}

// Types of the interface's own module are written without it.
std::string qualified(const std::string& type, const std::string& scope) {
  if (type.starts_with("::")) return type.substr(2);
  if (type == "void" || type == "char*") return type;
  return scope + type;
}

struct Interface {
  std::vector<std::string> bases;
  std::vector<std::string> lines;
};

Interface read_interface(const std::vector<std::string>& header, const std::string& name) {
  Interface result;
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i] != "class _impl_" + name + " :") continue;
    for (++i; i < header.size() && header[i] != "public:"; ++i) {
      if (const auto at = header[i].find("_impl_"); at != std::string::npos)
        result.bases.push_back(header[i].substr(at + 6, header[i].find_first_of(",{ ", at) - at - 6));
    }
    for (; i < header.size() && header[i] != "};"; ++i) {
      if (header[i].starts_with("virtual ") && header[i].ends_with(" = 0;")) result.lines.push_back(header[i]);
    }
  }
  return result;
}

void collect(const std::vector<std::string>& header, const std::string& name, const std::string& scope, std::set<std::string>& seen,
             std::vector<Operation>& operations) {
  if (!seen.insert(name).second) return;
  const auto interface = read_interface(header, name);
  for (const auto& base : interface.bases) collect(header, base, scope, seen, operations);
  for (const auto& line : interface.lines) {
    const auto text = line.substr(8, line.size() - 8 - 5);
    const auto space = text.rfind(' ', text.find('('));
    const auto type = qualified(text.substr(0, space), scope);
    operations.push_back({type + " " + text.substr(space + 1), answer_for(type)});
  }
}

}  // namespace

Result<std::vector<Operation>> operations_of(const NewService& service) {
  const TemporaryFolder folder;
  if (const auto ran = run_omniidl(service.idl_file, folder.path()); !ran) return ran.error();
  const auto stem = std::filesystem::path(service.idl_file).stem().string();
  std::ifstream in(folder.path() / (stem + ".hh"));
  std::vector<std::string> header;
  for (std::string line; std::getline(in, line);) header.emplace_back(base::trim(line));
  const auto colon = service.interface.rfind("::");
  const auto name = colon == std::string::npos ? service.interface : service.interface.substr(colon + 2);
  const auto scope = colon == std::string::npos ? "" : service.interface.substr(0, colon + 2);
  bool exists = false;
  for (const auto& line : header) exists = exists || line == "class _impl_" + name + " :";
  if (!exists) return Error{"IDL file " + base::in_quotes(service.idl_file) + ": has no interface " + base::in_quotes(service.interface)};
  std::vector<Operation> operations;
  std::set<std::string> seen;
  collect(header, name, scope, seen, operations);
  return operations;
}

}  // namespace editor
