#include "system/configuration.h"

#include "system/parameter_check.h"

namespace tools {

const ConfigurationSetView* find_set(const ComponentView& component, const std::string& id) {
  for (const auto& set : component.configuration_sets) {
    if (set.id == id) return &set;
  }
  return nullptr;
}

namespace {

std::string hidden(const ComponentView& component, const std::string& set_id, const std::string& parameter) {
  const auto* set = find_set(component, set_id);
  if (!set) return "";
  for (const auto& [key, value] : set->values) {
    if (key == parameter) return value;
  }
  return "";
}

}  // namespace

bool has_type(const ComponentView& component, const std::string& parameter) { return !hidden(component, "__type__", parameter).empty(); }

std::string value_problem(const ComponentView& component, const std::string& parameter, const std::string& value) {
  const auto problem = type_problem(hidden(component, "__type__", parameter), value);
  return problem.empty() ? constraint_problem(hidden(component, "__constraints__", parameter), value) : problem;
}

Result<void> set_values(const ComponentView& component, const std::string& id,
                        const std::vector<std::pair<std::string, std::string>>& values) {
  const auto what = "component " + component.path + ": setting configuration set " + id;
  bool accepted = false;
  auto called = remote(what + ":", [&] {
    SDOPackage::ConfigurationSet set;
    set.id = id.c_str();
    set.description = "";
    set.configuration_data.length(static_cast<CORBA::ULong>(values.size()));
    for (CORBA::ULong i = 0; i < values.size(); ++i) {
      set.configuration_data[i].name = values[i].first.c_str();
      set.configuration_data[i].value <<= values[i].second.c_str();
    }
    SDOPackage::Configuration_var configuration = configuration_of(component.object);
    accepted = configuration->set_configuration_set_values(set);
  });
  if (called && !accepted) return Error{what + ": rejected"};
  return called;
}

Result<void> use_set(const ComponentView& component, const std::string& id) {
  const auto what = "component " + component.path + ": activating configuration set " + id;
  bool accepted = false;
  auto called = remote(what, [&] {
    SDOPackage::Configuration_var configuration = configuration_of(component.object);
    accepted = configuration->activate_configuration_set(id.c_str());
  });
  if (called && !accepted) return Error{what + ": rejected"};
  return called;
}

}  // namespace tools
