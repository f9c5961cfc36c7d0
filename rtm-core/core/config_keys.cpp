#include "core/config_keys.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/text.h"
#include "core/component_argument.h"
#include "core/connector_settings.h"
#include "core/preconnect.h"

namespace rt {
namespace {

using enum KeyKind;

// Keys that other programs give a meaning to but that change nothing here are listed too: a file written for them draws no warning.
constexpr ConfigKey keys[] = {
    {"config.version", "2.1"},
    {"config_file", ""},
    {"openrtm.*", ""},
    {"os.*", ""},
    {"corba.args", ""},
    {"corba.endpoint", ""},
    {"corba.endpoints", ""},
    {"corba.endpoint_property", "ipv4", choices, "ipv4,ipv6"},
    {"corba.endpoints_ipv4", ""},
    {"corba.endpoints_ipv6", ""},
    {"corba.open_to", "", choices, "account,host,network"},
    {"corba.max_request_size", "2M", size},
    {"corba.unix_socket", "YES", boolean},
    {"corba.call_timeout", "10", number},
    {"corba.peer_check_interval", "2", number},
    {"corba.id", "omniORB"},
    {"corba.nameservers", "localhost", addresses},
    {"corba.nameservice.replace_endpoint", "NO", boolean},
    {"corba.master_manager", "localhost:2810", addresses},
    {"corba.update_master_manager.enable", "YES", boolean},
    {"corba.update_master_manager.interval", "10.0", number},
    {"manager.update_master_manager.enable", "", boolean},
    {"manager.update_master_manager.interval", "", number},
    {"corba.alternate_iiop_addresses", "", addresses},
    {"corba.ssl.*", ""},
    {"corba.tls.certificate", ""},
    {"corba.tls.authority", ""},
    {"corba.tls.password", ""},
    {"corba.tls.endpoints", ""},
    {"naming.enable", "YES", boolean},
    {"naming.type", "corba", choices, "corba,manager"},
    {"naming.formats", "%h.host_cxt/%n.rtc"},
    {"naming.update.enable", "YES", boolean},
    {"naming.update.interval", "10.0", number},
    {"naming.update.rebind", "NO", boolean},
    {"naming.update.timeout", "1.0", number},
    {"naming.names", ""},
    {"logger.enable", "YES", boolean},
    {"logger.file_name", "stderr"},
    {"logger.date_format", "%b %d %H:%M:%S.%Q"},
    {"logger.log_level", "INFO", level},
    {"logger.stream_lock", "NO", boolean},
    {"logger.master_logger", ""},
    {"logger.clock_type", "", choices, "system,logical,adjusted"},
    {"logger.escape_sequence_enable", "NO", boolean},
    {"logger.plugins", ""},
    {"logger.logstream.*", ""},
    {"logger.logging", ""},
    {"manager.name", "manager"},
    {"manager.instance_name", "manager"},
    {"manager.naming_formats", "%h.host_cxt/%n.mgr"},
    {"manager.nameservers", "", addresses},
    {"manager.pid", ""},
    {"manager.os.*", ""},
    {"manager.refstring_path", "/var/log/rtcmanager.ref"},
    {"manager.is_master", "NO", boolean},
    {"manager.corba_servant", "YES", boolean},
    {"manager.shutdown_on_nortcs", "YES", boolean},
    {"manager.shutdown_onrtcs", "YES", boolean},
    {"manager.shutdown_auto", "YES", boolean},
    {"manager.auto_shutdown_duration", "20.0", number},
    {"manager.termination_waittime", "0.5", number},
    {"manager.cpu_affinity", "", processors},
    {"manager.command", ""},
    {"manager.language", "C++"},
    {"manager.supported_languages", "C++"},
    {"manager.remote_rights", "components", choices, "read,components,everything"},
    {"manager.components.naming_policy", "process_unique"},
    {"manager.components.precreate", "", components},
    {"manager.components.preconnect", "", connections},
    {"manager.components.preactivation", ""},
    {"manager.modules.load_path", "./"},
    {"manager.modules.config_path", ""},
    {"manager.modules.config_ext", ""},
    {"manager.modules.detect_loadable", "YES", boolean},
    {"manager.modules.preload", ""},
    {"manager.modules.init_func_prefix", ""},
    {"manager.modules.init_func_suffix", "Init"},
    {"manager.modules.abs_path_allowed", "YES", boolean},
    {"manager.modules.download_allowed", "NO", boolean},
    {"manager.modules.download_dir", ""},
    {"manager.modules.download_cleanup", "", text},
    {"manager.modules.download_retain", "", text},
    {"manager.modules.search_auto", "YES", boolean},
    {"manager.modules.C++.*", ""},
    {"manager.modules.Python.*", ""},
    {"manager.modules.Python3.*", ""},
    {"manager.modules.Java.*", ""},
    {"manager.preload.modules", ""},
    {"manager.local_service.enabled_services", "ALL"},
    {"manager.local_service.modules", ""},
    {"manager.local_service.*", ""},
    {"manager.loadable_modules.*", ""},
    {"execution_contexts", ""},
    {"exec_cxt.periodic.type", "PeriodicExecutionContext"},
    {"exec_cxt.periodic.rate", "1000", number},
    {"exec_cxt.event_driven.type", "EventDrivenExecutionContext"},
    {"exec_cxt.evdriven.type", ""},
    {"exec_cxt.sync_transition", "YES", boolean},
    {"exec_cxt.sync_activation", "", boolean},
    {"exec_cxt.sync_deactivation", "", boolean},
    {"exec_cxt.sync_reset", "", boolean},
    {"exec_cxt.transition_timeout", "0.5", number},
    {"exec_cxt.activation_timeout", "", number},
    {"exec_cxt.deactivation_timeout", "", number},
    {"exec_cxt.reset_timeout", "", number},
    {"exec_cxt.callback_timeout", "5", number},
    {"exec_cxt.member_timeout", "", number},
    {"exec_cxt.cpu_affinity", "", processors},
    {"exec_cxt.*", ""},
    {"ec.*", ""},
    {"periodic_task.*", ""},
    {"timer.enable", "YES", boolean},
    {"timer.tick", "0.1", number},
    {"sdo.service.provider.enabled_services", "ALL"},
    {"sdo.service.provider.providing_services", ""},
    {"sdo.service.consumer.enabled_services", "ALL"},
    {"sdo.service.consumer.available_services", ""},
    {"sdo.service.*", ""},
    {"ros2.*", ""},  // of the module ROS2Transport
    {"fast-rtps.*", ""},
    {"port.*", ""},
    {"conf.*", ""},
    {"configuration.*", ""},
};

bool matches(const ConfigKey& key, std::string_view name) {
  if (!key.name.ends_with(".*")) return key.name == name;
  const auto prefix = key.name.substr(0, key.name.size() - 1);
  return name.size() > prefix.size() && name.starts_with(prefix);
}

std::string_view first_part(std::string_view key) { return key.substr(0, key.find('.')); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const auto above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string suggestion_for(std::string_view key) {
  constexpr std::size_t longest = 64;
  if (key.size() > longest) return {};
  std::size_t best = 4;
  std::string_view nearest;
  for (const auto& candidate : keys) {
    const auto distance = edit_distance(key, candidate.name);
    if (distance < best) {
      best = distance;
      nearest = candidate.name;
    }
  }
  return nearest.empty() ? std::string() : ", did you mean " + std::string(nearest) + "?";
}

bool is_address(std::string_view text) {
  for (const std::string_view scheme : {"corbaloc:", "corbaname:", "IOR:"}) {
    if (text.starts_with(scheme)) return text.size() > scheme.size();
  }
  if (text.find_first_of(" \t/?&") != std::string_view::npos) return false;
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || text.ends_with(']')) return !text.empty();
  const auto port = base::parse_integer(text.substr(colon + 1));
  return port && *port > 0 && *port <= 65535;
}

bool is_processor(std::string_view text) {
  const auto number = base::parse_integer(text);
  return number && *number >= 0;
}

bool is_one_of(std::string_view text, std::string_view choices) {
  for (const auto& choice : base::split_list(choices)) {
    if (base::equal_ignoring_case(text, choice)) return true;
  }
  return false;
}

// Entries of a list that do not fit; the others count.
template <class Fits>
std::optional<Complaint> complain_about_entries(std::string_view value, const char* expectation, Fits fits) {
  for (const auto& entry : base::split_list(value)) {
    if (!fits(entry)) return Complaint{expectation + std::string(", got ") + base::in_quotes(entry), true};
  }
  return std::nullopt;
}

template <class Parse>
std::optional<Complaint> complain_about_requests(std::string_view value, Parse parse) {
  for (const auto& entry : base::split_list(value)) {
    if (const auto parsed = parse(entry); !parsed) return Complaint{parsed.error().message, true};
  }
  return std::nullopt;
}

std::optional<Complaint> complain_about_value(const ConfigKey& key, std::string_view value) {
  if (value.empty()) return std::nullopt;
  const auto used_instead = key.default_value.empty() ? std::string() : "; " + std::string(key.default_value) + " is used";
  const auto wrong = [&](const std::string& expectation) {
    return Complaint{expectation + ", got " + base::in_quotes(value) + used_instead, false};
  };
  switch (key.kind) {
    case boolean:
      if (!base::parse_bool(value)) return wrong("must be YES or NO");
      break;
    case number: {
      const auto parsed = base::parse_number(value);
      if (!parsed || *parsed < 0) return wrong("must be a number that is not negative");
      break;
    }
    case level: {
      constexpr std::string_view levels = "SILENT,FATAL,ERROR,WARN,INFO,NORMAL,DEBUG,TRACE,VERBOSE,PARANOID";
      if (!is_one_of(value, levels)) return wrong("must be one of SILENT, FATAL, ERROR, WARN, INFO, DEBUG, TRACE, VERBOSE, PARANOID");
      break;
    }
    case choices:
      for (const auto& entry : base::split_list(value)) {
        if (!is_one_of(entry, key.choices)) return wrong("must be of " + base::join(base::split_list(key.choices), ", "));
      }
      break;
    case addresses:
      return complain_about_entries(value, "must be host or host:port", is_address);
    case processors:
      return complain_about_entries(value, "must be numbers of processors", is_processor);
    case connections:
      return complain_about_requests(value, parse_connection);
    case components:
      return complain_about_requests(value, parse_component_argument);
    case size:
      if (!parse_size(value)) return wrong("must be a number of bytes, such as 500000, 64k or 2M");
      break;
    case text:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::span<const ConfigKey> config_keys() { return keys; }

std::optional<Complaint> complain_about(std::string_view key, std::string_view value) {
  const auto* const known = std::find_if(std::begin(keys), std::end(keys), [&](const auto& k) { return matches(k, key); });
  if (known != std::end(keys)) {
    auto complaint = complain_about_value(*known, value);
    if (complaint) complaint->text.insert(0, std::string(key) + (known->kind == connections || known->kind == components ? ": " : " "));
    return complaint;
  }
  const bool is_group =
      std::any_of(std::begin(keys), std::end(keys), [&](const auto& k) { return first_part(k.name) == first_part(key) && k.name != key; });
  const bool is_component_key = !is_group && std::count(key.begin(), key.end(), '.') >= 2;
  if (is_component_key) return std::nullopt;
  return Complaint{"unknown key " + base::in_quotes(key) + suggestion_for(key), true};
}

}  // namespace rt
