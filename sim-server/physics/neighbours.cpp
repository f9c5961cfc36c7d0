#include "physics/neighbours.h"

#include <algorithm>

namespace sim {
namespace {

constexpr double wide = 20;  // [m]

class Search {
 public:
  Search(const std::vector<ModelInstance*>& moving, const std::vector<ModelInstance*>& left) : moving_(moving), left_(left) {}

  ModelInstance* run() {
    // Looking at all of them for each is quicker than sorting all for a few.
    if (left_.size() < 16) {
      for (auto* model : left_) {
        for (auto* other : moving_) {
          if (other != model && (!other->left_neighbourhood || other->id() > model->id())) join(*model, *other);
        }
      }
    } else {
      sweep();
    }
    const auto by_id = [](const ModelInstance* a, const ModelInstance* b) { return a->id() < b->id(); };
    std::sort(changed_.begin(), changed_.end(), by_id);
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (auto* model : changed_) std::sort(model->neighbours.begin(), model->neighbours.end(), by_id);
    return crowded_;
  }

 private:
  // Along the axis on which they lie furthest apart.
  void sweep() {
    Aabb all;
    for (const auto* model : moving_) all.extend(model->moving_box());
    int axis = 0;
    (all.high - all.low).maxCoeff(&axis);
    std::vector<ModelInstance*> sorted = moving_;
    std::sort(sorted.begin(), sorted.end(), [&](const ModelInstance* a, const ModelInstance* b) {
      const double x = a->neighbourhood.low[axis], y = b->neighbourhood.low[axis];
      return x != y ? x < y : a->id() < b->id();
    });
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      for (std::size_t k = i + 1; k < sorted.size() && sorted[k]->neighbourhood.low[axis] <= sorted[i]->neighbourhood.high[axis]; ++k) {
        if (is_full(*sorted[i])) break;
        if (sorted[i]->left_neighbourhood || sorted[k]->left_neighbourhood) join(*sorted[i], *sorted[k]);
      }
    }
  }

  bool is_full(ModelInstance& model) {
    if (model.neighbours.size() < max_neighbours) return false;
    crowded_ = &model;
    return true;
  }

  void join(ModelInstance& a, ModelInstance& b) {
    if (!a.neighbourhood.overlaps(b.neighbourhood) || is_full(a) || is_full(b)) return;
    a.neighbours.push_back(&b);
    b.neighbours.push_back(&a);
    changed_.push_back(&a);
    changed_.push_back(&b);
  }

  const std::vector<ModelInstance*>&moving_, &left_;
  std::vector<ModelInstance*> changed_;
  ModelInstance* crowded_ = nullptr;
};

}  // namespace

void StaticIndex::build(const std::vector<ShapeInstance*>& shapes) {
  wide_.clear();
  sorted_.clear();
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    const Aabb& box = shapes[i]->box;
    (box.high.x() - box.low.x() < wide ? sorted_ : wide_).push_back({box, i, 0});
  }
  std::stable_sort(sorted_.begin(), sorted_.end(), [](const Entry& a, const Entry& b) { return a.box.low.x() < b.box.low.x(); });
  double reach = -infinite;
  for (Entry& entry : sorted_) entry.reach = reach = std::max(reach, entry.box.high.x());
}

void StaticIndex::find(const Aabb& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  for (const Entry& entry : wide_) {
    if (entry.box.overlaps(box)) found.push_back(entry.index);
  }
  const auto first = std::partition_point(sorted_.begin(), sorted_.end(), [&](const Entry& entry) { return entry.reach < box.low.x(); });
  for (auto entry = first; entry != sorted_.end() && entry->box.low.x() <= box.high.x(); ++entry) {
    if (entry->box.overlaps(box)) found.push_back(entry->index);
  }
  std::sort(found.begin(), found.end());
}

ModelInstance* find_neighbours(const std::vector<ModelInstance*>& moving, const std::vector<ModelInstance*>& left) {
  return Search(moving, left).run();
}

}  // namespace sim
