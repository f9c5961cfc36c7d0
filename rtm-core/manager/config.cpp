#include "rtm/ManagerConfig.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/text.h"
#include "core/config_file.h"
#include "core/config_keys.h"
#include "core/manager_arguments.h"
#include "rtm/version.h"

namespace RTC {

const char* const ManagerConfig::default_config[] = {
    "config.version", openrtm_version,   "openrtm.name", openrtm_name, "openrtm.version", openrtm_version, "manager.instance_name",
    "manager",        "manager.command", "rtcd",         "",
};

const char* const ManagerConfig::config_file_path[] = {"/etc/rtc.conf", "/etc/rtc/rtc.conf", "/usr/local/etc/rtc.conf",
                                                       "/usr/local/etc/rtc/rtc.conf", nullptr};

namespace {

// The file to read; empty if there is none. The error: a file that was asked for does not exist. In the environment that is a warning only.
base::Result<std::string> find_file(const rt::ManagerArguments& arguments, std::vector<std::string>& warnings) {
  const auto exists = [](const std::string& path) { return std::filesystem::exists(path); };
  const auto missing = [](const std::string& path) { return ": file " + base::in_quotes(path) + ": does not exist"; };
  if (arguments.config_file) {
    if (exists(*arguments.config_file)) return *arguments.config_file;
    if (!arguments.ignore_no_config) return base::Error{"option -f" + missing(*arguments.config_file)};
    return std::string();
  }
  if (const char* named = std::getenv("RTC_MANAGER_CONFIG"); named != nullptr && *named != '\0') {
    if (exists(named)) return std::string(named);
    warnings.push_back("RTC_MANAGER_CONFIG" + missing(named));
  }
  if (exists("./rtc.conf")) return std::string("./rtc.conf");
  for (const auto* path = ManagerConfig::config_file_path; *path != nullptr; ++path) {
    if (exists(*path)) return std::string(*path);
  }
  return std::string();
}

void add_system_information(coil::Properties& properties) {
  utsname system{};
  if (uname(&system) == 0) {
    const std::pair<const char*, const char*> facts[] = {{"name", system.sysname},
                                                         {"release", system.release},
                                                         {"version", system.version},
                                                         {"arch", system.machine},
                                                         {"hostname", system.nodename}};
    for (const auto& [key, value] : facts) {
      properties.setProperty(std::string("os.") + key, value);
      properties.setProperty(std::string("manager.os.") + key, value);
    }
  }
  properties.setProperty("manager.pid", std::to_string(getpid()));
}

}  // namespace

bool ManagerConfig::init(int argc, char** argv, bool strict) {
  const auto fail = [&](int code, const std::string& message) {
    exit_code_ = code;
    error_ = message;
    return false;
  };
  const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  const auto arguments = rt::parse_manager_arguments(words);
  if (!arguments) return fail(2, arguments.error().message);
  if (strict && !arguments->unknown.empty()) return fail(2, "unknown option " + base::in_quotes(arguments->unknown.front()));

  for (const auto& key : rt::config_keys()) {
    if (key.name.ends_with('*')) continue;
    const bool is_shown = !key.default_value.empty() || key.name.starts_with("manager.");
    if (is_shown) properties_.setDefault(std::string(key.name), std::string(key.default_value));
  }
  properties_.setDefaults(default_config);

  const auto file = find_file(*arguments, warnings_);
  if (!file) return fail(2, file.error().message);
  file_ = *file;
  if (!file_.empty()) {
    const auto text = rt::read_text_file(file_);
    if (!text) return fail(2, text.error().message);
    const auto parsed = rt::parse_config(*text);
    for (const auto& finding : parsed.findings) warnings_.push_back(file_ + ":" + std::to_string(finding.line) + ": " + finding.text);
    for (const auto& entry : parsed.entries) {
      const auto complaint = rt::complain_about(entry.key, entry.value);
      const auto where = file_ + ":" + std::to_string(entry.line);
      if (complaint) warnings_.push_back(where + ": " + complaint->text);
      if (complaint && !complaint->takes_value) continue;
      properties_.setProperty(entry.key, entry.value);
      origins_[entry.key] = where;
    }
    properties_.setProperty("config_file", file_);
  }

  add_system_information(properties_);
  if (arguments->is_master) properties_.setProperty("manager.is_master", "YES");
  for (const auto& [key, value] : arguments->overrides) {
    const auto complaint = rt::complain_about(key, value);
    if (complaint && !complaint->takes_value) return fail(2, "option -o: " + complaint->text);
    if (complaint) warnings_.push_back("option -o: " + complaint->text);
    properties_.setProperty(key, value);
    origins_[key] = "option -o";
  }
  if (arguments->port) properties_.setProperty("corba.endpoints", ":" + std::to_string(*arguments->port));
  if (arguments->without_servant) properties_.setProperty("manager.corba_servant", "NO");
  if (!arguments->orb_arguments.empty()) {
    const auto given = properties_.getProperty("corba.args");
    properties_.setProperty("corba.args", given + (given.empty() ? "" : " ") + base::join(arguments->orb_arguments, " "));
  }
  return true;
}

void ManagerConfig::configure(coil::Properties& properties) const { properties << properties_; }

}  // namespace RTC
