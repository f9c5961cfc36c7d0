#include "rtse/recorder/attachments.h"

#include <cstring>
#include <fstream>
#include <iterator>

#include "base/plain_file.h"
#include "base/text.h"
#include "shm/client.h"

namespace recorder {
namespace {

constexpr std::size_t largest_world = 64 << 20;  // [bytes] that are attached

std::string file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  return text.size() > largest_world ? std::string() : text;
}

}  // namespace

std::string attachment_problem(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos) return "expected NAME=FILE";
  const auto problem = base::file_problem(text.substr(equals + 1));
  return problem.empty() ? "" : base::in_quotes(text) + ": " + problem;
}

base::Result<void> attach_files(mcap::Writer& writer, const std::vector<std::string>& files) {
  for (const std::string& one : files) {
    const auto equals = one.find('=');
    std::ifstream in(one.substr(equals + 1), std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    if (const auto done = writer.attach({mcap::Time(0), mcap::Time(0), one.substr(0, equals), "application/octet-stream", text}); !done)
      return done;
  }
  return {};
}

void attach_run(mcap::Writer& writer, const RunFacts& facts) {
  mcap::Texts run = {{"clock", facts.is_simulated ? "simulated" : "wall"}, {"version", RTMSIM_VERSION}};
  auto simulation = shm::Iface::open(facts.server_id, shm::IfaceType::simulation, "world");
  if (simulation) {
    const auto& info = simulation->info<shm::SimulationInfo>();
    const auto text = [](const auto& field) { return std::string(field, ::strnlen(field, sizeof field)); };
    run["world"] = text(info.world);
    run["world_file"] = text(info.file);
    run["seed"] = std::to_string(info.seed);
    run["step_ns"] = std::to_string(info.step_ns);
    run["lockstep"] = info.lockstep != 0 ? "yes" : "no";
    run["simulator"] = text(info.version);
    const std::string world = file_text(text(info.file));
    if (!world.empty()) (void)writer.attach({mcap::Time(0), mcap::Time(0), "world.sdf", "application/xml", world});
  }
  for (const auto& note : facts.notes) {
    const auto equals = note.find('=');
    run[note.substr(0, equals)] = note.substr(equals + 1);
  }
  (void)writer.add_metadata({"run", run});
}

}  // namespace recorder
