#include "robocell/diagnose/check_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<std::string> Lines(const std::vector<Finding>& findings) {
  std::vector<std::string> lines;
  for (const Finding& finding : findings) lines.push_back(Line(finding));
  return lines;
}

TEST(CheckRun, ReturnsWarningsAboutSuspiciousValues) {
  RunConfig run = Demo();
  EXPECT_THAT(CheckRun(run), IsEmpty());
  TempDir folder;
  AtomicWrite(folder / "table.xml",
              "<mujoco><option cone='elliptic'/><worldbody><body><geom type='box' size='.4 .4 .01' "
              "pos='0 0 -.01'/></body></worldbody></mujoco>");
  run.scenes = FilesScenes{.files = {(folder / "table.xml").string()}};
  run.cameras.resolution = {4, 4};
  run.options.cone = FrictionCone::kPyramidal;  // the table and the robot specify another one
  const std::vector<Finding> findings = CheckRun(run);
  EXPECT_THAT(Lines(findings),
              ElementsAre(HasSubstr("base: sets cone elliptic, but the scene uses pyramidal"),
                          HasSubstr("robot 'rc7': sets cone elliptic"),
                          HasSubstr("cameras.streams[0]: images of 'wrist' have 4 x 4 pixels"),
                          HasSubstr("cameras.streams[1]: images of 'exo'")));
  EXPECT_EQ(findings[2].subject, "cameras.streams[0]");
  EXPECT_EQ(findings[2].severity, Severity::kWarning);
  EXPECT_EQ(findings[2].place, "") << "made in code";
  run.locations = RunConfig::Load(SourceDir() + "/examples/demo.yaml").locations;
  EXPECT_THAT(CheckRun(run)[2].place, HasSubstr("demo.yaml:"));
}

TEST(CheckRun, WarnsAboutAnArmThatDoesNotFollow) {
  RunConfig run = Demo();
  run.robot.config.force_limit = 0.01;
  const std::vector<std::string> warnings = Lines(CheckRun(run));
  EXPECT_EQ(CheckRun(run)[0].subject, "robot 'rc7'");
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings[0], HasSubstr("pushes with all it may, 0.01 N m"));
  EXPECT_THAT(warnings[0], HasSubstr("Raise `force_limit` (0.01 is set)"));
  EXPECT_THAT(CheckRun(run, {.scripted_expert = false}), IsEmpty());
}

TEST(CheckRun, WarnsAboutAnArmThatSagsUnderItsWeight) {
  RunConfig run = Demo();
  run.robot.config.gravcomp = false;
  EXPECT_THAT(Lines(CheckRun(run)), Not(Contains(HasSubstr("touch at home"))));
  run.robot.config.force_limit = 3;
  EXPECT_THAT(Lines(CheckRun(run)), Contains(AllOf(HasSubstr("pushes with all it may, 3 N m"),
                                                   HasSubstr("gravity needs"))));
}

// A group without actuators has no actions, and is no reason to reject a run.
TEST(CheckRun, WarnsAboutAGroupWithoutAControllerAndRecordsNoActions) {
  TempDir folder;
  RunConfig run = Demo();
  std::string model = ReadFile(run.robot.config.source_dir + "/rc7.xml");
  const std::string end = "</actuator>";
  model.insert(model.find(end), "<motor name=\"fan\" joint=\"joint1\" gear=\"0.001\"/>");
  // The keyframe has a number for each actuator.
  const size_t ctrl = model.find(" 100\"", model.find("<keyframe>"));
  model.insert(ctrl + 4, " 0");
  AtomicWrite(folder / "rc7.xml", model);
  run.robot.config.source_dir = folder.path().string();
  run.robot.config.move_groups["fan"] = {.kind = MoveGroupKind::kGeneric, .actuators = {"fan"}};
  EXPECT_THAT(Lines(CheckRun(run, {.on_this_machine = false})),
              Contains(AllOf(HasSubstr("group 'fan' has no controller"),
                             HasSubstr("Without one nothing commands it"))));
}

}  // namespace
}  // namespace robocell
