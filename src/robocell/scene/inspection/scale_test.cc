// Tests models in other units than metres.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/scene/testing/changed_arm.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class Scales : public ChangedArm {};

TEST_F(Scales, WarnsAboutARobotInMillimetres) {
  EXPECT_THAT(Compiled(kTwoJointArm)->warnings(), IsEmpty());
  EXPECT_THAT(
      Compiled(With(R"(<geom name="link" type="box" size="15 15 130" mass="1"/>)", "<site"))
          ->warnings(),
      ElementsAre(StartsWith("robot 'a': geom 'link' is 263 m large, and models are in metres. Is "
                             "it in millimetres? Then write sizes and positions of the model a "
                             "thousandth as large (in millimetres it would be 0.263 m)")));
  const std::string mesh = R"(<asset><mesh name="link" vertex="0 0 0  9 0 0  0 9 0  0 0 200"/>
                              </asset>)";
  std::string model = With(R"(<geom name="link" type="mesh" mesh="link" mass="1"/>)", "<site");
  model.insert(model.find("<worldbody>"), mesh);
  EXPECT_THAT(
      Compiled(model)->warnings(),
      ElementsAre(::testing::HasSubstr("Then give its <mesh> scale=\"0.001 0.001 0.001\"")));
  EXPECT_THAT(
      Compiled(With(R"(<geom type="box" size="20 20 1"/>)", "<body name=\"upper\""))->warnings(),
      IsEmpty())
      << "what it stands on";
}

// Other findings in such a robot follow from its scale.
TEST_F(Scales, ReportsTheScaleFirst) {
  std::string model = With(R"(<geom name="link" type="box" size="15 15 130" mass="1"/>)", "<site");
  const std::string range = "range=\"";
  ASSERT_NE(model.find(range), std::string::npos);
  model.replace(model.find(range),
                model.find('"', model.find(range) + range.size()) - model.find(range),
                "range=\"2 -2");
  const std::vector<std::string> warnings = Compiled(model)->warnings();
  ASSERT_GT(warnings.size(), 1u);
  EXPECT_THAT(warnings.front(), ::testing::HasSubstr("Is it in millimetres?"));
}

}  // namespace
}  // namespace robocell
