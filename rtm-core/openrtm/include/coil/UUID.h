// Universally unique identifiers, made from random numbers. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace coil {

class UUID {
 public:
  // All zeros.
  UUID() = default;
  explicit UUID(const std::array<std::uint8_t, 16>& bytes) : bytes_(bytes) {}
  static UUID random();

  // 36 characters, lower case, with hyphens.
  std::string to_string() const;

 private:
  std::array<std::uint8_t, 16> bytes_{};
};

class UUID_Generator {
 public:
  void init() {}
  // The arguments of 1.x (how many, which variant) change nothing. The caller deletes the result.
  UUID* generateUUID(int /*n*/ = 0, int /*h*/ = 0) { return new UUID(UUID::random()); }
};

}  // namespace coil
