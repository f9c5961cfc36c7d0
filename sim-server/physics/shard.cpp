#include "physics/shard.h"

#include <algorithm>

#include "base/guarded.h"
#include "physics/contact_surface.h"
#include "physics/mesh_contacts.h"
#include "physics/weld.h"

namespace sim {
namespace {

constexpr int max_contacts = 24;  // of one pair of shapes, before they are thinned out
// With more contacts at once, or shapes that are too deep in each other, the iterative solver takes fewer rounds, unless the world asks for
// that solver.
constexpr double affordable_contacts = 3000;
constexpr int least_iterations = 10;
// As many equal balls have room around one. Shapes that both touch more moving ones are in a muddle, of which some contacts are enough.
constexpr std::uint32_t max_partners = 12;
// Shapes that are in each other by more than this part of half the smaller one came there by no motion. They are pushed apart by one
// contact, and only where one of both has few such partners: that lets a crowd in one place come apart, and costs little until it has.
constexpr double too_deep = 0.25, least_too_deep = 1e-3;  // [m] the latter, for thin sheets
constexpr std::uint32_t max_deep_partners = 4;
constexpr double mesh_correction = 0.1;     // [m/s] at most between meshes that are in each other
constexpr double max_sag = 100;             // times what a body sags by its own weight
constexpr double hard_correction = 0.1;     // [m/s] at most out of contacts without stiffness and restitution
constexpr double bounce_correction = 2e-3;  // [m/s] likewise with restitution, between bodies that move
constexpr double fastest_impact = 25;       // [m/s]: what is deeper than such a step came there by no impact

// ODE's mesh and height field colliders work in global buffers.
base::Turn<>& shared_collider() {
  static base::Turn<> turn;
  return turn;
}
// The iterative solver draws from a global random sequence.
base::Turn<>& shared_random() {
  static base::Turn<> turn;
  return turn;
}

bool masks_match(const SurfaceDef& a, const SurfaceDef& b) {
  return (a.collide_bitmask & b.collide_bitmask) != 0 &&
         ((a.collide_bitmask & b.category_bitmask) != 0 || (b.collide_bitmask & a.category_bitmask) != 0);
}

bool are_joined(const ModelInstance& model, std::uint32_t a, std::uint32_t b) {
  return std::any_of(model.joints().begin(), model.joints().end(), [&](const JointInstance& joint) {
    const auto p = static_cast<std::uint32_t>(joint.parent_assembly), c = static_cast<std::uint32_t>(joint.child_assembly);
    return (p == a && c == b) || (p == b && c == a);
  });
}

bool may_touch_itself(const ModelInstance& model, const ShapeInstance& a, const ShapeInstance& b) {
  if (a.assembly == b.assembly) return false;
  const ModelDef& def = *model.blueprint().model;
  if (!def.self_collide && !(def.links[a.link.link].self_collide && def.links[b.link.link].self_collide)) return false;
  return !are_joined(model, a.assembly, b.assembly);
}

bool are_welded(const ModelInstance& model, const ShapeInstance& a, const ShapeInstance& b) {
  return std::any_of(model.welds.begin(), model.welds.end(),
                     [&](const Weld* weld) { return weld->joins(a.link.model, a.assembly, b.link.model, b.assembly); });
}

bool can_be_pushed(dGeomID geom) { return is_pushable(dGeomGetBody(geom)); }

bool is_too_deep(const ShapeInstance& a, const ShapeInstance& b, const dContactGeom* found, int count) {
  const double size = std::min((a.box.high - a.box.low).minCoeff(), (b.box.high - b.box.low).minCoeff());
  return std::any_of(found, found + count,
                     [&](const dContactGeom& one) { return one.depth > std::max(too_deep * size / 2, least_too_deep); });
}

// How easily a push at a point [m] moves and turns the body, over three directions [1/kg].
double compliance_at(dBodyID body, const dReal* at) {
  dMass mass;
  dBodyGetMass(body, &mass);
  dVector3 local;
  dBodyGetPosRelPoint(body, at[0], at[1], at[2], local);
  const Eigen::Matrix3d inertia = Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(mass.I).leftCols<3>();
  Eigen::Matrix3d arm;
  arm << 0, -local[2], local[1], local[2], 0, -local[0], -local[1], local[0], 0;
  return 1 / mass.mass + (arm.transpose() * inertia.inverse() * arm).trace();
}

bool is_mesh(const ShapeInstance& shape) { return dGeomGetClass(shape.geom.id()) == dTriMeshClass; }

// Made when two meshes meet for the first time: most never do.
const Solid& solid_of(const ShapeInstance& shape) {
  auto& mesh = *static_cast<ShapeStore::Mesh*>(shape.data.get());
  const auto mine = shared_collider().take();
  if (!mesh.solid) mesh.solid = std::make_shared<const Solid>(*mesh.triangles);
  return *mesh.solid;
}

}  // namespace

Shard::Shard(const PhysicsDef& physics, const Air& air)
    : physics_(physics),
      air_(air),
      gravity_(physics.gravity.norm()),
      erp_(physics.erp.value_or(0.2)),
      contact_joints_(dJointGroupCreate(0)),
      groups_(physics),
      tree_solver_(world_.id(), physics) {
  const dWorldID w = world_.id();
  dWorldSetGravity(w, physics.gravity.x(), physics.gravity.y(), physics.gravity.z());
  dWorldSetERP(w, erp_);
  dWorldSetCFM(w, std::max(physics.cfm.value_or(1e-9), 1e-10));
  if (physics.sor > 0) dWorldSetQuickStepW(w, physics.sor);
  dWorldSetContactSurfaceLayer(w, 0);  // allowed_depth() decides
  // Bodies that start inside each other are pushed apart slowly; SDF's default of 100 m/s would throw them out of the world.
  dWorldSetContactMaxCorrectingVel(w, std::min(physics.contact_max_correcting_vel, 1.0));
}

// All look round before any of them moves.
void Shard::roll(const std::vector<ShapeInstance*>& statics) {
  rolling_.clear();
  for (auto* model : models) {
    if (model->rolls() && !model->rolling->is_asleep()) rolling_.push_back(model);
  }
  const auto crowded = std::stable_partition(rolling_.begin(), rolling_.end(),
                                             [&](const ModelInstance* model) { return model->rolling->is_alone(*model, statics); });
  std::for_each(crowded, rolling_.end(), [](ModelInstance* model) { model->stop_rolling(); });
  rolling_.erase(crowded, rolling_.end());
  for (auto* model : rolling_) {
    if (model->rolling->step(*model)) {
      note_place(*model);
    } else {
      model->stop_rolling();
    }
  }
}

void Shard::note_place(ModelInstance& model) {
  if (!model.neighbourhood.contains(model.update_boxes())) model.left_neighbourhood = has_left = true;
}

void Shard::find_active() {
  for (auto* model : models) {
    if (!model->may_be_awake) continue;
    model->may_be_awake = model->is_awake();
    if (!model->may_be_awake) continue;
    model->is_active = true;
    active_.push_back(model);
  }
  const std::size_t awake = active_.size();
  // What an awake model may touch takes part, and what that may touch, and so on.
  const auto add = [&](ModelInstance* other) {
    if (other->rolls()) other->stop_rolling();
    other->is_active = true;
    active_.push_back(other);
  };
  for (std::size_t i = 0; i < active_.size(); ++i) {
    for (auto* other : active_[i]->neighbours) {
      // One that has made its rolling step was alone, also where the boxes overlap that are wider than it is.
      if (other->rolls() && !other->rolling->is_asleep()) continue;
      if (!other->is_active && active_[i]->moving_box().overlaps(other->moving_box())) add(other);
    }
    for (const Weld* weld : active_[i]->welds) {
      ModelInstance& other = weld->other(*active_[i]);
      if (!other.is_active && other.body_count() > 0) add(&other);
    }
  }
  if (active_.size() > awake) std::sort(active_.begin(), active_.end(), [](auto* a, auto* b) { return a->id() < b->id(); });
}

void Shard::step(const std::vector<ShapeInstance*>& statics, std::uint64_t step_count) {
  ode::prepare_thread();
  contacts = 0;
  has_left = is_insane = false;
  roll(statics);
  find_active();
  if (active_.empty()) return;
  has_many_joints_ = has_muddle_ = false;
  for (auto* model : active_) {
    has_many_joints_ = has_many_joints_ || model->is_for_tree();
    std::swap(model->contacts, model->previous_contacts);
    model->contacts.clear();
    model->lies_on_belt = false;
    for (auto& shape : model->shapes()) shape.partners = shape.deep_partners = 0;
    groups_.add(*model);
  }
  tie_welded();
  find_contacts(statics);
  for (auto* model : active_) model->apply_forces(contact_joints_.id(), physics_, air_);
  impacts_.settle();
  groups_.keep_energies();
  find_turning();
  solve(step_count);
  free_rotation_.finish(physics_.step);
  tree_solver_.let_go();
  made_contacts_.clear();
  groups_.limit_energies();
  groups_.note_loads();
  groups_.settle();
  groups_.clear();
  read_forces();
  dJointGroupEmpty(contact_joints_.id());
  feedback_.clear();
  finish(statics);
}

void Shard::find_turning() {
  for (auto* model : active_) {
    for (std::uint32_t i = 0; i < model->body_count(); ++i) {
      if (model->body(i) != nullptr) free_rotation_.add(model->body(i));
    }
  }
}

void Shard::tie_welded() {
  for (auto* model : active_) {
    for (Weld* weld : model->welds) {
      if (!weld->is_counted_for(*model)) continue;
      weld->prepare(world_.id());
      if (weld->first().body_count() > 0) groups_.tie(weld->first(), *model);
    }
  }
}

void Shard::find_contacts(const std::vector<ShapeInstance*>& statics) {
  for (auto* model : active_) collide_model(*model, statics);
  for (auto* model : active_) {
    for (auto* other : model->neighbours) {
      if (other->id() < model->id() || !other->is_active || !model->moving_box().overlaps(other->moving_box())) continue;
      if (model->may_be_awake || other->may_be_awake || !model->contacts.empty()) collide_pair(*model, *other);
    }
  }
}

void Shard::solve_exactly() { dWorldStep(world_.id(), physics_.step); }

void Shard::solve_iteratively(std::uint64_t step_count) {
  const auto mine = shared_random().take();
  dRandSetSeed(static_cast<unsigned long>(step_count) * 2654435761U + 1);
  const bool is_free = physics_.solver == PhysicsDef::Solver::automatic;
  const int asked = std::clamp(physics_.iterations, 1, 10000);
  const auto affordable = static_cast<int>(static_cast<double>(asked) * affordable_contacts / std::max(groups_.contacts(), 1U));
  const int least = std::min(asked, least_iterations);
  dWorldSetQuickStepNumIterations(world_.id(), !is_free ? asked : has_muddle_ ? least : std::clamp(affordable, least, asked));
  dWorldQuickStep(world_.id(), physics_.step);
}

// Each group with many joints.
void Shard::solve_trees() {
  std::vector<std::pair<std::uint32_t, ModelInstance*>> members;
  for (auto* model : active_) {
    if (model->is_tree_solved) members.emplace_back(groups_.group_of(*model), model);
  }
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto first = members.begin(); first != members.end();) {
    const auto last = std::find_if(first, members.end(), [&](const auto& member) { return member.first != first->first; });
    std::vector<ModelInstance*> group;
    for (auto member = first; member != last; ++member) group.push_back(member->second);
    const bool is_solved = solve_tree(group);
    for (auto* model : group) model->is_tree_solved = is_solved, model->is_iterative = model->is_iterative && !is_solved;
    first = last;
  }
}

