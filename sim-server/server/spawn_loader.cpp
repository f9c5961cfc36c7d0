#include "server/spawn_loader.h"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "base/text.h"
#include "reader/asset_reader.h"
#include "world/joint_gains.h"

namespace sim {
namespace {

constexpr std::chrono::seconds time_to_read{8};  // for all files of a model: clients wait for ten seconds

// A mesh file that has changed is another mesh in pictures, too.
void set_versions(ModelDef& model, const ModelPath& path) {
  for (LinkDef& link : model.links) {
    for (VisualDef& visual : link.visuals) {
      auto* shape = std::get_if<MeshShape>(&visual.geometry);
      if (shape == nullptr || shape->path == missing_file) continue;
      if (const auto file = read_mesh_file(*shape, path)) shape->version = version_of(file.value().files);
    }
  }
}

// What Scene::build() will ask for when the model has come.
std::unique_ptr<Assets> pictures_of(const ModelDef& model, const SpawnLoader::Order& order) {
  if (order.drawn.empty()) return nullptr;
  auto assets = std::make_unique<Assets>(order.world_path);
  const Scene::Parts parts{{}, {}, {&model}, {}};
  for (const auto content : order.drawn) (void)Scene::build(parts, *assets, content);
  return assets;
}

base::Result<void> add_joint_settings(const SpawnLoader::Order& order, LoadedModel& loaded) {
  std::vector<std::string> left_out;
  if (const auto added = add_named_gains(order.gains, loaded.model, left_out); !added) return added;
  for (const std::string& line : left_out) loaded.findings.push_back({Finding::Severity::warning, "", 0, line});
  return set_initial_positions(order.joints, loaded.model);
}

SpawnLoader::Done read(const SpawnLoader::Order& order) {
  const ReadDeadline deadline(std::chrono::steady_clock::now() + time_to_read);
  SpawnLoader::Done done{order.ticket, base::Error{}, order.name.empty(), {}, {}, order.drawn};
  const auto fail = [&](const std::string& why) { done.model = base::Error{"model: " + why}; };
  try {
    done.model = load_model(order.model, order.name, order.pose, order.model_path);
    if (!done.model) return done;
    if (const auto added = add_joint_settings(order, *done.model); !added) {
      done.model = added.error();
      return done;
    }
    done.triangles.prepare(done.model.value().model);
    if (std::ranges::count(order.drawn, Scene::Content::visuals) > 0) set_versions(done.model.value().model, order.world_path);
    done.pictures = pictures_of(done.model.value().model, order);
  } catch (const std::bad_alloc&) {
    fail("is too large for the memory");
  } catch (const std::exception& e) {
    fail(base::in_quotes(e.what()));
  }
  return done;
}

}  // namespace

SpawnLoader::SpawnLoader(std::function<void()> on_done) : on_done_(std::move(on_done)) {}

SpawnLoader::~SpawnLoader() {
  state_.lock()->is_ending = true;
  changed_.notify_all();
}

void SpawnLoader::take(Order order) {
  if (!thread_.joinable()) thread_ = std::jthread([this] { run(); });
  ++under_way_;
  state_.lock()->orders.push_back(std::move(order));
  changed_.notify_all();
}

std::vector<SpawnLoader::Done> SpawnLoader::finished() {
  if (under_way_ == 0) return {};
  auto done = std::exchange(state_.lock()->done, {});
  under_way_ -= done.size();
  return done;
}

void SpawnLoader::run() {
  while (true) {
    std::optional<Order> order;
    {
      auto state = state_.lock();
      state.wait(changed_, [&] { return state->is_ending || !state->orders.empty(); });
      if (state->is_ending) return;
      order = std::move(state->orders.front());
      state->orders.erase(state->orders.begin());
    }
    Done done = read(*order);
    state_.lock()->done.push_back(std::move(done));
    on_done_();
  }
}

}  // namespace sim
