#include "server/pace.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

using namespace std::chrono_literals;

constexpr auto max_behind = 500ms;  // of wall time that is caught up; the rest is given up

double seconds(std::chrono::nanoseconds t) { return static_cast<double>(t.count()) * 1e-9; }

}  // namespace

double Pace::Mark::rate(Wall now, std::chrono::nanoseconds simulated_now) const {
  return seconds(simulated_now - simulated) / seconds(now - wall);
}

void Pace::start(Wall now, std::chrono::nanoseconds simulated) {
  pace_ = watched_ = {now, simulated};
  if (measured_.wall == Wall()) measured_ = pace_;
}

std::optional<Pace::Wall> Pace::due(Wall now, std::chrono::nanoseconds simulated) {
  if (is_free()) return std::nullopt;
  const auto passed = static_cast<double>((simulated - pace_.simulated).count()) / wanted_;
  const auto due = pace_.wall + std::chrono::nanoseconds(std::llround(passed));
  if (now <= due + max_behind) return due;
  pace_ = {now, simulated};  // the watch over shortfalls goes on
  return std::nullopt;
}

bool Pace::measure(Wall now, std::chrono::nanoseconds simulated) {
  const auto wall = now - measured_.wall;
  if (wall < 1s) return false;
  reached_ = measured_.rate(now, simulated);
  load_ = std::clamp(1 - seconds(slept_) / seconds(wall), 0.0, 1.0);
  restart_measurement(now, simulated);
  return true;
}

void Pace::restart_measurement(Wall now, std::chrono::nanoseconds simulated) {
  measured_ = {now, simulated};
  slept_ = 0ns;
}

std::optional<double> Pace::shortfall(Wall now, std::chrono::nanoseconds simulated) {
  if (is_free() || now - watched_.wall < 10s) return std::nullopt;
  const double reached = watched_.rate(now, simulated);
  watched_ = {now, simulated};
  if (reached >= 0.99 * wanted_) return std::nullopt;
  return reached;
}

}  // namespace sim
