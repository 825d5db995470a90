#include "robocell/spec/spec_bytes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/spec/scene_spec.h"
#include "robocell/spec/testing/random_spec.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using testing::RandomSpec;

SceneSpec RandomScene(uint64_t seed) { return RandomSpec(seed).Make<SceneSpec>(); }

// The oracle is the equality of specs, field by field.
TEST(SpecBytes, AreEqualExactlyForEqualSpecs) {
  std::vector<SceneSpec> specs;
  std::vector<std::string> bytes;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    specs.push_back(RandomScene(seed));
    bytes.push_back(SpecBytes(specs.back()));
    const SceneSpec back = FromYamlUnchecked<SceneSpec>(ToYaml(specs.back()));
    EXPECT_EQ(SpecBytes(back), bytes.back()) << seed;
  }
  for (size_t i = 0; i < specs.size(); ++i) {
    for (size_t k = 0; k < i; ++k) EXPECT_EQ(bytes[i] == bytes[k], specs[i] == specs[k]) << i << k;
  }
}

// Every differing field changes the bytes; all others are random.
TEST(SpecBytes, CoverEveryField) {
  SceneSpec scene = RandomScene(3);
  scene.robots.push_back({.prefix = "left_"});
  scene.robots.back().config.emplace().move_groups["arm"];
  scene.objects.push_back({.name = "cube"});
  scene.cameras.push_back({.name = "top"});
  const auto changes = [&](auto& part) {
    ForEachField(part, [&](const char* name, auto& field, const char*, Bound) {
      const std::string before = SpecBytes(scene);
      const auto kept = field;
      for (uint64_t seed = 0; field == kept; ++seed) {
        ASSERT_LT(seed, 100u) << name << " cannot be changed";
        RandomSpec(seed).Fill(field);
      }
      EXPECT_NE(SpecBytes(scene), before) << name;
      field = kept;
    });
  };
  changes(scene);
  changes(scene.robots.back());
  changes(*scene.robots.back().config);
  changes(scene.robots.back().config->move_groups.at("arm"));
  changes(scene.objects.back());
  changes(scene.cameras.back());
}

TEST(SpecBytes, SeparateAdjacentStrings) {
  SceneSpec one, other;
  one.objects.push_back({.name = "ab", .mjcf_path = "c"});
  other.objects.push_back({.name = "a", .mjcf_path = "bc"});
  EXPECT_NE(SpecBytes(one), SpecBytes(other));
}

TEST(SpecBytes, ZeroIsZero) {
  EXPECT_EQ(SpecBytes(SceneSpec{.gravity = {0.0, 0, -9.81}}),
            SpecBytes(SceneSpec{.gravity = {-0.0, 0, -9.81}}));
}

}  // namespace
}  // namespace robocell::internal