bool Shard::solve_tree(const std::vector<ModelInstance*>& group) {
  if (std::none_of(group.begin(), group.end(), [](const ModelInstance* model) { return model->is_awake(); })) return false;
  std::vector<const MadeContact*> contacts;
  const auto number = groups_.group_of(*group.front());
  for (const auto& made : made_contacts_) {
    if (groups_.group_of(*made.model) == number) contacts.push_back(&made);
  }
  // As ODE does with what awake bodies are tied to.
  for (auto* model : group) {
    for (std::uint32_t i = 0; i < model->body_count(); ++i) {
      if (model->body(i) != nullptr && dBodyIsEnabled(model->body(i)) == 0) dBodyEnable(model->body(i));
    }
  }
  return tree_solver_.solve(group, contacts);
}

// Each group by its solver: the others sleep meanwhile.
void Shard::solve(std::uint64_t step_count) {
  groups_.share_out();
  if (has_many_joints_) solve_trees();
  const auto count = std::count_if(active_.begin(), active_.end(), [](const ModelInstance* model) { return model->is_iterative; });
  if (count == 0) return solve_exactly();
  const auto is_held = [](const ModelInstance* model) { return model->has_stand_ins(); };
  if (count == std::ssize(active_) || std::any_of(active_.begin(), active_.end(), is_held)) {
    for (auto* model : active_) model->is_iterative = model->is_iterative || !model->is_tree_solved;
    return solve_iteratively(step_count);
  }
  const auto lay_down = [&](bool iterative) {
    for (auto* model : active_) {
      for (std::uint32_t i = 0; i < model->body_count() && model->is_iterative == iterative; ++i) {
        const dBodyID body = model->body(i);
        if (body == nullptr || dBodyIsEnabled(body) == 0) continue;
        dBodyDisable(body);
        lying_.push_back(body);
      }
    }
  };
  const auto get_up = [&] {
    for (const dBodyID body : lying_) dBodyEnable(body);
    lying_.clear();
  };
  lay_down(true);
  solve_exactly();
  get_up();
  lay_down(false);
  solve_iteratively(step_count);
  get_up();
}

