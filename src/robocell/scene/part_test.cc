// Tests what becomes of a model file that is made a part of a scene.
#include "robocell/scene/part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <optional>
#include <string>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PartTest : public ::testing::Test {
 protected:
  std::optional<Part> Load(const std::string& inside, const SimOptions& options = {}) {
    return LoadPart(folder.Write("part", inside), "", "object 'mug'", "mjcf_path", options, "",
                    log);
  }
  std::string Thrown() {
    try {
      log.Throw("pick");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  ModelFolder folder;
  CompileLog log;
};

constexpr const char* kMug = "<worldbody><body name='mug'><geom size='.05'/></body></worldbody>";

TEST_F(PartTest, KeyframesAreReadAndDropped) {
  const auto part = Load(
      "<worldbody><body name='mug'><freejoint/><geom size='.05'/></body></worldbody>"
      "<keyframe><key name='home' qpos='0 0 1 1 0 0 0'/><key name='tilted'/></keyframe>");
  ASSERT_TRUE(part.has_value()) << Thrown();
  EXPECT_THAT(SpecElements(part->spec.get(), mjOBJ_KEY), IsEmpty());
  EXPECT_EQ(part->place, "object 'mug'");
}

TEST_F(PartTest, AMissingModelNamesTheFieldAndThrowsNotFound) {
  EXPECT_FALSE(LoadPart("mgu.xml", folder.path().string(), "object 'mug'", "mjcf_path", {}, "", log)
                   .has_value());
  ExpectThrow<NotFoundError>([&] { log.Throw("pick"); }, "scene 'pick' / object 'mug': ");
}

TEST_F(PartTest, AModelThatIsNoXmlIsAProblem) {
  EXPECT_FALSE(Load("<worldbody>").has_value());
  ExpectThrow<SpecError>([&] { log.Throw("pick"); }, "object 'mug'");
}

TEST_F(PartTest, OtherOptionsOfThePartAreWarnedOf) {
  ASSERT_TRUE(Load(std::string("<option timestep='0.004' integrator='implicit'/>") + kMug,
                   {.integrator = Integrator::kEuler})
                  .has_value());
  EXPECT_THAT(log.warnings(), ElementsAre(HasSubstr("integrator")));
}

TEST_F(PartTest, MissingMeshesAreReportedTogether) {
  EXPECT_FALSE(Load("<asset><mesh name='a' file='a.stl'/><mesh name='b' file='b.stl'/></asset>"
                    "<worldbody><body name='mug'><geom type='mesh' mesh='a'/></body></worldbody>")
                   .has_value());
  EXPECT_EQ(log.problem_count(), 1);
  EXPECT_THAT(Thrown(), HasSubstr("refers to the file 'a.stl'"));
  EXPECT_THAT(Thrown(), HasSubstr("Also missing: b.stl"));
}

TEST_F(PartTest, TheOnlyBodyIsTheRoot) {
  const auto part = Load(kMug);
  mjsBody* root = ChooseRoot(*part, std::nullopt, log);
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(SpecName(root->element), "mug");
  EXPECT_THAT(log.warnings(), IsEmpty());
}

TEST_F(PartTest, TheRootContainsTheNamedBody) {
  const auto part = Load(
      "<worldbody><body name='cup'><geom size='.1'/><body name='handle'><geom size='.01'/></body>"
      "</body><body name='saucer'><geom size='.1'/></body></worldbody>");
  mjsBody* root = ChooseRoot(*part, "handle", log);
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(SpecName(root->element), "cup");
  EXPECT_THAT(log.warnings(), ElementsAre(HasSubstr("left out: body 'saucer'")));
  EXPECT_EQ(ChooseRoot(*part, "handel", log), nullptr);
  EXPECT_THAT(Thrown(), HasSubstr("Did you mean 'handle'?"));
}

TEST_F(PartTest, SeveralBodiesNeedAName) {
  const auto part = Load(
      "<worldbody><body name='a'><geom size='.1'/></body><body name='b'><geom size='.1'/></body>"
      "</worldbody>");
  EXPECT_EQ(ChooseRoot(*part, std::nullopt, log), nullptr);
  EXPECT_THAT(Thrown(), HasSubstr("has 2 root bodies: a, b; only one can be placed"));
  CompileLog other;
  EXPECT_EQ(ChooseRoot(*part, "", other), nullptr);
  EXPECT_EQ(other.problem_count(), 1);
}

TEST_F(PartTest, AModelWithoutABodyCannotBeAttached) {
  const auto part = Load("<worldbody><geom size='.1'/></worldbody>");
  EXPECT_EQ(ChooseRoot(*part, std::nullopt, log), nullptr);
  EXPECT_THAT(Thrown(), HasSubstr("has no body to attach"));
}

TEST_F(PartTest, FloorsAndLightsStayBehindWithANote) {
  const auto part = Load(
      "<worldbody><light/><geom name='floor' type='plane' size='1 1 1'/><body name='mug'>"
      "<geom size='.1'/></body></worldbody>");
  ASSERT_NE(ChooseRoot(*part, std::nullopt, log), nullptr);
  EXPECT_THAT(log.warnings(), IsEmpty());
  EXPECT_THAT(log.notes(), ElementsAre(HasSubstr("the scene has its own"),
                                       HasSubstr("floors are the scene's (add_floor)")));
}

}  // namespace
}  // namespace robocell::internal
