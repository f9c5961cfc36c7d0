#include "rays/noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace sim {
namespace {

std::uint64_t mix(std::uint64_t z) { return base::mix64(z + base::mix64_step); }

// The bell curve in layers of equal area (a ziggurat): almost every number costs one draw, one multiplication and one comparison.
struct Layers {
  static constexpr int count = 256;
  static constexpr double end = 3.6541528853610088, area = 0.00492867323399;  // where the lowest layer's tail begins; of each layer
  double x[count + 1], height[count + 1];

  Layers() {
    const auto bell = [](double v) { return std::exp(-0.5 * v * v); };
    x[0] = area / bell(end);  // the width that the lowest layer with its tail would have as a box
    x[1] = end;
    for (int i = 2; i < count; ++i) x[i] = std::sqrt(-2 * std::log(area / x[i - 1] + bell(x[i - 1])));
    x[count] = 0;
    for (int i = 0; i <= count; ++i) height[i] = bell(x[i]);
  }
};

double quantised(double value, double step) { return step > 0 ? std::round(value / step) * step : value; }

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) : key_(mix(seed)) {
  for (const char c : name) key_ = mix(key_ ^ static_cast<unsigned char>(c));
}

RandomStream RandomStream::at(std::uint64_t number) const {
  RandomStream stream;
  stream.key_ = mix(key_ ^ mix(number));
  return stream;
}

std::uint64_t RandomStream::next() { return mix(key_ + mix(++counter_)); }

namespace {

double uniform_of(std::uint64_t bits) { return (static_cast<double>(bits >> 11) + 0.5) * 0x1.0p-53; }

// One number of the bell curve, from as many draws of 64 bits as it takes.
template <class Draw>
double gaussian_from(const Layers& layers, const Draw& draw) {
  while (true) {
    const std::uint64_t bits = draw();
    const auto layer = static_cast<std::size_t>(bits & 255);
    const double sign = (bits & 256) != 0 ? -1 : 1;
    const double v = static_cast<double>(bits >> 11) * 0x1.0p-53 * layers.x[layer];
    if (v < layers.x[layer + 1]) return sign * v;
    if (layer == 0) {
      double beyond = 0, other = 0;
      do {
        beyond = -std::log(uniform_of(draw())) / Layers::end;
        other = -std::log(uniform_of(draw()));
      } while (2 * other < beyond * beyond);
      return sign * (Layers::end + beyond);
    }
    if (layers.height[layer] + uniform_of(draw()) * (layers.height[layer + 1] - layers.height[layer]) < std::exp(-0.5 * v * v))
      return sign * v;
  }
}

const Layers& layers_of_bell() {
  static const Layers layers;
  return layers;
}

}  // namespace

double RandomStream::uniform() { return uniform_of(next()); }

double RandomStream::gaussian() {
  return gaussian_from(layers_of_bell(), [this] { return next(); });
}

// The draws of a block do not wait for each other.
void RandomStream::fill(std::span<double> numbers) {
  constexpr std::size_t block = 64;
  std::array<std::uint64_t, block> draws;
  std::size_t at = block;
  const auto draw = [&] {
    if (at == block) {
      for (std::size_t i = 0; i < block; ++i) draws[i] = mix(key_ + mix(counter_ + 1 + i));
      at = 0;
    }
    ++counter_;
    return draws[at++];
  };
  const Layers& layers = layers_of_bell();
  for (double& number : numbers) number = gaussian_from(layers, draw);
}

Noise::Noise(const NoiseDef& def, const RandomStream& stream, std::chrono::nanoseconds interval)
    : def_(def), all_(stream), sample_(stream.at(0)), interval_(interval) {
  if (is_none()) return;
  RandomStream fixed = stream;
  first_bias_ = def_.bias_mean + def_.bias_stddev * fixed.gaussian();
  if ((fixed.next() & 1) != 0) first_bias_ = -first_bias_;
  bias_ = first_bias_;
  drift_ = RandomStream(fixed.next(), "drift");
}

void Noise::begin(std::chrono::nanoseconds time) {
  if (is_none()) return;
  sample_ = all_.at(time);
  if (drifts()) drift_to(static_cast<std::uint64_t>(time / interval_));
}

// A first-order Gauss-Markov walk, from the start again when time went back.
void Noise::drift_to(std::uint64_t interval) {
  if (interval < drifted_) bias_ = first_bias_, drifted_ = 0;
  if (interval == drifted_) return;
  const double dt = std::chrono::duration<double>(interval_).count();
  const double keep = std::exp(-dt / def_.dynamic_bias_correlation_time);
  const double step = def_.dynamic_bias_stddev * std::sqrt(1 - keep * keep);
  while (drifted_ < interval) bias_ = keep * bias_ + step * drift_.at(++drifted_).gaussian();
}

double Noise::apply(double value) {
  if (is_none()) return value;
  value += bias_ + def_.mean;
  if (def_.stddev > 0) value += def_.stddev * sample_.gaussian();
  return def_.kind == NoiseDef::Kind::gaussian_quantized ? quantised(value, def_.precision) : value;
}

void Noise::apply(std::span<float> ranges, float step) {
  const bool has_noise = !is_none() && (def_.stddev > 0 || def_.mean != 0 || bias_ != 0);
  const double quantum = def_.kind == NoiseDef::Kind::gaussian_quantized && def_.precision > 0 ? def_.precision : static_cast<double>(step);
  if (!has_noise && quantum <= 0) return;
  std::array<double, 256> numbers;
  for (std::size_t first = 0; first < ranges.size(); first += numbers.size()) {
    const auto part = ranges.subspan(first, std::min(numbers.size(), ranges.size() - first));
    // Every beam draws, hit or not: what one beam sees does not change the noise of the others.
    if (has_noise) sample_.fill(std::span(numbers).first(part.size()));
    for (std::size_t i = 0; i < part.size(); ++i) {
      const double noise = has_noise ? def_.mean + bias_ + def_.stddev * numbers[i] : 0;
      if (std::isfinite(part[i])) part[i] = static_cast<float>(quantised(part[i] + noise, quantum));
    }
  }
}

}  // namespace sim
