#include "run/module_files.h"

#include <cstdlib>
#include <system_error>

namespace tools {

ModuleKind module_kind(const std::string& type, const std::vector<std::string>& folders) {
  std::error_code error;
  for (const auto& folder : folders) {
    const std::filesystem::path path(folder);
    if (std::filesystem::exists(path / (type + ".so"), error)) return ModuleKind::library;
    if (std::filesystem::exists(path / (type + ".py"), error)) return ModuleKind::python;
  }
  return ModuleKind::none;
}

bool is_module(const std::filesystem::path& file) { return file.extension() == ".so" || file.extension() == ".py"; }

std::string module_names(const std::string& type) { return type + ".so or " + type + ".py"; }

std::map<std::string, std::string> same_python() {
  std::map<std::string, std::string> variables;
  for (const auto& [name, value] :
       {std::pair{"PYTHONHASHSEED", "0"}, std::pair{"OPENBLAS_NUM_THREADS", "1"}, std::pair{"OMP_NUM_THREADS", "1"},
        std::pair{"NPY_DISABLE_CPU_FEATURES", "FMA3 AVX2 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL"}}) {
    if (std::getenv(name) == nullptr) variables[name] = value;
  }
  return variables;
}

}  // namespace tools
