#include "server/simulation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>

#include "base/text.h"
#include "devices/faulty_device.h"

namespace sim {
namespace {

constexpr std::size_t followers_of_share = 16;

}  // namespace

Simulation::Simulation(std::shared_ptr<const WorldDef> world, shm::Server& shm, const SimulationOptions& options)
    : world_(std::move(world)), options_(options), pool_(options.threads), step_(std::llround(world_->physics.step * 1e9)) {
  (void)shm;
}

base::Result<std::unique_ptr<Simulation>> Simulation::create(std::shared_ptr<const WorldDef> world, shm::Server& shm,
                                                             const SimulationOptions& options, std::vector<std::string>& notes,
                                                             std::vector<std::string>& dropped) {
  if (!(world->physics.step >= 1e-6 && world->physics.step <= 1)) {
    return base::Error{"world " + world->name + ": step must be between 1e-6 and 1 s, got " + std::to_string(world->physics.step)};
  }
  std::unique_ptr<Simulation> s(new Simulation(std::move(world), shm, options));
  s->physics_ = std::make_unique<Physics>(s->world_, s->pool_, s->triangles_, notes, dropped);
  if (options.rolling) s->physics_->let_roll(true);
  s->rays_ = std::make_unique<RayWorld>(*s->physics_, s->triangles_);
  s->pictures_ = std::make_unique<RenderWorld>(*s->physics_, *s->world_);
  s->device_world_.reset(new DeviceWorld{*s->physics_, *s->rays_, shm, options.seed, *s->world_, s->pictures_.get(), &s->tags_});
  s->initial_models_ = s->physics_->model_slots();
  std::vector<std::string> ray_notes;  // physics has said the same about the same shapes
  for (ModelId id = 0; id < s->initial_models_; ++id) {
    if (s->physics_->exists(id)) s->rays_->add(id, ray_notes);
  }
  s->rays_->update();
  for (ModelId id = 0; id < s->initial_models_; ++id) {
    if (!s->physics_->exists(id)) continue;
    if (auto made = s->make_devices_of(id, dropped); !made) return made.error();
  }
  if (auto checked = s->check_faults(); !checked) return checked.error();
  s->sort_devices();
  s->standing_ = standing_wrenches_of(*s->world_, dropped);
  for (ModelId id = 0; id < s->initial_models_; ++id) {
    if (s->physics_->exists(id)) s->add_standing_wrenches(id);
  }
  s->note_absent_models(notes, dropped);
  return s;
}

// That plugins of the world mean: they may be spawned later.
void Simulation::note_absent_models(std::vector<std::string>& notes, std::vector<std::string>& dropped) const {
  for (const StandingWrench& wrench : standing_) {
    const auto link = physics_->find_link(wrench.entity);
    if (!link) {
      notes.push_back(wrench.source + ": there is no " + base::in_quotes(wrench.entity) +
                      " that <persistent> pushes; it is pushed when it is spawned");
    } else if (!physics_->can_move(*link)) {
      dropped.push_back(wrench.source + ": " + base::in_quotes(wrench.entity) + ", which <persistent> pushes, cannot move");
    }
  }
  if (!world_->physics.fluid) return;
  for (const std::string& name : world_->physics.fluid->models) {
    if (!physics_->find(name))
      notes.push_back("plugin Buoyancy: there is no model " + base::in_quotes(name) +
                      " that <enable> names; it is carried when it is spawned");
  }
}

base::Result<void> Simulation::make_devices_of(ModelId model, std::vector<std::string>& left_out) {
  auto made = make_devices(*device_world_, model, left_out);
  if (!made) return made.error();
  for (auto& device : *made) {
    device->iface().set_resets(resets_);
    if (const auto added = add_first_faults(device); !added) return added;
    devices_.push_back(std::move(device));
  }
  for (const JointHold& hold : joint_holds_of(*physics_, model, left_out)) holds_.push_back(hold);
  attachments_.add(*physics_, model, left_out);
  return {};
}

void Simulation::sort_devices() {
  ++arrangement_;
  std::stable_sort(devices_.begin(), devices_.end(), [](const auto& a, const auto& b) { return a->model() < b->model(); });
  followers_.clear();
  shares_.clear();
  for (const auto& device : devices_) {
    if (!device->follows_steps()) continue;
    const bool is_new_model = followers_.empty() || followers_.back()->model() != device->model();
    if (is_new_model && followers_.size() - (shares_.empty() ? 0 : shares_.back()) >= followers_of_share)
      shares_.push_back(followers_.size());
    followers_.push_back(device.get());
  }
  shares_.push_back(followers_.size());
}

void Simulation::for_followers(const std::function<void(Device&)>& work) {
  if (shares_.size() <= 1) {
    for (auto* device : followers_) work(*device);
    return;
  }
  pool_.run(
      shares_.size(),
      [&](std::size_t i) {
        for (std::size_t d = i == 0 ? 0 : shares_[i - 1]; d < shares_[i]; ++d) work(*followers_[d]);
      },
      commands_pace_);
}

void Simulation::step(PartTimes& times) {
  const Moment moment{time_, world_->physics.step};
  for (const JointHold& hold : holds_) hold.before_step(*physics_);  // a drive that has the same joint wins
  attachments_.before_step(*physics_, time_);
  for_followers([&](Device& device) { device.before_step(moment); });
  push();
  times.mark(Part::commands);
  physics_->step();
  ++steps_;
  time_ += step_;
  std::erase_if(wrenches_, [&](const Wrench& wrench) { return wrench.until <= time_; });
  times.mark(Part::physics);
  const Moment after{time_, world_->physics.step};
  for_followers([&](Device& device) { device.after_step(after); });
  if (steps_ % 16 == 0) follow_trails();
  times.mark(Part::commands);
}

void Simulation::push() {
  for (const auto& wrench : wrenches_) {
    if (!physics_->exists(wrench.link.model)) continue;
    if (wrench.joint) {
      (void)physics_->add_effort({wrench.link.model, *wrench.joint}, wrench.force.x());
      continue;
    }
    Eigen::Vector3d torque = wrench.torque;
    if (wrench.is_at_origin)
      torque += (physics_->link_pose(wrench.link).translation() - physics_->center_of_mass(wrench.link)).cross(wrench.force);
    (void)physics_->add_wrench(wrench.link, wrench.force, torque);
  }
}

void Simulation::add_standing_wrenches(ModelId model) {
  for (const StandingWrench& wrench : standing_) {
    const auto link = physics_->find_link(wrench.entity);
    if (!link || link->model != model || !physics_->can_move(*link)) continue;
    put({*link, wrench.force, wrench.torque, std::chrono::nanoseconds::max(), true, true});
  }
}

bool Simulation::sense(PartTimes& times, const std::function<bool()>& before_writing) {
  const Moment moment{time_, world_->physics.step};
  due_.clear();
  bool needs_rays = false;
  for (const auto& device : devices_) {
    if (!device->wants_sample(moment)) continue;
    due_.push_back(device.get());
    needs_rays = needs_rays || device->uses_rays();
  }
  if (due_.empty()) {
    times.mark(Part::sensors);
    return true;
  }
  active_sensors_ = std::max(active_sensors_, static_cast<std::uint32_t>(due_.size()));
  times.begin_due(Part::sensors);
  // Pictures are written into their ifaces as soon as they are drawn.
  const bool has_pictures = std::ranges::any_of(due_, [](Device* device) { return shm::has_frames(device->iface().type()); });
  if (has_pictures && before_writing && !before_writing()) return false;
  if (needs_rays) {
    rays_->update();
    times.mark(Part::rays);
    // Each in its own buffers; what is drawn at random comes from streams of their own.
    pool_.run(due_.size(), [&](std::size_t i) { due_[i]->take_sample(moment); });
  } else {
    for (auto* device : due_) device->take_sample(moment);
  }
  times.mark(Part::sensors);
  if (!has_pictures && before_writing && !before_writing()) return false;
  for (auto* device : due_) device->publish(moment);
  times.mark(Part::publish);
  times.end_due();
  return true;
}

void Simulation::answer_new_subscribers() {
  due_.clear();
  for (auto& device : devices_) {
    if (device->owes_sample()) due_.push_back(device.get());
  }
  show_due();
}

void Simulation::show_present() {
  // By name: a camera has several ifaces, and shows all of them.
  std::set<std::string_view> wanted;
  for (auto& device : devices_) {
    if (device->iface().is_subscribed()) wanted.insert(device->iface().name());
  }
  due_.clear();
  for (auto& device : devices_) {
    if (wanted.contains(device->iface().name())) due_.push_back(device.get());
  }
  show_due();
}

void Simulation::show_due() {
  const Moment moment{time_, world_->physics.step};
  if (std::any_of(due_.begin(), due_.end(), [](const Device* device) { return device->uses_rays(); })) rays_->update();
  for (auto* device : due_) device->show(moment);
}

void Simulation::follow_trails() {
  trails_.resize(physics_->model_slots());
  for (ModelId id = 0; id < trails_.size(); ++id) {
    if (!physics_->exists(id) || physics_->is_static(id)) continue;
    Trail& trail = trails_[id];
    const Eigen::Vector3f p = physics_->model_pose(id).translation().cast<float>();
    if (!trail.points.empty() && (trail.points.back() - p).norm() < trail.spacing) continue;
    trail.points.push_back(p);
    if (trail.points.size() < 4096) continue;
    // Every other point is enough from now on.
    for (std::size_t i = 0; i < trail.points.size() / 2; ++i) trail.points[i] = trail.points[2 * i];
    trail.points.resize(trail.points.size() / 2);
    trail.spacing *= 2;
  }
}

void Simulation::set_seed(std::uint64_t seed) {
  options_.seed = seed;
  device_world_->seed = seed;
  for (auto& device : devices_) {
    if (auto* faulty = dynamic_cast<FaultyDevice*>(device.get())) faulty->set_seed(seed);
  }
}

base::Result<void> Simulation::reset(std::vector<std::string>& notes) {
  std::vector<bool> was_there(initial_models_, false);
  for (ModelId id = 0; id < physics_->model_slots(); ++id) {
    if (!physics_->exists(id)) continue;
    if (id < initial_models_) {
      was_there[id] = true;
    } else {
      rays_->remove(id);
    }
  }
  std::erase_if(devices_, [&](const auto& device) { return device->model() >= initial_models_; });
  std::erase_if(holds_, [&](const JointHold& hold) { return hold.joint.model >= initial_models_; });
  physics_->reset();
  attachments_.reset(static_cast<ModelId>(initial_models_));
  tags_.reset();
  wrenches_.clear();
  trails_.clear();
  time_ = std::chrono::nanoseconds(0);
  steps_ = 0;
  ++resets_;
  for (ModelId id = 0; id < initial_models_; ++id) {
    if (!physics_->exists(id)) continue;
    add_standing_wrenches(id);
    if (was_there[id]) {
      rays_->moved(id);
      continue;
    }
    rays_->add(id, notes);
    if (auto made = make_devices_of(id, notes); !made) return made;
  }
  sort_devices();
  rays_->update();
  for (auto& device : devices_) {
    device->reset();
    device->iface().set_resets(resets_);
  }
  return restore_faults();
}

void Simulation::reset_poses() {
  physics_->reset_poses();
  attachments_.reset(static_cast<ModelId>(physics_->model_slots()));
  for (ModelId id = 0; id < physics_->model_slots(); ++id) {
    if (physics_->exists(id)) rays_->moved(id);
  }
  for (auto& device : devices_) device->reset();
  std::erase_if(wrenches_, [](const Wrench& wrench) { return !wrench.stays; });
  trails_.clear();
}

base::Result<ModelId> Simulation::spawn(const ModelDef& model, std::vector<std::string>& notes) {
  const auto next = static_cast<ModelId>(physics_->model_slots());
  try {
    return spawn_whole(model, notes);
  } catch (const std::bad_alloc&) {
    if (physics_->exists(next)) remove(next);
    return base::Error{"model " + model.name + ": is too large for the memory"};
  }
}

base::Result<ModelId> Simulation::spawn_whole(const ModelDef& model, std::vector<std::string>& notes) {
  const auto id = physics_->spawn(std::make_shared<const ModelDef>(model), notes);
  if (!id) return id;
  rays_->add(*id, notes);
  if (auto made = make_devices_of(*id, notes); !made) {
    remove(*id);
    return made.error();
  }
  sort_devices();
  add_standing_wrenches(*id);
  return id;
}

void Simulation::remove(ModelId model) {
  std::erase_if(devices_, [&](const auto& device) { return device->model() == model; });
  sort_devices();
  std::erase_if(holds_, [&](const JointHold& hold) { return hold.joint.model == model; });
  std::erase_if(wrenches_, [&](const Wrench& wrench) { return wrench.link.model == model; });
  attachments_.remove(model);
  tags_.forget_model(physics_->def(model).name);
  if (model < trails_.size()) trails_[model] = Trail();
  rays_->remove(model);
  physics_->remove(model);
}

base::Result<void> Simulation::set_pose(ModelId model, const Eigen::Isometry3d& pose) {
  auto done = physics_->set_model_pose(model, pose);
  if (!done) return done;
  rays_->moved(model);
  if (model < trails_.size()) trails_[model] = Trail();  // it has not driven there
  return done;
}

base::Result<void> Simulation::add_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque,
                                          std::chrono::nanoseconds duration) {
  if (const auto good = check_wrench(link, force, torque); !good) return good;
  put({link, force, torque, time_ + std::max(duration, step_)});
  return {};
}

