// What is written comes back: every field of every spec, to the bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/random_spec.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::RandomSpec;

template <class T>
std::string Write(const T& spec) {
  yaml::Writer writer;
  writer.Write(spec);
  return writer.text();
}

// Without validation: random values obey no rules.
template <class T>
T Read(const std::string& text) {
  yaml::Reader reader("text", "");
  T spec{};
  reader.Read(yaml::ParseText(text, "text"), spec);
  EXPECT_EQ(reader.problems().Text(""), Problems().Text("")) << text;
  return spec;
}

template <class T>
class RoundTrip : public ::testing::Test {};

using SpecTypes =
    ::testing::Types<SceneSpec, RobotSpec, RobotConfig, AttachmentSpec, ForceTorqueSensorSpec,
                     ToolFrameSpec, SceneObject, CameraSpec, CameraConfig, CameraSystemConfig,
                     RenderQuality, SimOptions, Edit, BaseConfig, MoveGroupConfig, GripperCtrl,
                     GripperDistance, RunConfig, TaskConfig, SceneSource, Rates>;
TYPED_TEST_SUITE(RoundTrip, SpecTypes);

TYPED_TEST(RoundTrip, RandomSpecsComeBackEqual) {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const auto spec = RandomSpec(seed).Make<TypeParam>();
    const std::string text = Write(spec);
    const auto back = Read<TypeParam>(text);
    ASSERT_TRUE(back == spec) << "seed " << seed << ":\n" << text << "\n---\n" << Write(back);
    EXPECT_EQ(Write(back), text);
  }
}

TYPED_TEST(RoundTrip, EveryFieldIsWrittenReadAndCompared) {
  const TypeParam plain{};
  TypeParam::Fields([&](const char* name, auto member, const char*, Check = Check::kNone) {
    if (std::string(name) == "kind" && std::is_same_v<TypeParam, TaskConfig>) return;  // one value
    TypeParam changed{};
    for (uint64_t seed = 0; changed.*member == plain.*member; ++seed) {
      ASSERT_LT(seed, 100u) << name << " cannot be changed";
      RandomSpec(seed).Fill(changed.*member);
    }
    EXPECT_FALSE(changed == plain) << name << " is not compared";
    EXPECT_THAT(Write(changed), HasSubstr(name));
    EXPECT_TRUE(Read<TypeParam>(Write(changed)) == changed) << name << "\n" << Write(changed);
  });
}

TYPED_TEST(RoundTrip, DefaultsComeBackEqual) {
  EXPECT_TRUE(Read<TypeParam>(Write(TypeParam{})) == TypeParam{});
}

TYPED_TEST(RoundTrip, EveryFieldHasANameOfItsOwnAndASentence) {
  std::set<std::string> names;
  TypeParam::Fields([&](const char* name, auto, const char* doc, Check = Check::kNone) {
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_GT(std::string(doc).size(), 3u) << name;
    EXPECT_EQ(std::string(doc).back(), '.') << name;
  });
}

TYPED_TEST(RoundTrip, CopiesShareNothing) {
  auto spec = RandomSpec(1).Make<TypeParam>();
  const TypeParam copy = spec;
  const std::string before = Write(copy);
  RandomSpec(2).Fill(spec);
  EXPECT_EQ(Write(copy), before);
}

TEST(ToYaml, GivesTextThatParseYamlAccepts) {
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
  EXPECT_THAT(ToYaml(RunConfig{.scenes = {.houses = {{0, 1, 2, 3}}}}), HasSubstr("houses: 0..3"));
  EXPECT_THAT(ToYaml(RunConfig{.scenes = {.houses = {{0, 2, 3}}}}), HasSubstr("houses: [0, 2, 3]"));
}

TEST(ToYaml, LeavesOutWhatIsUnset) {
  const std::string text = ToYaml(RobotConfig{.name = "arm", .model = "arm.xml"});
  EXPECT_THAT(text, ::testing::Not(HasSubstr("reach")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("edits")));
}

}  // namespace
}  // namespace robocell