void Shard::finish(const std::vector<ShapeInstance*>& statics) {
  for (auto* model : active_) {
    if (!model->is_sane()) {
      is_insane = true;
      continue;
    }
    model->follow_joints(physics_.step);
    // It slept in this step: what it touches stays as it was, with the forces.
    if (!model->may_be_awake && !model->is_awake()) std::swap(model->contacts, model->previous_contacts);
    model->may_be_awake = true;  // ODE wakes what awake bodies touch
    note_place(*model);
  }
  for (auto* model : active_) {
    if (model->rolling && model->is_sane()) model->rolling->watch(*model, statics);
  }
  for (auto* model : active_) model->is_active = false;
  active_.clear();
}

void Shard::collide_model(ModelInstance& model, const std::vector<ShapeInstance*>& statics) {
  auto& shapes = model.shapes();
  for (const auto s : model.near_statics) {
    ShapeInstance& other = *statics[s];
    if (!model.moving_box().overlaps(other.box)) continue;
    for (auto& shape : shapes) {
      if (model.body(shape.assembly) == nullptr || !shape.box.overlaps(other.box)) continue;
      if (other.link.model == model.id() && !may_touch_itself(model, shape, other)) continue;
      if (are_welded(model, shape, other)) continue;
      collide(model, shape, nullptr, other);
    }
  }
  const ModelDef& def = *model.blueprint().model;
  if (!def.self_collide && std::none_of(def.links.begin(), def.links.end(), [](const LinkDef& l) { return l.self_collide; })) return;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t k = i + 1; k < shapes.size(); ++k) {
      if (model.body(shapes[i].assembly) == nullptr || model.body(shapes[k].assembly) == nullptr) continue;
      if (shapes[i].box.overlaps(shapes[k].box) && may_touch_itself(model, shapes[i], shapes[k]))
        collide(model, shapes[i], &model, shapes[k]);
    }
  }
}

