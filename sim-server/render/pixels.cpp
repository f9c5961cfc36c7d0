#include "render/pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/random.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace sim {
namespace {

void plain_rgba_to_rgb(const std::uint8_t* in, std::uint8_t* out, std::size_t pixels) {
  for (std::size_t i = 0; i < pixels; ++i) {
    out[3 * i] = in[4 * i];
    out[3 * i + 1] = in[4 * i + 1];
    out[3 * i + 2] = in[4 * i + 2];
  }
}

#if defined(__x86_64__)
// 16 pixels at a time: four loads of 16 bytes become three stores.
__attribute__((target("ssse3"))) std::size_t fast_rgba_to_rgb(const std::uint8_t* in, std::uint8_t* out, std::size_t pixels) {
  const __m128i pack = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
  std::size_t i = 0;
  for (; i + 16 <= pixels; i += 16) {
    const auto* from = reinterpret_cast<const __m128i*>(in + 4 * i);
    auto* to = reinterpret_cast<__m128i*>(out + 3 * i);
    const __m128i a = _mm_shuffle_epi8(_mm_loadu_si128(from), pack);
    const __m128i b = _mm_shuffle_epi8(_mm_loadu_si128(from + 1), pack);
    const __m128i c = _mm_shuffle_epi8(_mm_loadu_si128(from + 2), pack);
    const __m128i d = _mm_shuffle_epi8(_mm_loadu_si128(from + 3), pack);
    _mm_storeu_si128(to, _mm_or_si128(a, _mm_slli_si128(b, 12)));
    _mm_storeu_si128(to + 1, _mm_or_si128(_mm_srli_si128(b, 4), _mm_slli_si128(c, 8)));
    _mm_storeu_si128(to + 2, _mm_or_si128(_mm_srli_si128(c, 8), _mm_slli_si128(d, 4)));
  }
  return i;
}
bool has_shuffle() {
  static const bool answer = __builtin_cpu_supports("ssse3") != 0;
  return answer;
}
#endif

constexpr std::size_t table_size = 4096;

// The values of a Gaussian of deviation 1 at evenly spaced probabilities: a uniform index draws from the bell.
std::vector<float> make_gaussian_table() {
  std::vector<float> table(table_size);
  const auto probability = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  for (std::size_t i = 0; i < table_size / 2; ++i) {
    const double wanted = (static_cast<double>(i) + 0.5) / table_size;
    double low = -6, high = 0;
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (low + high);
      (probability(middle) < wanted ? low : high) = middle;
    }
    table[i] = static_cast<float>(low);
    table[table_size - 1 - i] = static_cast<float>(-low);
  }
  return table;
}
const std::vector<float>& gaussian_table() {
  static const std::vector<float> table = make_gaussian_table();
  return table;
}

}  // namespace

void rgba_to_rgb(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size() / 4, out.size() / 3);
  std::size_t done = 0;
#if defined(__x86_64__)
  if (has_shuffle()) done = fast_rgba_to_rgb(rgba.data(), out.data(), pixels);
#endif
  plain_rgba_to_rgb(rgba.data() + 4 * done, out.data() + 3 * done, pixels - done);
}

void rgba_to_mono(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size() / 4, out.size());
  const std::uint8_t* in = rgba.data();
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint32_t sum = 19595U * in[4 * i] + 38470U * in[4 * i + 1] + 7471U * in[4 * i + 2];
    out[i] = static_cast<std::uint8_t>((sum + 32768U) >> 16);
  }
}

std::uint64_t mix_seed(std::uint64_t a, std::uint64_t b) { return base::mix64(a * base::mix64_step + b + 0x632be59bd9b4e019ULL); }

NoiseStream::NoiseStream(std::uint64_t seed) {
  for (auto& word : state_) {
    seed = mix_seed(seed, 1);
    word = static_cast<std::uint32_t>(seed) | 1U;
  }
}

// Xorshift with 128 bits of state.
std::uint32_t NoiseStream::next() {
  std::uint32_t t = state_[3];
  const std::uint32_t s = state_[0];
  state_[3] = state_[2];
  state_[2] = state_[1];
  state_[1] = s;
  t ^= t << 11;
  t ^= t >> 8;
  return state_[0] = t ^ s ^ (s >> 19);
}

void NoiseStream::add(std::span<std::uint8_t> bytes, double mean, double deviation) {
  // In 1/256 of a step, so that small deviations are not lost.
  std::vector<std::int32_t> table(table_size);
  for (std::size_t i = 0; i < table_size; ++i)
    table[i] = static_cast<std::int32_t>(std::lround((mean + deviation * static_cast<double>(gaussian_table()[i])) * 255 * 256));
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bits = (i & 1) == 0 ? next() : bits >> 16;
    const std::int32_t value = (static_cast<std::int32_t>(bytes[i]) << 8) + 128 + table[bits & (table_size - 1)];
    bytes[i] = static_cast<std::uint8_t>(std::clamp(value >> 8, 0, 255));
  }
}

void NoiseStream::add16(std::span<std::uint8_t> bytes, double mean, double deviation) {
  const auto& table = gaussian_table();
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const double noise = mean + deviation * static_cast<double>(table[next() & (table_size - 1)]);
    const double value = bytes[i] + 256.0 * bytes[i + 1] + 65535 * noise;
    const auto rounded = static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0, 65535.0)));
    bytes[i] = static_cast<std::uint8_t>(rounded);
    bytes[i + 1] = static_cast<std::uint8_t>(rounded >> 8);
  }
}

void NoiseStream::add(std::span<float> metres, double mean, double deviation) {
  const auto& table = gaussian_table();
  const auto m = static_cast<float>(mean), d = static_cast<float>(deviation);
  for (auto& value : metres) value += m + d * table[next() & (table_size - 1)];
}

void depth_to_points(std::span<const float> depth, int width, double fx, double fy, double cx, double cy, std::span<float> out) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const std::size_t columns = static_cast<std::size_t>(width);
  const std::size_t rows = std::min(depth.size(), out.size() / 3) / columns;
  for (std::size_t y = 0; y < rows; ++y) {
    const auto up = static_cast<float>((cy - static_cast<double>(y) - 0.5) / fy);
    for (std::size_t x = 0; x < columns; ++x) {
      const float d = depth[y * columns + x];
      float* point = &out[(y * columns + x) * 3];
      const bool is_hit = std::isfinite(d);
      point[0] = is_hit ? d : none;
      point[1] = is_hit ? d * static_cast<float>((cx - static_cast<double>(x) - 0.5) / fx) : none;
      point[2] = is_hit ? d * up : none;
    }
  }
}

}  // namespace sim
