// Rotors of motors, whose inertia joints feel through their gears.
#include <gtest/gtest.h>

#include "support/joint_rig.h"

namespace sim {
namespace {

using namespace test;

// 0.4 kg m^2 at the joint.
constexpr const char* rotor = "<drake:rotor_inertia>0.001</drake:rotor_inertia><drake:gear_ratio>-20</drake:gear_ratio>";

TEST(Rotor, makes_a_pendulum_slower_by_its_inertia_times_the_ratio_squared) {
  PhysicsFixture f = make({.axes = axis("0 1 0") + rotor, .center = "0 0 -0.5 0 0 0", .gravity = "0 0 -9.8"});
  EXPECT_NEAR(f.physics.def(0).joints[1].axes[0].rotor_inertia, 0.4, 1e-12);
  spin(f, {0, 0.3, 0});
  std::vector<double> passages;
  double before = place_of(f);
  for (int i = 1; i < 6000; ++i) {
    f.physics.step();
    const double now = place_of(f);
    if (before * now < 0) passages.push_back(0.001 * (i - now / (now - before)));
    before = now;
  }
  ASSERT_GE(passages.size(), 3U);
  const double period = 2 * std::numbers::pi * std::sqrt((0.03 + 0.25 + 0.4) / (g * 0.5));
  EXPECT_NEAR(passages[2] - passages[0], period, 0.002 * period);
}

TEST(Rotor, makes_a_slide_fall_slower_whichever_end_is_the_world) {
  for (const bool is_base_parent : {true, false}) {
    PhysicsFixture f = make({.kind = "prismatic",
                             .axes = axis("0 0 1") + "<drake:rotor_inertia>3</drake:rotor_inertia>",
                             .gravity = "0 0 -9.8",
                             .is_base_parent = is_base_parent});
    f.run(0.5);
    EXPECT_NEAR(std::abs(rate_of(f)), g / (1 + 3) * 0.5, 1e-4);
  }
}

TEST(Rotor, that_cannot_be_has_a_line_and_is_left_out) {
  for (const char* wrong : {"nan", "-1", "1e9", "heavy"}) {
    // The fixture throws what the loader found.
    try {
      make({.axes = axis("0 1 0") + "<drake:rotor_inertia>" + wrong + "</drake:rotor_inertia>"});
      ADD_FAILURE() << wrong;
    } catch (const std::exception& line) {
      EXPECT_NE(
          std::string(line.what())
              .find("<drake:rotor_inertia> of joint \"j\" must be a number from 0 to 1e6, got \"" + std::string(wrong) + "\"; 0 is taken"),
          std::string::npos)
          << line.what();
    }
  }
}

}  // namespace
}  // namespace sim
