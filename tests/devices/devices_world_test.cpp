// worlds/devices.sdf has a device of each kind that the simulator knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "server/describe.h"
#include "support/devices_world.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;

TEST(DevicesWorld, has_an_iface_of_each_type) {
  SimulationFixture f(devices_world());
  EXPECT_EQ(f.dropped, std::vector<std::string>());
  std::set<std::string> found, known;
  // The text that simctl list --json prints.
  const auto list = nlohmann::json::parse(list_text(*f.simulation));
  for (const auto& iface : list["ifaces"]) found.insert(iface["type"].get<std::string>());
  for (const shm::IfaceRow& row : shm::iface_types) known.insert(std::string(row.name));
  known.erase("simulation");  // the world itself, which is in no list
  EXPECT_EQ(found, known);
}

TEST(DevicesWorld, has_a_scale_that_weighs_what_lies_on_it) {
  SimulationFixture f(devices_world());
  auto cell = f.open(shm::IfaceType::force_torque, "scale::force");
  auto plate = f.open(shm::IfaceType::bumper, "scale::touch");
  f.run(1);
  ASSERT_TRUE(cell.read() && plate.read());
  EXPECT_NEAR(cell.sample<shm::ForceTorqueSample>().force[2], -3 * 9.8, 0.2);
  EXPECT_GT(plate.bumper().contacts.size(), 0U);
}

// Of an iface: its samples by simulated time. Wall-clock time is left out.
using Samples = std::map<std::int64_t, std::vector<std::byte>>;

struct Heard {
  std::int64_t since = -1;            // simulated time of the subscriptions [ns]; -1: before the first samples
  std::vector<std::uint64_t> hashes;  // every 0.1 s
  std::map<std::string, Samples> ifaces;
};

void hear(shm::Iface& iface, std::uint64_t& sequence, Samples& samples) {
  if (iface.sequence() == sequence) return;
  sequence = iface.sequence();
  if (shm::has_frames(iface.type())) {
    const auto frame = iface.hold();
    ASSERT_TRUE(frame);
    samples[frame->head().stamp.sim_time_ns].assign(frame->data().begin(), frame->data().end());
    return;
  }
  ASSERT_TRUE(iface.read());
  const auto bytes = iface.sample_data().subspan(sizeof(shm::Stamp));
  samples[iface.sample<shm::Stamp>().sim_time_ns].assign(bytes.begin(), bytes.end());
}

// A second of the world with faults, heard by subscribers to the ifaces that `is_heard` is true of, by number, from `from` on.
Heard listen(const std::function<bool(std::size_t)>& is_heard, double from = 0) {
  SimulationFixture f(devices_world(), 7);
  f.simulation->pictures().set_synchronous(true);
  using shm::FaultKind;
  constexpr auto for_ever = std::chrono::nanoseconds::max();
  for (const auto& [iface, kind, amount] : {std::tuple("mast::lidar", FaultKind::noise, 0.1),
                                            {"rover::ins", FaultKind::dropout, 0.4},
                                            {"rover::localization", FaultKind::latency, 2.0},
                                            {"station::imu", FaultKind::stuck, 0.0}}) {
    const auto added = f.simulation->add_fault({iface, kind, amount, std::chrono::milliseconds(100), for_ever});
    EXPECT_TRUE(added) << added.error().message;
  }
  struct Ear {
    std::string name;
    shm::Iface iface;
    std::uint64_t sequence;  // heard, or older than the subscription
  };
  std::vector<Ear> ears;
  Heard heard;
  const auto subscribe = [&] {
    std::size_t number = 0;
    for (const auto& device : f.simulation->devices()) {
      const shm::IfaceWriter& writer = device->iface();
      if (!is_heard(number++)) continue;
      if (from > 0 && shm::has_frames(writer.type())) continue;  // a part of a picture depends on when the first is drawn
      ears.push_back({std::string(to_text(writer.type())) + " " + writer.name(), f.open(writer.type(), writer.name()), 0});
      ears.back().sequence = ears.back().iface.sequence();
    }
  };
  const auto sense = [&] {
    f.simulation->sense(f.times);
    for (Ear& ear : ears) hear(ear.iface, ear.sequence, heard.ifaces[ear.name]);
  };
  if (from == 0) subscribe();
  sense();
  while (f.simulation->steps() < 500) {
    f.simulation->step(f.times);
    sense();
    if (f.simulation->steps() % 50 == 0) heard.hashes.push_back(f.simulation->hash());
    if (from > 0 && ears.empty() && std::chrono::duration<double>(f.simulation->time()).count() > from) {
      subscribe();
      heard.since = f.simulation->time().count();
    }
  }
  return heard;
}

std::size_t different_octets(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
  std::size_t count = std::max(a.size(), b.size()) - std::min(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) count += a[i] != b[i] ? 1U : 0U;
  return count;
}

TEST(DevicesWorld, what_a_subscriber_hears_and_the_state_do_not_depend_on_other_subscribers) {
  const Heard all = listen([](std::size_t) { return true; });
  EXPECT_EQ(listen([](std::size_t) { return false; }).hashes, all.hashes);
  for (const std::size_t rest : {0U, 1U}) {
    for (const double from : {0.0, 0.33}) {
      const Heard some = listen([&](std::size_t number) { return number % 2 == rest; }, from);
      EXPECT_EQ(some.hashes, all.hashes);
      EXPECT_GT(some.ifaces.size(), 15U);
      for (const auto& [name, samples] : some.ifaces) {
        SCOPED_TRACE(name + " from " + std::to_string(from));
        Samples expected = all.ifaces.at(name);
        std::erase_if(expected, [&](const auto& sample) { return sample.first <= some.since; });
        EXPECT_FALSE(expected.empty());
        ASSERT_EQ(samples.size(), expected.size());
        for (const auto& [time, octets] : samples) EXPECT_EQ(different_octets(octets, expected[time]), 0U) << "at " << time << " ns";
      }
    }
  }
}

}  // namespace
}  // namespace sim
