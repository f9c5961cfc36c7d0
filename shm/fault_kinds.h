// The table of faults that can be injected into a sensor, drive or joint, one row each. Requests, options, completion and their
// implementation use this table. Constants; any thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace shm {

enum class FaultKind : unsigned char { off, stuck, bias, noise, missing, latency, dropout, weak, halted };

struct FaultRow {
  std::string_view name;
  FaultKind kind;
  bool is_of_drive = false;
  std::optional<double> amount{};         // the usual one; nothing: it has none
  double min_amount = 0, max_amount = 0;  // of the amount
  std::string_view meaning;
};

inline constexpr std::array fault_rows = {
    FaultRow{"off", FaultKind::off, false, {}, 0, 0, "no samples"},
    FaultRow{"stuck", FaultKind::stuck, false, {}, 0, 0, "the same sample again and again"},
    FaultRow{"bias", FaultKind::bias, false, 0.5, -1e6, 1e6, "added to ranges, positions of joints, or every number that is measured"},
    FaultRow{"noise", FaultKind::noise, false, 0.1, 0, 1e6, "standard deviation of what is added"},
    FaultRow{"missing", FaultKind::missing, false, 0.2, 0, 1, "fraction of the beams, always the same ones"},
    FaultRow{"latency", FaultKind::latency, false, 5, 1, 1000, "delay in samples"},
    FaultRow{"dropout", FaultKind::dropout, false, 0.5, 0, 1, "fraction of the samples"},
    FaultRow{"weak", FaultKind::weak, true, 0.5, 0, 1,
             "fraction of the speed asked for that a drive reaches, or of the highest effort that a joint has left"},
    FaultRow{"halted", FaultKind::halted, true, {}, 0, 0, "a drive or joint keeps its last command"},
};

constexpr const FaultRow* find_fault(std::string_view name) {
  for (const FaultRow& row : fault_rows) {
    if (row.name == name) return &row;
  }
  return nullptr;
}
constexpr const FaultRow& row_of(FaultKind kind) { return fault_rows[static_cast<std::size_t>(kind)]; }

// "off, stuck, bias, ...".
std::string fault_names();
// The row of the name. The error: there is none, or its amount cannot be this one; nothing stands for the usual amount.
base::Result<const FaultRow*> check_fault(std::string_view name, std::optional<double> amount);

}  // namespace shm
