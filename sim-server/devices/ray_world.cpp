#include "devices/ray_world.h"

#include <algorithm>

namespace sim {
namespace {

std::uint32_t color_of(const LinkDef& link) {
  for (const auto& visual : link.visuals) {
    if (!visual.material) continue;
    const Color& c = visual.material->diffuse;
    const auto byte = [](float v) { return static_cast<std::uint32_t>(std::clamp(v, 0.0F, 1.0F) * 255); };
    return byte(c.r) << 16 | byte(c.g) << 8 | byte(c.b);
  }
  return 0xb0b0b0;
}

}  // namespace

RayWorld::RayWorld(const Physics& physics, TriangleCache& triangles) : physics_(physics), scene_(triangles) {}

std::vector<RayShape> RayWorld::shapes_of(ModelId model, std::uint32_t piece) const {
  std::vector<RayShape> shapes;
  for (const auto l : physics_.piece_links(model, piece)) {
    const LinkDef& link = physics_.def(model).links[l];
    for (const auto& collision : link.collisions) {
      shapes.push_back({&collision.geometry, physics_.link_in_piece({model, l}) * collision.pose, static_cast<float>(collision.laser_retro),
                        color_of(link)});
    }
  }
  return shapes;
}

void RayWorld::add(ModelId model, std::vector<std::string>& notes) {
  for (std::uint32_t piece = 0; piece < physics_.piece_count(model); ++piece) {
    auto shapes = shapes_of(model, piece);
    const bool is_moving = physics_.piece_can_move(model, piece);
    if (is_moving) std::erase_if(shapes, [](const RayShape& shape) { return std::holds_alternative<PlaneShape>(*shape.geometry); });
    if (shapes.empty()) continue;
    const auto pose = physics_.piece_pose(model, piece);
    const auto body = is_moving ? scene_.add_moving(shapes, pose, notes) : scene_.add_static(shapes, pose, notes);
    pieces_.push_back({model, piece, body, is_moving});
  }
}

void RayWorld::remove(ModelId model) {
  std::erase_if(pieces_, [&](const Piece& piece) {
    if (piece.model != model) return false;
    scene_.remove(piece.body);
    return true;
  });
}

void RayWorld::moved(ModelId model) {
  const bool has_static = std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.model == model && !p.is_moving; });
  if (!has_static) return;
  std::vector<std::string> ignored;
  remove(model);
  add(model, ignored);
}

void RayWorld::update() {
  for (const auto& piece : pieces_) {
    if (piece.is_moving) scene_.set_pose(piece.body, physics_.piece_pose(piece.model, piece.piece));
  }
  scene_.commit();
}

void RayWorld::look_out_of_casing(LinkId link, const Eigen::Isometry3d& pose_in_link, Beams& beams) {
  const auto shapes = shapes_of(link.model, physics_.piece_of(link));
  scene_.look_out_of(shapes, physics_.link_in_piece(link) * pose_in_link, beams);
}

}  // namespace sim
