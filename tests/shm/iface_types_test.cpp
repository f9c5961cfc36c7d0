// The table of iface types holds together.
#include "shm/iface_types.h"

#include <gtest/gtest.h>

#include <set>

#include "shm/specs.h"

namespace shm {
namespace {

void expect_inside(std::span<const Field> fields, std::size_t size, std::size_t arrays, const std::string& what) {
  const std::vector<std::byte> whole(size);
  std::set<std::string_view> names;
  for (const Field& field : fields) {
    SCOPED_TRACE(what + " " + std::string(field.name));
    EXPECT_TRUE(names.insert(field.name).second) << "twice";
    if (field.kind == Field::Kind::followers) {
      EXPECT_LT(field.count, arrays);
      continue;
    }
    const auto* at = static_cast<const std::byte*>(field.in(whole.data()));
    EXPECT_GE(at, whole.data());
    EXPECT_LT(at, whole.data() + whole.size());
  }
}

TEST(IfaceTypes, every_field_lies_in_its_structure_under_a_name_of_its_own) {
  std::set<std::string_view> names;
  for (const IfaceRow& row : iface_types) {
    const std::string name(row.name);
    EXPECT_TRUE(names.insert(row.name).second) << name;
    EXPECT_EQ(parse_type(row.name), row.type);
    EXPECT_FALSE(row.meaning.empty()) << name;
    ASSERT_FALSE(row.sample.empty()) << name;
    EXPECT_EQ(row.sample.front().kind, Field::Kind::stamp) << name;
    expect_inside(row.info, row.info_size, row.info_tail.arrays, name + " info");
    expect_inside(row.sample, row.sample_size > 0 ? row.sample_size : sizeof(FrameHead), row.sample_tail.arrays, name + " sample");
    expect_inside(row.sample_tail.fields, row.sample_tail.size, 0, name + " element");
  }
}

TEST(IfaceTypes, a_count_has_one_limit_for_those_who_make_an_iface_and_those_who_open_it) {
  LaserInfo laser{};
  laser.beams = 1 << 12, laser.layers = 1 << 12;
  EXPECT_EQ(plausible_count(row_of(IfaceType::laser), &laser), std::uint64_t{1} << 24);
  EXPECT_EQ(iface_spec(IfaceType::laser, "l", laser).geometry.sample_size, sizeof(LaserSample) + (std::size_t{8} << 24));
  for (const std::uint32_t layers : {0U, (1U << 12) + 1, ~0U}) {
    laser.layers = layers;
    EXPECT_FALSE(plausible_count(row_of(IfaceType::laser), &laser)) << layers;
    EXPECT_EQ(iface_spec(IfaceType::laser, "l", laser).geometry.sample_size, 0U) << layers;
  }
}

TEST(IfaceTypes, an_info_that_is_too_short_makes_no_iface) {
  EXPECT_EQ(iface_spec(IfaceType::imu, "i", std::span<const std::byte>()).geometry.sample_size, 0U);
  SonarInfo sonar{};
  sonar.count = 2;  // without its poses
  EXPECT_EQ(iface_spec(IfaceType::sonar, "s", sonar).geometry.sample_size, 0U);
}

}  // namespace
}  // namespace shm
