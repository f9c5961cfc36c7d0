// Feeds the world loader with files of the corpus and with mutations of them: none may crash it, hang it or make a definition that breaks
// its promises or that the physics cannot step (ODE ends the process when a value is against its rules).
//   world_fuzz [--seed N] [--runs N] CORPUS...      (files and folders; a crash leaves the text in world_fuzz_last.sdf)
// Built with -DRTMSIM_LIBFUZZER (clang) it is a libFuzzer target over the same check.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "base/text.h"
#include "physics/physics.h"
#include "support/usage.h"
#include "world/world_loader.h"

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "world_fuzz: %s\n", why.c_str());
  std::abort();
}

void require(bool holds, const char* what) {
  if (!holds) fail(what);
}

// What world_def.h promises of numbers.
void check(const sim::ModelDef& model) {
  require(model.pose.matrix().allFinite(), "pose of a model is not finite");
  for (const sim::LinkDef& link : model.links) {
    require(link.pose.matrix().allFinite() && link.mass > 0 && std::isfinite(link.mass), "link is not finite");
    require(link.inertia.allFinite() && link.inertia.determinant() > 0, "inertia is not positive");
    for (const sim::CollisionDef& collision : link.collisions) {
      require(collision.pose.matrix().allFinite(), "pose of a collision is not finite");
      if (const auto* box = std::get_if<sim::BoxShape>(&collision.geometry))
        require(box->size.minCoeff() > 0 && box->size.allFinite(), "box is not positive");
      if (const auto* ball = std::get_if<sim::SphereShape>(&collision.geometry))
        require(ball->radius > 0 && std::isfinite(ball->radius), "sphere is not positive");
    }
    for (const sim::SensorDef& sensor : link.sensors) {
      if (const auto* ray = std::get_if<sim::RayDef>(&sensor.data)) {
        require(
            ray->horizontal.samples > 0 && ray->vertical.samples > 0 && ray->range_max > ray->range_min && std::isfinite(ray->range_max),
            "scan makes no sense");
      }
    }
  }
  for (const sim::JointDef& joint : model.joints) {
    require(joint.parent.empty() || model.link(joint.parent), "joint without parent");
    require(joint.child.empty() || model.link(joint.child), "joint without child");
    require(joint.pose_in_child.matrix().allFinite(), "pose of a joint is not finite");
    for (const sim::AxisDef& axis : joint.axes)
      require(std::abs(axis.xyz.norm() - 1) < 1e-6 && axis.lower <= axis.upper, "axis makes no sense");
  }
}

void step(sim::WorldDef world) {
  std::size_t parts = 0;
  for (const sim::ModelDef& model : world.models) parts += model.links.size() + model.joints.size();
  if (parts > 100) return;
  sim::WorkerPool pool(1);
  sim::TriangleCache triangles;
  std::vector<std::string> notes, dropped;
  sim::Physics physics(std::make_shared<const sim::WorldDef>(std::move(world)), pool, triangles, notes, dropped);
  for (int i = 0; i < 5; ++i) physics.step();
  for (sim::ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    require(physics.model_pose(id).matrix().allFinite(), "pose of a moving model is not finite");
    for (std::uint32_t j = 0; j < physics.def(id).joints.size(); ++j) {
      require(!std::isnan(physics.joint_state({id, j}).position), "position of a joint is no number");
      physics.set_motor({id, j}, 0, 1, 1);
    }
  }
  physics.step();
}

// The first model of the text, as `simctl spawn` would bring it into a running world.
void spawn(const std::string& text, const sim::ModelPath& path) {
  const std::size_t begin = text.find("<model"), end = text.rfind("</model>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return;
  const std::size_t at = text.find("version");
  const std::string version = at == std::string::npos || at > begin ? "1.6" : text.substr(std::min(at + 9, text.size()), 3);
  const std::string wrapped = "<sdf version=\"" + version + "\">" + text.substr(begin, end + 8 - begin) + "</sdf>";
  const base::Result<sim::LoadedModel> model = sim::load_model(wrapped, "spawned", std::nullopt, path);
  if (!model) return require(model.error().message.find('\n') == std::string::npos, "error is not one line");
  check(model->model);
  if (model->model.links.size() + model->model.joints.size() > 100) return;
  sim::WorkerPool pool(1);
  sim::TriangleCache triangles;
  std::vector<std::string> notes, dropped;
  sim::Physics physics(std::make_shared<const sim::WorldDef>(), pool, triangles, notes, dropped);
  physics.step();
  if (!physics.spawn(std::make_shared<const sim::ModelDef>(model->model), notes)) return;
  for (int i = 0; i < 3; ++i) physics.step();
}

void run(const std::string& text, const fs::path& folder, const sim::ModelPath& path) {
  const base::Result<sim::LoadResult> world = sim::load_world_text(text, folder, "fuzz", path);
  if (world) {
    for (const sim::ModelDef& model : world->world.models) check(model);
    require(world->world.physics.step > 0 && std::isfinite(world->world.physics.step), "step is not positive");
    for (const sim::Finding& finding : world->findings)
      require(finding.text().find('\n') == std::string::npos, "finding has several lines");
    step(world->world);
  } else {
    require(!world.error().message.empty() && world.error().message.find('\n') == std::string::npos, "error is not one line");
  }
  spawn(text, path);
}

}  // namespace

#ifdef RTMSIM_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  run(std::string(reinterpret_cast<const char*>(data), size), fs::current_path(), sim::ModelPath{});
  return 0;
}
#else

