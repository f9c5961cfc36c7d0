// The limits of a joint's axes, and the whole turns of its angles, as ODE has them from step to step; see joints.h.
#include <algorithm>
#include <cmath>

#include "physics/joint_frames.h"
#include "physics/joints.h"

namespace sim {
namespace {

constexpr double hair = 1e-6;  // [rad] or [m] beyond a stop that is left to ODE

// The nearest number of them.
int whole_turns(double angle) { return static_cast<int>(std::lround(std::clamp(angle / whole_turn, -1e9, 1e9))); }

}  // namespace

void JointInstance::read_stops(int i, double dt) {
  const AxisDef& axis = def_->axes[static_cast<std::size_t>(i)];
  Stops& stops = stops_[static_cast<std::size_t>(i)];
  const auto is_limit = [&](double v) { return std::isfinite(v) && std::abs(v) <= 1e10 && def_->kind != JointDef::Kind::continuous; };
  if (is_limit(axis.lower)) stops.low = axis.lower;
  if (is_limit(axis.upper)) stops.high = axis.upper;
  if (!(stops.low <= stops.high)) stops.low = -infinite, stops.high = infinite;
  stops.counts_turns = turns(i) && !is_screw() && (stops.exists() || axis.spring_stiffness != 0);
  std::optional<double> erp = def_->stop_erp, cfm = def_->stop_cfm;
  if (axis.limit_stiffness && std::isfinite(*axis.limit_stiffness)) {
    const double spring = dt * *axis.limit_stiffness, both = spring + axis.limit_dissipation.value_or(0);
    if (both > 0) erp = spring / both, cfm = 1 / both;
  }
  stops.is_soft = cfm && *cfm > 0;
  stops.erp = stops.erp_in_ode = std::clamp(erp.value_or(dWorldGetERP(world_)), 0.0, 1.0);
  if (cfm) set_stop_parameter(i, dParamStopCFM, std::clamp(*cfm, 0.0, 1e9));
  set_stop_parameter(i, dParamStopERP, stops.erp);
}

// Those of a screw hold its way.
void JointInstance::set_stop_parameter(int i, int parameter, double value) {
  is_screw() ? dJointSetPistonParam(joint_.id(), parameter, value) : set_parameter(i, parameter, value);
}

// As ODE is to have them in the next step. `rate`: of the axis now.
void JointInstance::set_stops(int i, double rate, double dt) {
  constexpr double lock_rate = 1;  // [rad/s] or [m/s] at which a joint is brought to the only place that it may have
  const Stops& stops = stops_[static_cast<std::size_t>(i)];
  const Place& place = places_[static_cast<std::size_t>(i)];
  double low = place.low, high = place.high, erp = stops.erp;
  const double way = 1.5 * rate * dt;  // forces of the step may add to it
  if (stops.is_lock()) {
    const double reach = lock_rate * dt / std::max(stops.erp, 1e-3);
    low = high = place.position + std::clamp(stops.low - place.position, -reach, reach);
    if (std::abs(stops.low - place.position) <= reach) low = high = stops.low;
  } else if (!stops.is_soft && place.position < high && place.position + way > high) {
    // It arrives at the stop in this step, and may come as far as that: a stop that has been passed by one, with the error reduction that
    // asks for the rate of the rest of the way.
    erp = place.position - high;
    low = -infinite, high = place.position - 1;
  } else if (!stops.is_soft && place.position > low && place.position + way < low) {
    erp = low - place.position;
    high = infinite, low = place.position + 1;
  }
  low -= place.turns * whole_turn, high -= place.turns * whole_turn;
  const double scale = is_screw() ? sign_ * coupling_->ratio : sign_;
  low *= scale, high *= scale;
  if (scale < 0) std::swap(low, high);
  put_stops(i, low, high, erp);
}

void JointInstance::put_stops(int i, double low, double high, double erp) {
  Stops& stops = stops_[static_cast<std::size_t>(i)];
  if (erp != stops.erp_in_ode) set_stop_parameter(i, dParamStopERP, stops.erp_in_ode = erp);
  if (low == stops.low_in_ode && high == stops.high_in_ode) return;
  stops.low_in_ode = low, stops.high_in_ode = high;
  // ODE rejects a low stop above the high one that is there, so that the low one is set again.
  set_stop_parameter(i, dParamLoStop, low);
  set_stop_parameter(i, dParamHiStop, high);
  set_stop_parameter(i, dParamLoStop, low);
}

void JointInstance::begin(double dt, bool is_saved) {
  is_followed_ = false;
  for (int i = 0; i < axis_count(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Stops& stops = stops_[n];
    if (!stops.exists() && !stops.counts_turns) continue;
    is_followed_ = true;
    Place& place = places_[n];
    const double seen = within_turn(i).position;
    place = {seen, 0, stops.low, stops.high};
    if (stops.counts_turns) {
      place.turns = whole_turns(def_->axes[n].initial_position - seen);
      place.position += place.turns * whole_turn;
      // Of all turns those within the limits.
      const double missing = place.position < stops.low    ? std::ceil((stops.low - place.position) / whole_turn)
                             : place.position > stops.high ? std::floor((stops.high - place.position) / whole_turn)
                                                           : 0;
      const double moved = place.position + missing * whole_turn;
      if (is_saved && moved >= stops.low && moved <= stops.high) place.turns += static_cast<int>(missing), place.position = moved;
    }
    if (!stops.is_soft && !stops.is_lock()) {
      if (place.position < stops.low - hair) place.low = place.position;
      if (place.position > stops.high + hair) place.high = place.position;
    }
    set_stops(i, 0, dt);
  }
}

void JointInstance::follow(double dt) {
  remember_hinge();
  for (int i = 0; i < axis_count(); ++i) {
    const Stops& stops = stops_[static_cast<std::size_t>(i)];
    if (!stops.exists() && !stops.counts_turns) continue;
    Place& place = places_[static_cast<std::size_t>(i)];
    const JointState seen = within_turn(i);
    const double before = place.position;
    if (stops.counts_turns) {
      // ODE adds a body's rate to its quaternion and makes that a unit again: so far does it turn, less than half a turn.
      place.turns = whole_turns(before + 2 * std::atan(0.5 * dt * seen.velocity) - seen.position);
    }
    place.position = seen.position + place.turns * whole_turn;
    if (!stops.is_soft && !stops.is_lock()) move_stops(i, before, dt);
    set_stops(i, seen.velocity, dt);
  }
}

// A stop that was passed is where the joint came to, and goes back slowly: ODE would give the joint a fifth of the rate at which it came.
void JointInstance::move_stops(int i, double before, double dt) {
  constexpr double back = 0.01;  // [rad/s] or [m/s]
  const Stops& stops = stops_[static_cast<std::size_t>(i)];
  Place& place = places_[static_cast<std::size_t>(i)];
  const double now = place.position;
  if (before < place.high && now > place.high + hair)
    place.high = now;
  else if (place.high > stops.high)
    place.high = std::max(stops.high, std::min(place.high - back * dt, now));
  if (before > place.low && now < place.low - hair)
    place.low = now;
  else if (place.low < stops.low)
    place.low = std::min(stops.low, std::max(place.low + back * dt, now));
}

void JointInstance::take(const Places& places, double dt) {
  places_ = places;
  for (int i = 0; i < axis_count(); ++i) {
    const Stops& stops = stops_[static_cast<std::size_t>(i)];
    if (!stops.exists() && !stops.counts_turns) continue;
    Place& place = places_[static_cast<std::size_t>(i)];
    const JointState seen = within_turn(i);
    if (stops.counts_turns) place.turns = whole_turns(place.position - seen.position);
    place.position = seen.position + place.turns * whole_turn;
    set_stops(i, seen.velocity, dt);
  }
}

bool JointInstance::has_history(int axis) const {
  const Place& place = places_[static_cast<std::size_t>(axis)];
  const Stops& stops = stops_[static_cast<std::size_t>(axis)];
  return place.turns != 0 || place.low != stops.low || place.high != stops.high;
}

// As ODE sees it in the next step.
bool JointInstance::is_at_stop() const {
  const Stops& stops = stops_[0];
  const double position = sign_ * within_turn(0).position;
  return position <= stops.low_in_ode || position >= stops.high_in_ode;
}

}  // namespace sim
