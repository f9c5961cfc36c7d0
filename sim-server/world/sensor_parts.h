// Readers of the parts that several kinds of sensors have. What is wrong is one line by the context's complaints. One thread at a time.
#pragma once

#include <array>
#include <string>

#include "world/model_builder.h"
#include "world/sensor_def.h"

namespace sim {

NoiseDef build_noise(pugi::xml_node noise, BuildContext& context);
// Of the element at the path below the node.
NoiseDef noise_at(pugi::xml_node node, const std::string& path, BuildContext& context);
std::array<NoiseDef, 3> noises_at(pugi::xml_node node, const std::string& path, BuildContext& context);

// What is wrong with the sensor, for one line.
std::string must(pugi::xml_node sensor, const std::string& what, const std::string& expected, double got);

// Sensors without rays or pictures of their own (sensor_builder.cpp has the others). Empty, with a finding, when the sensor is left out.
std::optional<DvlDef> build_dvl(pugi::xml_node sensor, BuildContext& context);
InsDef build_ins(pugi::xml_node sensor, BuildContext& context);
std::optional<RfidDef> build_rfid(pugi::xml_node sensor, BuildContext& context);
RfidTagDef build_rfid_tag(pugi::xml_node sensor);
std::optional<RadioDef> build_radio(pugi::xml_node sensor, BuildContext& context);
std::optional<WheelsDef> build_wheels(pugi::xml_node sensor, BuildContext& context);
std::optional<LocalizationDef> build_localization(pugi::xml_node sensor, BuildContext& context);

}  // namespace sim
