#include "physics/physics.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "physics/joined_sets.h"
#include "physics/physics_impl.h"

namespace sim {
namespace {

constexpr double margin = 0.3;  // of neighbourhoods [m]
constexpr std::size_t max_shards = 16;
constexpr double same_event = 60;  // [s] that a model keeps to the numbers until it is told of again that it left them

}  // namespace

void Physics::Impl::build(std::vector<std::string>& notes, std::vector<std::string>* dropped) {
  welds_.clear();
  models_.clear();
  shards_.clear();
  statics_.clear();
  steps_ = 0;
  moves_ = 0;
  if (dropped != nullptr) wind_ = Wind(wind_of(*world_, *dropped), world_->physics.step);
  wind_.reset();
  if (dropped != nullptr) {
    for (const auto& model : world_->models) {
      auto blueprint = Blueprint::of(std::shared_ptr<const ModelDef>(world_, &model));
      if (!blueprint) dropped->push_back(blueprint.error().message);
      if (blueprint) notes.insert(notes.end(), (*blueprint)->notes.begin(), (*blueprint)->notes.end());
      if (blueprint) dropped->insert(dropped->end(), (*blueprint)->left_out.begin(), (*blueprint)->left_out.end());
      initial_.push_back(blueprint ? *blueprint : nullptr);
    }
  }
  const auto moving = static_cast<std::size_t>(
      std::count_if(initial_.begin(), initial_.end(), [](const auto& blueprint) { return blueprint && !blueprint->is_static; }));
  const bool one = world_->physics.solver == PhysicsDef::Solver::iterative;
  const std::size_t shards = one ? 1 : std::clamp<std::size_t>(moving / 3, 1, max_shards);
  for (std::size_t i = 0; i < shards; ++i) shards_.push_back(std::make_unique<Shard>(world_->physics, wind_.air()));
  models_.resize(initial_.size());
  for (ModelId id = 0; id < initial_.size(); ++id) {
    if (initial_[id]) add(id, initial_[id], dropped != nullptr ? *dropped : notes);
  }
  refresh_statics();
  partition();
}

void Physics::Impl::add(ModelId id, std::shared_ptr<const Blueprint> blueprint, std::vector<std::string>& lost) {
  const Eigen::Isometry3d base = blueprint->model->pose;
  auto model = std::make_unique<ModelInstance>(id, std::move(blueprint), base, world_->physics, store_, lost);
  if (has_bodies(*model)) {
    const auto smallest =
        std::min_element(shards_.begin(), shards_.end(), [](const auto& a, const auto& b) { return a->models.size() < b->models.size(); });
    model->shard = static_cast<int>(smallest - shards_.begin());
    model->enter((*smallest)->world(), world_->physics);
    model->take_initial_velocities();
    let_roll(*model);
    auto& list = (*smallest)->models;
    list.insert(std::lower_bound(list.begin(), list.end(), id, [](auto* m, ModelId i) { return m->id() < i; }), model.get());
  }
  models_[id] = std::move(model);
}

void Physics::Impl::let_roll(ModelInstance& model) const {
  model.stop_rolling();
  model.rolling = may_roll_ ? Rolling::of(model, world_->physics) : nullptr;
}

void Physics::Impl::refresh_statics() {
  statics_.clear();
  for (const auto& model : models_) {
    if (model) model->stop_rolling();
  }
  for (const auto& model : models_) {
    if (!model) continue;
    for (auto& shape : model->shapes()) {
      if (model->blueprint().assemblies[shape.assembly].is_anchored) statics_.push_back(&shape);
    }
  }
  static_index_.build(statics_);
  for (const auto& model : models_) {
    if (model && has_bodies(*model)) model->left_neighbourhood = true;
  }
}

void Physics::Impl::update_neighbourhood(ModelInstance& model) {
  const Aabb& box = model.update_boxes();
  model.neighbourhood = box;
  model.near_statics.clear();
  if (box.is_empty()) return;
  // Faster models look further, so that they need not look in every step.
  double speed = 0;
  for (std::uint32_t i = 0; i < model.body_count(); ++i) {
    if (model.body(i) != nullptr) speed = std::max(speed, ode::vector(dBodyGetLinearVel(model.body(i))).norm());
  }
  const double reach = margin + std::min(speed, 20.0) * 0.25;
  model.neighbourhood.low.array() -= reach;
  model.neighbourhood.high.array() += reach;
  static_index_.find(model.neighbourhood, model.near_statics);
}

void Physics::Impl::partition() {
  std::vector<ModelInstance*> moving, left;
  for (const auto& model : models_) {
    if (!model || !has_bodies(*model)) continue;
    moving.push_back(model.get());
    if (model->left_neighbourhood) left.push_back(model.get());
  }
  if (left.empty()) return;
  for (auto* model : left) {
    for (auto* other : model->neighbours) {
      if (!other->left_neighbourhood) std::erase(other->neighbours, model);
    }
    model->neighbours.clear();
  }
  for (auto* model : left) update_neighbourhood(*model);
  if (const auto* crowded = find_neighbours(moving, left); crowded != nullptr && !is_crowding_told_) {
    is_crowding_told_ = true;
    complaints_.push_back(fmt::format("model {}: lies near more than {} others, some of which it does not touch",
                                      crowded->blueprint().model->name, max_neighbours));
  }
  for (auto* model : left) model->left_neighbourhood = false;
  std::vector<std::uint32_t> parents(models_.size());
  std::iota(parents.begin(), parents.end(), 0U);
  for (const auto* model : moving) {
    for (const auto* other : model->neighbours) {
      const auto x = root(parents, model->id()), y = root(parents, other->id());
      parents[std::max(x, y)] = std::min(x, y);
    }
  }
  for (const auto& weld : welds_) {
    const auto x = root(parents, weld->first().id()), y = root(parents, weld->second().id());
    if (has_bodies(weld->first())) parents[std::max(x, y)] = std::min(x, y);
  }
  if (shards_.size() > 1) share_out(parents);
}

// Models that may meet go to one shard; shards that have become too full give models away.
void Physics::Impl::share_out(std::vector<std::uint32_t>& parents) {
  std::vector<std::uint32_t> group_size(models_.size(), 0);
  std::size_t count = 0;
  for (ModelId id = 0; id < models_.size(); ++id) {
    if (!models_[id] || !has_bodies(at(id))) continue;
    ++count;
    const auto leader = root(parents, id);
    ++group_size[leader];
    if (at(id).shard != at(leader).shard) move_to(at(id), at(leader).shard);
  }
  const std::size_t limit = 2 * count / shards_.size() + 2;
  for (ModelId id = 0; id < models_.size(); ++id) {
    if (!models_[id] || !has_bodies(at(id)) || group_size[id] != 1) continue;
    if (shards_[static_cast<std::size_t>(at(id).shard)]->models.size() <= limit) continue;
    const auto smallest =
        std::min_element(shards_.begin(), shards_.end(), [](const auto& a, const auto& b) { return a->models.size() < b->models.size(); });
    move_to(at(id), static_cast<int>(smallest - shards_.begin()));
  }
}

void Physics::Impl::move_to(ModelInstance& model, int shard) {
  ++moves_;
  auto& from = shards_[static_cast<std::size_t>(model.shard)]->models;
  std::erase(from, &model);
  auto& to = shards_[static_cast<std::size_t>(shard)]->models;
  to.insert(std::lower_bound(to.begin(), to.end(), &model, [](auto* a, auto* b) { return a->id() < b->id(); }), &model);
  const auto states = model.save();
  const bool had_left = model.left_neighbourhood;
  model.enter(shards_[static_cast<std::size_t>(shard)]->world(), world_->physics);
  model.restore(states, world_->physics.step);
  model.update_boxes();
  model.left_neighbourhood = had_left;
  model.shard = shard;
}

void Physics::Impl::put_back_insane(Shard& shard) {
  for (auto* model : std::vector<ModelInstance*>(shard.models)) {
    if (model->is_sane()) continue;
    // What leaves them again and again is one event, not one each time.
    const bool is_told = model->put_back_at && static_cast<double>(steps_ - *model->put_back_at) * world_->physics.step < same_event;
    model->put_back_at = steps_;
    if (!is_told) {
      complaints_.push_back(
          fmt::format("model {}: left the range of numbers and was put back to where it started", model->blueprint().model->name));
    }
    drop_welds([&](const Weld& weld) { return weld.is_of(*model); });
    model->stop_rolling();
    model->enter(shard.world(), world_->physics);
    model->left_neighbourhood = true;
    shard.has_left = true;
  }
}

void Physics::Impl::step() {
  const auto step_one = [&](std::size_t i) { shards_[i]->step(statics_, steps_); };
  pool_.run(shards_.size(), step_one, pace_);
  wind_.step();
  ++steps_;
  bool has_left = false;
  for (auto& shard : shards_) {
    if (shard->is_insane) put_back_insane(*shard);
    has_left = has_left || shard->has_left;
  }
  if (has_left) partition();
}

// --- the public face

Physics::Physics(std::shared_ptr<const WorldDef> world, WorkerPool& pool, TriangleCache& triangles, std::vector<std::string>& notes,
                 std::vector<std::string>& dropped)
    : impl_(std::make_unique<Impl>(std::move(world), pool, triangles)) {
  impl_->build(notes, &dropped);
}
Physics::~Physics() = default;

void Physics::let_roll(bool on) {
  impl_->may_roll_ = on;
  for (const auto& model : impl_->models_) {
    if (model && impl_->has_bodies(*model)) impl_->let_roll(*model);
  }
}

void Physics::step() { impl_->step(); }

void Physics::reset() {
  std::vector<std::string> notes;
  impl_->build(notes, nullptr);
}

void Physics::reset_poses() {
  impl_->drop_welds([](const Weld&) { return true; });
  for (const auto& model : impl_->models_) {
    if (!model) continue;
    model->stop_rolling();
    model->set_base(model->blueprint().model->pose);
    if (impl_->has_bodies(*model)) model->enter(impl_->shards_[static_cast<std::size_t>(model->shard)]->world(), impl_->world_->physics);
  }
  impl_->refresh_statics();
  impl_->partition();
}

double Physics::step_length() const { return impl_->world_->physics.step; }
Eigen::Vector3d Physics::wind() const { return impl_->wind_.air().wind; }
std::uint64_t Physics::steps() const { return impl_->steps_; }
std::size_t Physics::model_slots() const { return impl_->models_.size(); }
bool Physics::exists(ModelId model) const { return model < impl_->models_.size() && impl_->models_[model] != nullptr; }

std::optional<ModelId> Physics::find(std::string_view name) const {
  for (ModelId id = 0; id < impl_->models_.size(); ++id) {
    if (impl_->models_[id] && def(id).name == name) return id;
  }
  return std::nullopt;
}

const ModelDef& Physics::def(ModelId model) const { return *impl_->at(model).blueprint().model; }
std::shared_ptr<const ModelDef> Physics::shared_def(ModelId model) const { return impl_->at(model).blueprint().model; }

LinkId Physics::canonical_link(ModelId model) const { return {model, impl_->at(model).blueprint().canonical}; }

std::optional<LinkId> Physics::find_link(std::string_view name) const {
  if (const auto model = find(name)) return def(*model).links.empty() ? std::nullopt : std::optional(canonical_link(*model));
  for (auto at = name.find("::"); at != std::string_view::npos; at = name.find("::", at + 2)) {
    const auto model = find(name.substr(0, at));
    if (!model) continue;
    const auto& links = def(*model).links;
    for (std::uint32_t i = 0; i < links.size(); ++i) {
      if (links[i].name == name.substr(at + 2)) return LinkId{*model, i};
    }
  }
  return std::nullopt;
}

std::optional<JointId> Physics::find_joint(std::string_view name) const {
  for (auto at = name.find("::"); at != std::string_view::npos; at = name.find("::", at + 2)) {
    const auto model = find(name.substr(0, at));
    if (!model) continue;
    const auto& joints = def(*model).joints;
    for (std::uint32_t i = 0; i < joints.size(); ++i) {
      if (joints[i].name == name.substr(at + 2)) return JointId{*model, i};
    }
  }
  return std::nullopt;
}

base::Result<ModelId> Physics::spawn(std::shared_ptr<const ModelDef> model, std::vector<std::string>& notes) {
  if (find(model->name)) return base::Error{fmt::format("model {}: a model of that name exists", model->name)};
  auto blueprint = Blueprint::of(std::move(model));
  if (!blueprint) return blueprint.error();
  notes.insert(notes.end(), (*blueprint)->notes.begin(), (*blueprint)->notes.end());
  notes.insert(notes.end(), (*blueprint)->left_out.begin(), (*blueprint)->left_out.end());
  const auto id = static_cast<ModelId>(impl_->models_.size());
  impl_->models_.emplace_back();
  impl_->add(id, *blueprint, notes);
  impl_->refresh_statics();
  impl_->partition();
  return id;
}

void Physics::remove(ModelId model) {
  auto& instance = impl_->models_[model];
  impl_->drop_welds([&](const Weld& weld) { return weld.is_of(*instance); });
  if (instance->shard >= 0) std::erase(impl_->shards_[static_cast<std::size_t>(instance->shard)]->models, instance.get());
  for (auto* neighbour : instance->neighbours) std::erase(neighbour->neighbours, instance.get());
  // What rested on it must notice.
  for (const auto& other : impl_->models_) {
    if (other && impl_->has_bodies(*other)) other->wake();
  }
  instance.reset();
  impl_->refresh_statics();
  impl_->partition();
}

bool Physics::is_static(ModelId model) const { return impl_->at(model).blueprint().is_static; }

bool Physics::can_move(LinkId link) const { return piece_can_move(link.model, piece_of(link)); }

Eigen::Isometry3d Physics::model_pose(ModelId model) const {
  const ModelInstance& instance = impl_->at(model);
  if (instance.blueprint().model->links.empty()) return instance.base();
  const LinkId link = canonical_link(model);
  return link_pose(link) * instance.blueprint().model->links[link.link].pose.inverse();
}

Eigen::AlignedBox3d Physics::shape_box(ModelId model) const {
  Eigen::AlignedBox3d box;
  const Eigen::Isometry3d to_model = model_pose(model).inverse();
  for (const auto& shape : impl_->at(model).shapes()) {
    const CollisionDef& collision = def(model).links[shape.link.link].collisions[shape.collision];
    box.extend(box_of(shape, collision.geometry, to_model * link_pose(shape.link) * collision.pose));
  }
  return box;
}

Eigen::Isometry3d Physics::link_pose(LinkId link) const {
  const ModelInstance& model = impl_->at(link.model);
  return model.assembly_pose(model.blueprint().assembly_of_link[link.link]) * model.blueprint().link_in_body[link.link];
}

Eigen::Vector3d Physics::center_of_mass(LinkId link) const { return piece_pose(link.model, piece_of(link)).translation(); }

Eigen::Vector3d Physics::point_velocity(LinkId link, const Eigen::Vector3d& point) const {
  const ModelInstance& model = impl_->at(link.model);
  if (model.body_count() == 0) return Eigen::Vector3d::Zero();
  const dBodyID body = model.body(model.blueprint().assembly_of_link[link.link]);
  if (body == nullptr) return Eigen::Vector3d::Zero();
  return ode::vector(dBodyGetLinearVel(body)) + ode::vector(dBodyGetAngularVel(body)).cross(point - ode::vector(dBodyGetPosition(body)));
}

Twist Physics::link_twist(LinkId link) const {
  const ModelInstance& model = impl_->at(link.model);
  const dBodyID body = model.body_count() == 0 ? nullptr : model.body(model.blueprint().assembly_of_link[link.link]);
  if (body == nullptr) return {};
  return {point_velocity(link, link_pose(link).translation()), ode::vector(dBodyGetAngularVel(body))};
}

std::optional<Wrench> Physics::joint_load(JointId joint) const {
  const JointInstance* instance = impl_->at(joint.model).joint(joint.joint);
  return instance == nullptr ? std::nullopt : instance->load();
}

std::span<const Contact> Physics::contacts(ModelId model) const { return impl_->at(model).contacts; }
std::uint64_t Physics::contacts_so_far(ModelId model) const { return impl_->at(model).contacts_so_far; }
void Physics::record_forces(ModelId model) { impl_->at(model).records_forces = true; }

namespace {

void add_parts_to(StateHash& hash, const ModelInstance& model) {
  model.for_each_state([&hash](const BodyState& state) {
    const auto &p = state.position, &v = state.linear, &w = state.angular;
    const auto& q = state.orientation;
    hash.add_all(p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z(), std::uint64_t{state.is_awake});
  });
  for (const auto& joint : model.joints()) {
    const auto &first = joint.drive(0), &second = joint.drive(1);
    hash.add_all(first.velocity, first.effort, second.velocity, second.effort);
    for (int axis = 0; axis < joint.axis_count(); ++axis) {
      if (!joint.has_history(axis)) continue;
      const auto& place = joint.places()[static_cast<std::size_t>(axis)];
      hash.add_all(static_cast<std::uint64_t>(axis), static_cast<std::uint64_t>(place.turns), place.low, place.high);
    }
  }
  model.forces().add_to(hash);
  if (model.rolling) model.rolling->add_to(hash);
}

}  // namespace

void Physics::add_to(StateHash& hash) const {
  hash.add(impl_->steps_);
  for (const auto& model : impl_->models_) {
    if (model) add_to(hash, model->id());
  }
  for (const auto& weld : impl_->welds_) weld->add_to(hash);
}

void Physics::add_to(StateHash& hash, ModelId id) const {
  hash.add(std::uint64_t{id});
  hash.add(model_pose(id).translation());
  add_parts_to(hash, impl_->at(id));
}

void Physics::add_place_and_parts_to(StateHash& hash, ModelId id) const {
  const ModelInstance& model = impl_->at(id);
  for (int column = 0; column < 4; ++column) hash.add(Eigen::Vector3d(model.base().matrix().col(column).head<3>()));
  add_parts_to(hash, model);
}

PhysicsStatistics Physics::statistics() const {
  PhysicsStatistics s;
  s.shards = static_cast<std::uint32_t>(impl_->shards_.size());
  s.moves_between_shards = impl_->moves_;
  std::uint32_t half_contacts = 0;  // what touches something else that moves is told by both
  for (const auto& model : impl_->models_) {
    if (!model) continue;
    s.rolling += model->rolls() ? 1 : 0;
    s.joints += static_cast<std::uint32_t>(model->joints().size());
    for (const Contact& contact : model->contacts)
      half_contacts += exists(contact.other.model) && !is_static(contact.other.model) ? 1U : 2U;
    for (std::uint32_t i = 0; i < model->body_count(); ++i) {
      if (model->body(i) == nullptr) continue;
      ++s.bodies;
      if (model->rolls() ? !model->rolling->is_asleep() : dBodyIsEnabled(model->body(i)) != 0) ++s.awake;
    }
  }
  s.contacts = (half_contacts + 1) / 2;
  return s;
}

StepSolver Physics::last_solver(ModelId model) const {
  const ModelInstance& instance = impl_->at(model);
  return instance.is_tree_solved ? StepSolver::tree : instance.is_iterative ? StepSolver::iterative : StepSolver::dense;
}

std::vector<std::string> Physics::take_complaints() { return std::exchange(impl_->complaints_, {}); }

std::uint32_t Physics::piece_count(ModelId model) const {
  return static_cast<std::uint32_t>(impl_->at(model).blueprint().assemblies.size());
}
std::uint32_t Physics::piece_of(LinkId link) const { return impl_->at(link.model).blueprint().assembly_of_link[link.link]; }
bool Physics::piece_can_move(ModelId model, std::uint32_t piece) const {
  return !impl_->at(model).blueprint().assemblies[piece].is_anchored;
}
Eigen::Isometry3d Physics::piece_pose(ModelId model, std::uint32_t piece) const { return impl_->at(model).assembly_pose(piece); }
std::vector<std::uint32_t> Physics::piece_links(ModelId model, std::uint32_t piece) const {
  return impl_->at(model).blueprint().assemblies[piece].links;
}
Eigen::Isometry3d Physics::link_in_piece(LinkId link) const { return impl_->at(link.model).blueprint().link_in_body[link.link]; }

}  // namespace sim
