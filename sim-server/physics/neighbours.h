// Finds the models whose neighbourhoods overlap. Private to physics/. One thread at a time.
#pragma once

#include <vector>

#include "physics/model_instance.h"

namespace sim {

// What is near places in the world, among shapes that do not move; asked for boxes. Holds indexes into the list that it was made of.
class StaticIndex {
 public:
  void build(const std::vector<ShapeInstance*>& shapes);
  // Ascending.
  void find(const Aabb& box, std::vector<std::uint32_t>& found) const;

 private:
  struct Entry {
    Aabb box;
    std::uint32_t index = 0;
    double reach = 0;  // the highest end of this one and those before
  };
  std::vector<Entry> wide_, sorted_;  // by their lower ends along x; those that reach far are apart
};

// A model lies near so many others at most; of more, those with the lower ids count.
inline constexpr std::size_t max_neighbours = 500;

// Brings the neighbours of those that have `left` their neighbourhoods up to date. Those have none, nor are they any others' now; `moving`
// are all models that move. Both ascending by id. Returns a model that lies near too many others, or null.
ModelInstance* find_neighbours(const std::vector<ModelInstance*>& moving, const std::vector<ModelInstance*>& left);

}  // namespace sim
