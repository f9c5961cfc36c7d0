#include "ranger_component.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace iface {
namespace {

bool is_all(double low, double high) { return low == 0 && high == 0; }

// Of a scan with these angles; 1 beam when it has none.
double beams_after(double angle, const RTC::RangerConfig& sensor) { return (angle - sensor.minAngle) / sensor.angularRes; }
bool has_angles(const RTC::RangerConfig& sensor) { return sensor.angularRes > 0 && sensor.maxAngle > sensor.minAngle; }

// Calls keep(to, from) for each value that stays, in ascending order; the count of them.
template <class Keep>
CORBA::ULong keep_beams(const RTC::RangerConfig& wanted, const RTC::RangerConfig& sensor, CORBA::ULong count, Keep keep) {
  if (!has_angles(sensor)) {
    for (CORBA::ULong i = 0; i < count; ++i) keep(i, i);
    return count;
  }
  const auto first = static_cast<CORBA::ULong>(std::lround(std::max(0.0, beams_after(wanted.minAngle, sensor))));
  const auto last = static_cast<CORBA::ULong>(std::lround(std::max(0.0, beams_after(wanted.maxAngle, sensor))));
  const auto step = static_cast<CORBA::ULong>(std::max(1L, std::lround(wanted.angularRes / sensor.angularRes)));
  CORBA::ULong kept = 0;
  for (CORBA::ULong from = first; from <= last && from < count; from += step) keep(kept++, from);
  return kept;
}

}  // namespace

RTC::RangerConfig possible(const RTC::RangerConfig& sensor, const RTC::RangerConfig& wanted) {
  constexpr double rounding = 1e-6;  // of a beam
  RTC::RangerConfig result = sensor;
  if (has_angles(sensor)) {
    const double last_beam = std::round(beams_after(sensor.maxAngle, sensor));
    double first = 0, last = last_beam;
    if (!is_all(wanted.minAngle, wanted.maxAngle)) {
      first = std::clamp(std::ceil(beams_after(wanted.minAngle, sensor) - rounding), 0.0, last_beam);
      last = std::clamp(std::floor(beams_after(wanted.maxAngle, sensor) + rounding), first, last_beam);
    }
    const double step = std::clamp(std::round(wanted.angularRes / sensor.angularRes), 1.0, last_beam + 1);
    if (first > 0 || last < last_beam || step > 1) {  // else the very numbers of the sensor
      result.minAngle = sensor.minAngle + first * sensor.angularRes;
      result.maxAngle = result.minAngle + std::floor((last - first) / step) * step * sensor.angularRes;
      result.angularRes = step * sensor.angularRes;
    }
  }
  if (!is_all(wanted.minRange, wanted.maxRange)) {
    result.minRange = std::clamp(wanted.minRange, sensor.minRange, sensor.maxRange);
    result.maxRange = std::clamp(wanted.maxRange, result.minRange, sensor.maxRange);
  }
  return result;
}

void cut(const RTC::RangerConfig& wanted, RTC::RangeData& data) {
  const auto kept = keep_beams(wanted, data.config, data.ranges.length(), [&](CORBA::ULong to, CORBA::ULong from) {
    data.ranges[to] = std::clamp(data.ranges[from], wanted.minRange, wanted.maxRange);
  });
  data.ranges.length(kept);
  data.config = wanted;
}

void cut(const RTC::RangerConfig& wanted, RTC::IntensityData& data) {
  const auto kept = keep_beams(wanted, data.config, data.intensities.length(),
                               [&](CORBA::ULong to, CORBA::ULong from) { data.intensities[to] = data.intensities[from]; });
  data.intensities.length(kept);
  data.config = wanted;
}

void RangerService::describe(const RTC::RangerGeometry& geometry, const RTC::RangerConfig& sensor) {
  auto state = state_.lock();
  state->geometry = geometry;
  state->sensor = sensor;
}

std::optional<RTC::RangerConfig> RangerService::wanted() const {
  const auto state = state_.lock();
  if (!state->asked) return std::nullopt;
  return possible(state->sensor, *state->asked);
}

RTC::RangerGeometry* RangerService::GetGeometry() { return new RTC::RangerGeometry(state_.lock()->geometry); }

RTC::RangerConfig RangerService::GetConfig() {
  const State state = state_.snapshot();
  return state.asked ? possible(state.sensor, *state.asked) : state.sensor;
}

void RangerService::SetConfig(const RTC::RangerConfig& config) {
  const double values[] = {config.minAngle, config.maxAngle, config.angularRes, config.minRange,
                           config.maxRange, config.rangeRes, config.frequency};
  const bool is_finite = std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  if (!is_finite || config.minAngle > config.maxAngle || config.minRange > config.maxRange) {
    const auto interval = [](double low, double high) { return std::to_string(low) + " to " + std::to_string(high); };
    say_(true, "SetConfig: expected finite numbers, each minimum up to its maximum, got angles " +
                   interval(config.minAngle, config.maxAngle) + " rad and ranges " + interval(config.minRange, config.maxRange) +
                   " m; ignored");
    return;
  }
  state_.lock()->asked = config;
}

RangerComponent::RangerComponent(RTC::Manager* manager, const Specification& specification, shm::IfaceType type)
    : IfaceComponent(manager, specification, type, true), service_port_("ranger"), service_(say()) {}

void RangerComponent::addRangerPort() {
  service_port_.registerProvider("ranger", "RTC::Ranger", service_);
  addPort(service_port_);
}

RTC::ReturnCode_t RangerComponent::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* device = link().live();
  if (device != nullptr && !service_.is_on()) {
    device->unsubscribe();
    return RTC::RTC_OK;
  }
  if (device != nullptr && !device->is_subscribed()) {
    const auto done = device->subscribe();
    if (!done && !has_failed_) RTC_WARN(("%s", done.error().message.c_str()));
    has_failed_ = !done;
  }
  publish_newest();
  return RTC::RTC_OK;
}

}  // namespace iface
