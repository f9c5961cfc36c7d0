// Common base of RTCLaser and RTCSonar: the service port `ranger` (RTC::Ranger of the RT Component interface guidelines).
//
// Power: without it the sensor does not work and nothing is sent. SetConfig: scans are cut to the angles that are asked for, to every n-th
// beam and to the ranges; an interval from 0 to 0 means all. What the sensor can't do is cut to what it can; GetConfig says what counts.
// Rate and range resolution are those of the sensor.
#pragma once

#include <rtm/ext/RangerSkel.h>

#include <base/guarded.h>
#include <rtm/CorbaPort.h>

#include <optional>

#include "iface_component.h"

namespace iface {

// The part of `wanted` that the sensor can do [rad, m, Hz]. Pure.
RTC::RangerConfig possible(const RTC::RangerConfig& sensor, const RTC::RangerConfig& wanted);
// Cuts a scan of the sensor to a configuration that is possible() for it. Beams of a sensor without scan angles all stay.
void cut(const RTC::RangerConfig& wanted, RTC::RangeData& data);
// The same of intensities that were made for all beams of `sensor`.
void cut(const RTC::RangerConfig& wanted, RTC::IntensityData& data);

// Calls from any thread, answered at once, also while simulated time stands still; they count from the next scan on.
class RangerService : public virtual POA_RTC::Ranger, public virtual PortableServer::RefCountServantBase {
 public:
  explicit RangerService(Say say) : say_(std::move(say)) {}
  void describe(const RTC::RangerGeometry& geometry, const RTC::RangerConfig& sensor);
  bool is_on() const { return state_.lock()->is_on; }
  bool sends_intensities() const { return state_.lock()->sends_intensities; }
  // Nothing: the sensor's own.
  std::optional<RTC::RangerConfig> wanted() const;

  RTC::RangerGeometry* GetGeometry() override;
  void Power(CORBA::Boolean enable) override { state_.lock()->is_on = enable; }
  void EnableIntensities(CORBA::Boolean enable) override { state_.lock()->sends_intensities = enable; }
  RTC::RangerConfig GetConfig() override;
  void SetConfig(const RTC::RangerConfig& config) override;

 private:
  struct State {
    bool is_on = true, sends_intensities = true;
    RTC::RangerGeometry geometry;
    RTC::RangerConfig sensor{};
    std::optional<RTC::RangerConfig> asked;
  };
  Say say_;
  base::Guarded<State, base::Rank::details> state_;
};

class RangerComponent : public IfaceComponent {
 public:
  RangerComponent(RTC::Manager* manager, const Specification& specification, shm::IfaceType type);
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 protected:
  // To be called in onInitialize.
  void addRangerPort();
  RangerService& service() { return service_; }
  const RangerService& service() const { return service_; }

 private:
  RTC::CorbaPort service_port_;
  RangerService service_;
  bool has_failed_ = false;  // to subscribe; logged once
};

}  // namespace iface
