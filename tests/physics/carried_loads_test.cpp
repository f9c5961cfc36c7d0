// Light bodies that carry heavy ones: they keep their place, and the ground carries both.
#include <gtest/gtest.h>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

struct Load {
  explicit Load(double mass, double gap = 0)
      : f(world_of({ground(), body("plate", BoxShape{{1, 1, 0.1}}, at(0, 0, 0.05), 1),
                    body("load", BoxShape{{0.8, 0.8, 0.8}}, at(0, 0, 0.5 + gap), mass)})) {
    f.physics.record_forces(f.id("plate"));
    f.run(5);
  }
  // [N], upwards, of the ground on the plate
  double carried() const {
    double sum = 0;
    for (const Contact& contact : f.physics.contacts(f.id("plate"))) {
      if (contact.other.model == f.id("ground")) sum += contact.force.z();
    }
    return sum;
  }
  PhysicsFixture f;
};

// The contact of the plate with the floor gave way as if the plate alone were on it: 100 t sank by a metre.
TEST(CarriedLoads, a_plate_of_a_kilogram_carries_up_to_a_hundred_tons) {
  for (const double mass : {1.0, 10.0, 1e3, 1e4, 1e5}) {
    const Load load(mass);
    EXPECT_NEAR(load.f.position("plate").z(), 0.05, 0.0015) << mass;
    EXPECT_NEAR(load.f.position("load").z(), 0.5, 0.003) << mass;
    EXPECT_NEAR(load.f.position("load").head<2>().norm(), 0, 0.001) << mass;
    EXPECT_NEAR(load.carried(), (1 + mass) * 9.8, 0.01 * (1 + mass) * 9.8) << mass;
  }
}

TEST(CarriedLoads, a_plate_carries_as_many_of_them_as_lie_on_it) {
  std::vector<ModelDef> models{ground(), body("plate", BoxShape{{2, 2, 0.1}}, at(0, 0, 0.05), 1)};
  for (int i = 0; i < 9; ++i)
    models.push_back(body("load" + std::to_string(i), BoxShape{{0.4, 0.4, 0.4}}, at(0.6 * (i % 3 - 1), 0.6 * (i / 3 - 1), 0.3), 90));
  PhysicsFixture f(world_of(models));
  f.run(3);
  EXPECT_NEAR(f.position("plate").z(), 0.05, 0.0015);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(f.position("load" + std::to_string(i)).z(), 0.3, 0.003) << i;
}

TEST(CarriedLoads, a_load_that_falls_on_a_plate_does_not_go_through_it) {
  const Load load(1e5, 0.1);
  EXPECT_NEAR(load.f.position("plate").z(), 0.05, 0.0015);
  EXPECT_NEAR(load.f.position("load").z(), 0.5, 0.003);
}

}  // namespace
}  // namespace sim
