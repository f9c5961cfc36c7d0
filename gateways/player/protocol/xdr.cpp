#include "protocol/xdr.h"

#include <bit>

namespace player {
namespace {

constexpr std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

void XdrWriter::u32(std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes_ += static_cast<char>(value >> shift & 0xff);
}

void XdrWriter::f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }

void XdrWriter::f64(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  u32(static_cast<std::uint32_t>(bits >> 32));
  u32(static_cast<std::uint32_t>(bits));
}

void XdrWriter::raw(std::string_view bytes) {
  bytes_ += bytes;
  bytes_.append(padded(bytes.size()) - bytes.size(), '\0');
}

void XdrWriter::count(std::size_t number) {
  u32(static_cast<std::uint32_t>(number));
  u32(static_cast<std::uint32_t>(number));
}

void XdrWriter::counted_text(std::string_view text) {
  std::string terminated(text);
  terminated += '\0';
  counted_bytes(terminated);
}

std::string_view XdrReader::take(std::size_t size) {
  if (!is_good_ || rest_.size() < size) {
    is_good_ = false;
    rest_ = {};
    return {};
  }
  const auto taken = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return taken;
}

std::uint32_t XdrReader::u32() {
  std::uint32_t value = 0;
  for (const char byte : take(4)) value = value << 8 | static_cast<unsigned char>(byte);
  return value;
}

float XdrReader::f32() { return std::bit_cast<float>(u32()); }

double XdrReader::f64() {
  const std::uint64_t high = u32();
  return std::bit_cast<double>(high << 32 | u32());
}

std::uint32_t XdrReader::small(std::uint32_t max) {
  const auto value = u32();
  if (value <= max) return value;
  is_good_ = false;
  return 0;
}

std::size_t XdrReader::count(std::size_t element_size, std::size_t max) {
  const std::size_t first = u32(), second = u32();
  if (first != second || first > max || padded(first * element_size) > rest_.size()) is_good_ = false;
  return is_good_ ? first : 0;
}

std::string_view XdrReader::counted_bytes(std::size_t max) {
  const auto number = count(1, max);
  return take(padded(number)).substr(0, number);
}

std::string_view XdrReader::counted_text(std::size_t max) {
  const auto bytes = counted_bytes(max);
  return bytes.substr(0, bytes.find('\0'));
}

}  // namespace player