void Shard::collide_pair(ModelInstance& a, ModelInstance& b) {
  for (auto& shape_a : a.shapes()) {
    if (a.body(shape_a.assembly) == nullptr || !shape_a.box.overlaps(b.moving_box())) continue;
    for (auto& shape_b : b.shapes()) {
      if (b.body(shape_b.assembly) != nullptr && shape_a.box.overlaps(shape_b.box) && !are_welded(a, shape_a, shape_b))
        collide(a, shape_a, &b, shape_b);
    }
  }
}

void Shard::collide(ModelInstance& model_a, ShapeInstance& a, ModelInstance* model_b, ShapeInstance& b) {
  if (!masks_match(*a.surface, *b.surface)) return;
  const std::uint32_t partners = model_b != nullptr ? std::min(a.partners, b.partners) : 0;
  const bool are_in_muddle = model_b != nullptr && std::min(a.deep_partners, b.deep_partners) >= max_deep_partners;
  has_muddle_ = has_muddle_ || are_in_muddle;
  if (partners >= max_partners || are_in_muddle) return;
  dContactGeom found[max_contacts];
  const int most = std::clamp(physics_.max_contacts, 1, max_contacts);
  int count = 0;
  if (is_mesh(a) && is_mesh(b)) {
    const Solid &solid_a = solid_of(a), &solid_b = solid_of(b);
    count = collide_meshes(a, solid_a, b, solid_b, most, found);
  } else if (a.needs_lock || b.needs_lock) {
    const auto mine = shared_collider().take();
    count = dCollide(a.geom.id(), b.geom.id(), most, found, sizeof(dContactGeom));
  } else {
    count = dCollide(a.geom.id(), b.geom.id(), most, found, sizeof(dContactGeom));
  }
  if (count <= 0) return;
  const bool a_rolls = a.is_wheel && !a.belt, b_rolls = b.is_wheel && !b.belt;
  if (a_rolls) count = merge_under_wheel(a.geom.id(), found, count);
  if (b_rolls) count = merge_under_wheel(b.geom.id(), found, count);
  count = reduce(found, count);
  if (model_b != nullptr) {
    ++a.partners, ++b.partners;
    if (is_too_deep(a, b, found, count)) {
      ++a.deep_partners, ++b.deep_partners;
      std::swap(found[0], *std::max_element(found, found + count, [](const auto& x, const auto& y) { return x.depth < y.depth; }));
      count = 1;
    }
  }
  if (partners >= max_partners / 2) count = 1;
  dSurfaceParameters surface = combine(*a.surface, *b.surface, physics_.step);
  if (a_rolls || b_rolls) surface.mu = std::min(surface.mu, best_grip), surface.mu2 = std::min(surface.mu2, best_grip);
  const bool has_force = !a.surface->collide_without_contact && !b.surface->collide_without_contact;
  for (int i = 0; i < count; ++i) {
    if (std::isfinite(found[i].depth) && std::isfinite(found[i].normal[0]) && std::isfinite(found[i].pos[0])) {
      add_contact(model_a, a, model_b, b, found[i], surface, has_force);
    }
  }
}

