// Sensors and drives that are out of order on purpose: put a fault on, take it off, show what is on.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "simctl/simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

std::string number_or(const Json& value, const char* otherwise) {
  return value.is_number() ? base::format_number(value.get<double>()) : otherwise;
}

void show_faults(Control& control, const std::string& iface) {
  const auto reply = control.ask(shm::FaultsRequest{iface});
  if (!reply) return;
  const auto json = Json::parse(reply->text, nullptr, false);
  if (control.json() || !json.is_object()) return control.print(json);
  const auto faults = json.value("faults", Json::array());
  if (faults.empty()) return static_cast<void>(std::printf("no faults\n"));
  std::printf("%-40s %-8s %10s %10s %10s\n", "IFACE", "KIND", "AMOUNT", "FROM s", "UNTIL s");
  for (const auto& fault : faults) {
    std::printf("%-40s %-8s %10s %10s %10s%s\n", fault.value("iface", "?").c_str(), fault.value("kind", "?").c_str(),
                number_or(fault.value("amount", Json()), "").c_str(), number_or(fault.value("from", Json()), "").c_str(),
                number_or(fault.value("until", Json()), "").c_str(), fault.value("on", false) ? "" : "  to come");
  }
}

}  // namespace

void fault(Control& control, const FaultOptions& options) {
  if (options.ends) {
    const auto reply = control.ask(shm::EndFaultsRequest{options.iface, options.kind});
    if (reply && control.json()) control.print({{"ended", reply->count}});
    return;
  }
  if (options.kind.empty()) return show_faults(control, options.iface);
  control.ask(shm::FaultRequest{options.iface, options.kind, options.amount, options.seconds});
}

}  // namespace simctl
