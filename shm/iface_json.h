// Converts infos, samples and frame headers of all iface types to JSON, by the table of types. One thread per Iface.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "shm/client.h"
#include "shm/lockstep.h"

namespace simctl {

nlohmann::ordered_json info_json(const shm::Iface& iface);
// Only after the iface has been read.
nlohmann::ordered_json sample_json(const shm::Iface& iface);
nlohmann::ordered_json frame_json(const shm::HeldFrame& frame);
// Those that take part in lock step, with their times.
nlohmann::ordered_json participants_json(const std::vector<shm::ParticipantRecord>& participants);

}  // namespace simctl