base::Result<void> Simulation::keep_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) {
  if (const auto good = check_wrench(link, force, torque); !good) return good;
  std::erase_if(wrenches_, [&](const Wrench& wrench) { return wrench.stays && !wrench.joint && wrench.link == link; });
  if (!force.isZero(0) || !torque.isZero(0)) put({link, force, torque, std::chrono::nanoseconds::max(), true});
  return {};
}

base::Result<void> Simulation::add_effort(JointId joint, double effort, std::chrono::nanoseconds duration) {
  if (const auto good = physics_->check_effort(joint, effort); !good) return good;
  put({.link = {joint.model, 0},
       .force = {effort, 0, 0},
       .torque = {0, 0, 0},
       .until = time_ + std::max(duration, step_),
       .joint = joint.joint});
  return {};
}

base::Result<void> Simulation::keep_effort(JointId joint, double effort) {
  if (const auto good = physics_->check_effort(joint, effort); !good) return good;
  std::erase_if(wrenches_, [&](const Wrench& wrench) {
    return wrench.stays && wrench.link.model == joint.model && wrench.joint && *wrench.joint == joint.joint;
  });
  if (effort == 0) return {};
  put({.link = {joint.model, 0},
       .force = {effort, 0, 0},
       .torque = {0, 0, 0},
       .until = std::chrono::nanoseconds::max(),
       .stays = true,
       .joint = joint.joint});
  return {};
}

