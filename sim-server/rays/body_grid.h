// Finds the bodies near a position among many, on a grid of square cells. Private to rays/. Building is for one thread; after that any
// number may search. Lengths in m.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sim {

class BodyGrid {
 public:
  struct Entry {
    std::uint32_t id = 0;
    double x = 0, y = 0;  // of the middle of its sphere; not a number: found everywhere
    double radius = 0;
  };
  void build(std::span<const Entry> entries);
  // In ascending order: all whose spheres may reach into the circle, and some more. `reach` may be infinite.
  void find(double x, double y, double reach, std::vector<std::uint32_t>& ids) const;

 private:
  struct Placed {
    std::uint64_t cell = 0;  // row, column
    std::uint32_t id = 0;
  };
  std::vector<Placed> placed_;  // by cell
  std::vector<std::uint32_t> everywhere_;
  double largest_ = 0;
};

}  // namespace sim