namespace {

const std::vector<std::string> words{"nan",
                                     "inf",
                                     "-1",
                                     "0",
                                     "1e308",
                                     "-1e308",
                                     "1e-320",
                                     "<",
                                     ">",
                                     "/>",
                                     "</model>",
                                     "</link>",
                                     "<model",
                                     "<link",
                                     "&a;",
                                     "\"",
                                     "'",
                                     "::",
                                     "world",
                                     "__model__",
                                     "<!--",
                                     "-->",
                                     "]]>",
                                     "<![CDATA[",
                                     "<pose>",
                                     "</pose>",
                                     "1.4",
                                     "1.9",
                                     "99999999999",
                                     "relative_to='x'",
                                     "<include><uri>model://pioneer2dx</uri></include>",
                                     "<joint name='x' type='ball'/>",
                                     "<frame name='f' attached_to='f'/>",
                                     "\xff\xfe",
                                     "\n\n",
                                     "placement_frame='l'",
                                     "<static>maybe</static>",
                                     "<model name='m'><model name='m'/></model>"};

using Below = std::function<std::size_t(std::size_t)>;

// Changes that leave the text XML: another value, an element doubled, taken out, or put somewhere else.
void mutate_element(std::string& text, const Below& below) {
  const std::size_t begin = text.find('<', below(text.size()));
  if (begin == std::string::npos || begin + 1 >= text.size() || std::isalpha(static_cast<unsigned char>(text[begin + 1])) == 0) return;
  const std::size_t name_end = text.find_first_of(" >/\n", begin);
  if (name_end == std::string::npos) return;
  const std::string name = text.substr(begin + 1, name_end - begin - 1);
  const std::size_t tag_end = text.find('>', begin);
  const std::size_t close = text.find("</" + name + ">", begin);
  if (tag_end == std::string::npos || close == std::string::npos) return;
  const std::size_t end = close + name.size() + 3;
  const std::string element = text.substr(begin, end - begin);
  switch (below(5)) {
    case 0:
      text.erase(begin, end - begin);
      break;
    case 1:
      text.insert(end, element);
      break;
    case 2:
      text.erase(begin, end - begin);
      text.insert(std::min(text.find('<', below(text.size())), text.size()), element);
      break;
    default:
      if (text.find('<', tag_end) == close) {
        static const std::vector<std::string> values{"nan", "inf",   "-inf", "-1",   "0",         "1e308", "-1e9",        "1 2 3", "0 0 0",
                                                     "",    "world", "l",    "link", "__model__", "::",    "1 2 3 4 5 6", "true",  "x"};
        text.replace(tag_end + 1, close - tag_end - 1, values[below(values.size())]);
      }
  }
}

std::string mutate(std::string text, const std::vector<std::string>& corpus, std::mt19937& random) {
  const Below below = [&](std::size_t n) { return n == 0 ? std::size_t{0} : std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  if (below(3) != 0) {
    for (std::size_t changes = 1 + below(8); changes > 0; --changes) mutate_element(text, below);
    return text;
  }
  for (std::size_t changes = 1 + below(6); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, below(below(4) == 0 ? 400 : 12) + 1);
    switch (below(8)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, words[below(words.size())]);
        break;
      case 3:
        text.replace(at, length, words[below(words.size())]);
        break;
      case 4:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 5:
        text.resize(at);
        break;
      case 6: {  // another number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit != std::string::npos) text.replace(digit, text.find_first_not_of("0123456789.e-", digit) - digit, words[below(7)]);
        break;
      }
      default: {  // an element of another file
        const std::string& other = corpus[below(corpus.size())];
        const std::size_t from = other.find('<', below(other.size()));
        const std::size_t to = text.find('<', at);
        if (from != std::string::npos && to != std::string::npos) text.insert(to, other.substr(from, below(1500)));
      }
    }
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "world_fuzz [--runs N] [--seed N] [FILE]...\nReads damaged worlds; it must not crash or hang.");
  unsigned seed = 1;
  long runs = 300;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seed" && i + 1 < argc) {
      seed = static_cast<unsigned>(base::parse_integer(argv[++i]).value_or(1));
    } else if (word == "--runs" && i + 1 < argc) {
      runs = static_cast<long>(base::parse_integer(argv[++i]).value_or(300));
    } else if (fs::is_directory(word)) {
      for (const auto& entry : fs::recursive_directory_iterator(word)) {
        const std::string extension = entry.path().extension();
        if (extension == ".sdf" || extension == ".world") files.push_back(entry.path());
      }
    } else {
      files.emplace_back(word);
    }
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) return std::fprintf(stderr, "usage: world_fuzz [--seed N] [--runs N] CORPUS...\n"), 2;
  const sim::ModelPath path({files.front().parent_path()});
  std::vector<std::string> corpus;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    if (corpus.back().size() > 100000) corpus.back().resize(100000);
    run(corpus.back(), file.parent_path(), path);
  }
  std::printf("seed %u, %zu files, %ld mutations\n", seed, files.size(), runs);
  std::mt19937 random(seed);
  for (long i = 0; i < runs; ++i) {
    const std::size_t which = std::uniform_int_distribution<std::size_t>(0, corpus.size() - 1)(random);
    const std::string text = mutate(corpus[which], corpus, random);
    std::ofstream("world_fuzz_last.sdf", std::ios::binary) << text;
    run(text, files[which].parent_path(), path);
  }
  fs::remove("world_fuzz_last.sdf");
  return 0;
}
#endif