void Simulation::put(const Wrench& wrench) {
  const auto key = [](const Wrench& w) {
    const Eigen::Vector3d &f = w.force, &t = w.torque;
    return std::tuple(w.link.model, w.link.link, w.joint, w.stays, w.until, f.x(), f.y(), f.z(), t.x(), t.y(), t.z());
  };
  const auto after = std::upper_bound(wrenches_.begin(), wrenches_.end(), wrench,
                                      [&](const Wrench& one, const Wrench& other) { return key(one) < key(other); });
  wrenches_.insert(after, wrench);
}

base::Result<void> Simulation::check_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) const {
  if (!physics_->can_move(link)) return base::Error{"model " + physics_->def(link.model).name + ": cannot move"};
  if (!force.allFinite() || !torque.allFinite() || force.cwiseAbs().maxCoeff() > 1e7 || torque.cwiseAbs().maxCoeff() > 1e7) {
    return base::Error{"model " + physics_->def(link.model).name + ": force and torque must be finite and below 1e7"};
  }
  return {};
}

std::optional<base::Result<void>> Simulation::turn_attachment(std::string_view name, bool is_on) {
  if (!attachments_.knows(name)) return std::nullopt;
  return attachments_.turn(*physics_, name, is_on);
}

std::uint64_t Simulation::hash() const {
  StateHash hash;
  hash.add(options_.seed);
  hash.add(static_cast<std::uint64_t>(time_.count()));
  physics_->add_to(hash);
  for (const auto& device : devices_) device->add_to(hash);
  attachments_.add_to(hash);
  tags_.add_to(hash);
  for (const auto& wrench : wrenches_) {
    hash.add_all(std::uint64_t{wrench.link.model}, std::uint64_t{wrench.link.link});
    hash.add(wrench.force);
    hash.add(wrench.torque);
    if (wrench.joint) hash.add(std::uint64_t{*wrench.joint});
    if (!wrench.stays) hash.add(static_cast<std::uint64_t>(wrench.until.count()));
  }
  return hash.value();
}

Device* Simulation::device(std::string_view iface_name) {
  for (auto& device : devices_) {
    if (device->iface().name() == iface_name && device->iface().type() != shm::IfaceType::truth) return device.get();
  }
  return nullptr;
}

std::uint32_t Simulation::take_active_sensors() { return std::exchange(active_sensors_, 0); }

}  // namespace sim