void Shard::add_contact(ModelInstance& model_a, ShapeInstance& a, ModelInstance* model_b, ShapeInstance& b, const dContactGeom& geometry,
                        const dSurfaceParameters& surface, bool has_force) {
  ++contacts;
  Contact contact;
  contact.link = a.link;
  contact.other = b.link;
  contact.collision = a.collision;
  contact.other_collision = b.collision;
  contact.position = ode::vector(geometry.pos);
  contact.normal = ode::vector(geometry.normal);
  contact.depth = geometry.depth;
  model_a.contacts.push_back(contact);
  ++model_a.contacts_so_far;
  if (model_b != nullptr) {
    std::swap(contact.link, contact.other);
    std::swap(contact.collision, contact.other_collision);
    contact.normal = -contact.normal;
    model_b->contacts.push_back(contact);
    ++model_b->contacts_so_far;
  }
  // Nothing to push: ODE's solvers would divide by masses that are not there.
  if (!has_force || (!can_be_pushed(a.geom.id()) && !can_be_pushed(b.geom.id()))) return;
  dContact joint_contact{};
  joint_contact.surface = surface;
  joint_contact.geom = geometry;
  joint_contact.geom.depth = std::max(geometry.depth - allowed_depth(*a.surface, *b.surface, surface), 0.0);
  groups_.touch(model_a, model_b != &model_a ? model_b : nullptr, is_mesh(a) || is_mesh(b), joint_contact.geom.depth, surface);
  // What pushes out stays in the motion: a ball without restitution would leave the ground with a fifth of the depth in each step.
  // What stops another one of a row in an impact would throw it back.
  const bool has_stiffness = (surface.mode & dContactSoftERP) != 0, bounces = (surface.mode & dContactBounce) != 0;
  const bool is_between_bodies = can_be_pushed(a.geom.id()) && can_be_pushed(b.geom.id());
  if (!has_stiffness && (!bounces || is_between_bodies) && joint_contact.geom.depth < fastest_impact * physics_.step)
    joint_contact.geom.depth = std::min(joint_contact.geom.depth, (bounces ? bounce_correction : hard_correction) * physics_.step / erp_);
  // What meshes are pushed apart with stays in their motion.
  if (is_mesh(a) && is_mesh(b)) joint_contact.geom.depth = std::min(joint_contact.geom.depth, mesh_correction * physics_.step / erp_);
  set_friction_direction(a, b, joint_contact);
  if (a.slip || b.slip) let_slip(a.slip ? *a.slip : *b.slip, joint_contact);
  if (a.belt || b.belt) {
    run_belt(a.belt ? *a.belt : *b.belt, a.belt != nullptr, joint_contact);
    if (b.belt && b.link.model != model_a.id()) model_a.lies_on_belt = true;
    if (a.belt && model_b != nullptr && model_b != &model_a) model_b->lies_on_belt = true;
    if ((joint_contact.surface.mode & dContactMotion1) != 0) groups_.note_driven(model_a);
  }
  const double weight_a = can_be_pushed(a.geom.id()) ? model_a.mass() * gravity_ : 0;
  const double weight_b = model_b != nullptr && can_be_pushed(b.geom.id()) ? model_b->mass() * gravity_ : 0;
  // A plate sags by its own weight; below a thousand tons it would sink through the floor.
  const double carried = std::max(model_a.load_near, model_b != nullptr ? model_b->load_near : 0) * gravity_ / max_sag;
  soften(joint_contact, std::max({weight_a, weight_b, carried}), erp_, physics_.step);
  const double lighter = weight_a > 0 && weight_b > 0 ? std::min(weight_a, weight_b) : std::max(weight_a, weight_b);
  const auto usual_contacts = static_cast<double>(std::max<std::size_t>(model_a.previous_contacts.size(), 1));
  resist_sliding(joint_contact, dGeomGetBody(a.geom.id()), dGeomGetBody(b.geom.id()), lighter / usual_contacts);
  for (const dBodyID body : {dGeomGetBody(a.geom.id()), dGeomGetBody(b.geom.id())}) {
    if (body != nullptr && is_ill_conditioned(compliance_at(body, geometry.pos), dWorldGetCFM(world_.id()) / physics_.step))
      groups_.note_ill_conditioned(model_a);
  }
  if ((surface.mode & dContactBounce) != 0) impacts_.add(dGeomGetBody(a.geom.id()), dGeomGetBody(b.geom.id()), joint_contact);
  const dJointID joint = dJointCreateContact(world_.id(), contact_joints_.id(), &joint_contact);
  dJointAttach(joint, dGeomGetBody(a.geom.id()), dGeomGetBody(b.geom.id()));
  if (has_many_joints_) made_contacts_.push_back({joint, joint_contact, dGeomGetBody(a.geom.id()), dGeomGetBody(b.geom.id()), &model_a});
  if (model_a.records_forces || (model_b != nullptr && model_b->records_forces)) {
    feedback_.push_back({{}, &model_a, model_b, model_a.contacts.size() - 1, model_b != nullptr ? model_b->contacts.size() - 1 : 0});
    if (model_b == &model_a) --feedback_.back().contact_a;
    dJointSetFeedback(joint, &feedback_.back().joint);
    if (has_many_joints_) made_contacts_.back().feedback = &feedback_.back().joint;
  }
}

void Shard::read_forces() {
  for (const auto& feedback : feedback_) {
    const Eigen::Vector3d force = ode::vector(feedback.joint.f1);
    if (!force.allFinite()) continue;
    feedback.a->contacts[feedback.contact_a].force = force;
    if (feedback.b != nullptr) feedback.b->contacts[feedback.contact_b].force = -force;
  }
}

}  // namespace sim
