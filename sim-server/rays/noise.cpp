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

namespace {

// Draws of a stream in advance, and what becomes of each that needs no second draw.
struct Block {
  static constexpr std::size_t size = 64;
  std::array<std::uint64_t, size> draws;
  std::array<double, size> numbers;
  std::array<bool, size> are_good;

  // As gaussian_from does it; the draws do not wait for each other.
  [[gnu::always_inline]] inline void draw(std::uint64_t key, std::uint64_t counter, const Layers& layers) {
    for (std::size_t i = 0; i < size; ++i) draws[i] = mix(key + mix(counter + 1 + i));
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint64_t layer = draws[i] & 255;
      const double v = static_cast<double>(static_cast<std::int64_t>(draws[i] >> 11)) * 0x1.0p-53 * layers.x[layer];
      are_good[i] = v < layers.x[layer + 1];
      numbers[i] = (draws[i] & 256) != 0 ? -v : v;
    }
  }
};

#if defined(__x86_64__)
// Draws eight at a time, with equal results: only AVX-512 multiplies eight integers of 64 bits at once.
[[gnu::target("avx512f,avx512dq,avx512vl")]] void draw_wide(Block& block, std::uint64_t key, std::uint64_t counter, const Layers& layers) {
  block.draw(key, counter, layers);
}
#endif

void draw(Block& block, std::uint64_t key, std::uint64_t counter, const Layers& layers) {
#if defined(__x86_64__)
  static const bool is_wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (is_wide) return draw_wide(block, key, counter, layers);
#endif
  block.draw(key, counter, layers);
}

}  // namespace

void RandomStream::fill(std::span<double> numbers) {
  const Layers& layers = layers_of_bell();
  Block block;
  std::size_t at = Block::size;
  const auto look = [&] {
    if (at < Block::size) return;
    draw(block, key_, counter_, layers);
    at = 0;
  };
  for (double& number : numbers) {
    look();
    if (block.are_good[at]) {
      number = block.numbers[at++];
      ++counter_;
      continue;
    }
    number = gaussian_from(layers, [&] {
      look();
      ++counter_;
      return block.draws[at++];
    });
  }
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
