// Tests that every field of every spec is read back as written, to the bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "robocell/spec/env_config.h"
#include "robocell/spec/testing/random_spec.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using testing::RandomSpec;

// A field of T, and how to give it another value than `plain` has. Its checks are compiled once for
// T, not once for each field, which took the longest of all tests.
template <class T>
struct Field {
  std::string name;
  std::string doc;
  std::function<bool(T& spec, const T& plain)> change;  // false: it cannot be changed
};

template <class Member>
bool Change(Member& value, const Member& plain) {
  for (uint64_t seed = 0; seed < 100 && value == plain; ++seed) RandomSpec(seed).Fill(value);
  return !(value == plain);
}

template <class T>
std::vector<Field<T>> FieldsOf() {
  std::vector<Field<T>> fields;
  T::Fields([&](const char* name, auto member, const char* doc, Bound = Bound::kNone) {
    fields.push_back({name, doc, [member](T& spec, const T& plain) {
                        return Change(spec.*member, plain.*member);
                      }});
  });
  return fields;
}

template <class T>
class RoundTrip : public ::testing::Test {};

using SpecTypes = ::testing::Types<
    SceneSpec, RobotSpec, RobotConfig, AttachmentSpec, ForceTorqueSensorSpec, ToolFrameSpec,
    SceneObject, CameraSpec, CameraConfig, CameraSystemConfig, RenderQuality, RendererConfig,
    SimOptions, Edit, BaseConfig, MoveGroupConfig, GripperCtrl, GripperDistance, GripperJointRange,
    TaskSpaceConfig, RunConfig, FilesScenes, ObjectPlace, CameraSight, StartCamera, StartConfig,
    Rates, EnvConfig, EnvObject, CameraAdderConfig, SimSettings, WrapperConfig, ObjectVariation,
    RandomProperty, RandomLights, RandomLook, RandomDynamics, RandomClutter, RandomizeConfig>;
TYPED_TEST_SUITE(RoundTrip, SpecTypes);

TYPED_TEST(RoundTrip, RandomSpecsRoundTrip) {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const auto spec = RandomSpec(seed).Make<TypeParam>();
    const std::string text = ToYaml(spec);
    const auto back = FromYamlUnchecked<TypeParam>(text);
    ASSERT_TRUE(back == spec) << "seed " << seed << ":\n" << text << "\n---\n" << ToYaml(back);
    EXPECT_EQ(ToYaml(back), text);
  }
}

TYPED_TEST(RoundTrip, EveryFieldIsWrittenReadAndCompared) {
  const TypeParam plain{};
  for (const auto& field : FieldsOf<TypeParam>()) {
    TypeParam changed{};
    ASSERT_TRUE(field.change(changed, plain)) << field.name << " cannot be changed";
    EXPECT_FALSE(changed == plain) << field.name << " is not compared";
    const std::string text = ToYaml(changed);
    EXPECT_THAT(text, HasSubstr(field.name));
    EXPECT_TRUE(FromYamlUnchecked<TypeParam>(text) == changed) << field.name << "\n" << text;
  }
}

TYPED_TEST(RoundTrip, DefaultsRoundTrip) {
  EXPECT_TRUE(FromYamlUnchecked<TypeParam>(ToYaml(TypeParam{})) == TypeParam{});
}

TYPED_TEST(RoundTrip, EveryFieldHasAUniqueNameAndADescription) {
  std::set<std::string> names;
  for (const auto& field : FieldsOf<TypeParam>()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_GT(field.doc.size(), 3u) << field.name;
    EXPECT_EQ(field.doc.back(), '.') << field.name;
  }
}

TYPED_TEST(RoundTrip, CopiesShareNothing) {
  auto spec = RandomSpec(1).Make<TypeParam>();
  const TypeParam copy = spec;
  const std::string before = ToYaml(copy);
  RandomSpec(2).Fill(spec);
  EXPECT_EQ(ToYaml(copy), before);
}

TEST(ToYaml, ProducesTextThatParseYamlAccepts) {
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.robots.push_back({.path = "arm.xml", .prefix = "left_", .pos = {0.1, 0, 1.0 / 3}});
  spec.robots[0].attachments.push_back({.mjcf_path = "hand.xml", .attach_to = Site("flange")});
  spec.objects.push_back({.name = "cube",
                          .shape = Shape::kBox,
                          .size = Vec3{.02, .02, .02},
                          .rgba = Vec4{1, .5, 0, 1},
                          .mass = .1,
                          .friction = Vec3{.8, .02, .001}});
  spec.cameras.push_back({.name = "top", .pos = Vec3{0, 0, 2}, .fovy = 45});
  EXPECT_TRUE(ParseYaml<SceneSpec>(ToYaml(spec)) == spec) << ToYaml(spec);
}

TEST(ToYaml, WritesIndexRunsAsRanges) {
  RunConfig run;
  run.scenes.houses.values = {0, 1, 2, 3};
  EXPECT_THAT(ToYaml(run), HasSubstr("houses: 0..3"));
  run.scenes.houses.values = {0, 2, 3};
  EXPECT_THAT(ToYaml(run), HasSubstr("houses: [0, 2, 3]"));
}

TEST(ToYaml, OmitsUnsetFields) {
  const std::string text = ToYaml(RobotConfig{.name = "arm", .model = "arm.xml"});
  EXPECT_THAT(text, ::testing::Not(HasSubstr("reach")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("edits")));
}

}  // namespace
}  // namespace robocell::internal
