#include "campaign/run/spawned_models.h"

#include <filesystem>

#include "base/text.h"
#include "campaign/rows/model_files.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;

Result<void> find_one(const Plan& plan, const ModelFiles& models, Event& event, std::set<std::string>& files) {
  const bool is_text = event.target.find('<') != std::string::npos;
  if (event.kind != Event::Kind::spawn || is_text || event.target.starts_with("http")) return {};
  std::error_code ignored;  // what is not there is looked for among the models
  if (event.target.find("://") == std::string::npos) {
    for (const auto& folder : {fs::path(plan.folder()), fs::path(".")}) {
      const auto file = fs::absolute(folder / event.target, ignored).lexically_normal();
      if (!fs::exists(file, ignored)) continue;
      set_spawned(event, file.string());
      break;
    }
  }
  if (models.add_model(event.target, files)) return {};
  return Error{"plan " + base::in_quotes(plan.file) + ": events: there is no model " + base::in_quotes(event.target) +
               " to spawn; expected a file, a folder or model://NAME"};
}

}  // namespace

Result<std::set<std::string>> find_spawned(Plan& plan) {
  const ModelFiles models(fs::absolute(plan.run.world).parent_path(), plan.run.resource_paths);
  std::set<std::string> files;
  for (auto* events : {&plan.events, &plan.hunt.events}) {
    for (auto& event : *events) {
      if (const auto found = find_one(plan, models, event, files); !found) return found.error();
    }
  }
  return files;
}

}  // namespace campaign
