#include "robocell/spec/locations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

constexpr const char* kArm = R"(name: arm
model: arm.xml
move_groups:
  arm:
    kind: arm
    joints: [joint1..joint2, elbow]
)";

TEST(Locations, AValueHasItsPlaceInTheFile) {
  const TempDir folder;
  const std::string file = (folder.path() / "arm.yaml").string();
  AtomicWrite(file, kArm);
  const Locations at = RobotConfig::Load(file).locations;
  EXPECT_EQ(at.At("model"), file + ":2:8");
  EXPECT_EQ(at.At("move_groups.arm.joints[0]"), file + ":6:14");
  EXPECT_EQ(at.At("move_groups.arm.joints[1]"), file + ":6:14");
  EXPECT_EQ(at.At("move_groups.arm.joints[2]"), file + ":6:30");
  EXPECT_EQ(at.Below("move_groups").At("arm.kind"), file + ":5:11");
}

TEST(Locations, AnUnsetFieldHasThePlaceOfItsParent) {
  const TempDir folder;
  const std::string file = (folder.path() / "arm.yaml").string();
  AtomicWrite(file, kArm);
  const Locations at = RobotConfig::Load(file).locations;
  EXPECT_EQ(at.At("move_groups.arm.leaf"), file + ":5:5");
  EXPECT_EQ(at.At("root_body"), file + ":1:1");
  EXPECT_FALSE(at.Exactly("root_body"));
}

TEST(Locations, ElementsAddedLaterHaveNone) {
  const TempDir folder;
  const std::string file = (folder.path() / "arm.yaml").string();
  AtomicWrite(file, std::string(kArm) + "edits: [{body: a, quat_wxyz: [1, 0, 0, 0]}]\n");
  const Locations at = RobotConfig::Load(file).locations;
  EXPECT_EQ(at.At("edits[0].pos"), file + ":7:9");
  EXPECT_EQ(at.At("edits[0].quat[2]"), file + ":7:30") << "given in another form";
  EXPECT_EQ(at.At("edits[1].pos"), "") << "a list of the file";
  EXPECT_EQ(at.At("ft_sensors[0]"), "") << "a list that the file does not have";
  EXPECT_EQ(at.At("move_groups.hand.leaf"), "") << "a map of the file";
  EXPECT_EQ(at.At("home.arm[2]"), "") << "a map that the file does not have";
  EXPECT_EQ(at.At("home"), file + ":1:1");
}

TEST(Locations, ARobotFileNamedByARunFileKeepsItsOwn) {
  const TempDir folder;
  AtomicWrite(folder.path() / "arm.yaml", kArm);
  const std::string run = (folder.path() / "run.yaml").string();
  AtomicWrite(run, "run: r\nrobot: arm.yaml\noutput: out\n");
  const RunConfig config = RunConfig::Load(run);
  EXPECT_EQ(config.locations.At("output"), run + ":3:9");
  EXPECT_EQ(config.robot.config.locations.At("model"),
            (folder.path() / "arm.yaml").string() + ":2:8");
}

// The key is wrong, not the robot's file; what that file lacks is missing there.
TEST(Locations, ARobotFileIsNamedInTheFileAroundIt) {
  const TempDir folder;
  AtomicWrite(folder.path() / "arm.yaml", kArm);
  const std::string file = (folder.path() / "cell.yaml").string();
  AtomicWrite(file, "robots: {left: arm.yaml}\ngrippers:\n  lef: arm.yaml\n  left: arm.yaml\n");
  const std::string text = ExpectThrow<SpecError>([&] { EnvConfig::Load(file); }, "grippers");
  EXPECT_THAT(text, HasSubstr(file + ":3:8: grippers.lef: no robot 'lef'"));
  EXPECT_THAT(text, HasSubstr((folder.path() / "arm.yaml").string() +
                              ":1:1: robots.left.attachment_site: is not "
                              "set"));
}

TEST(Locations, ARobotInPlaceIsAPartOfItsFile) {
  const TempDir folder;
  const std::string file = (folder.path() / "scene.yaml").string();
  AtomicWrite(file,
              "timestep: 0.002\nadd_floor: true\nadd_skybox: true\nrobots:\n"
              "  - config: {name: arm, model: arm.xml}\n");
  const SceneSpec scene = SceneSpec::Load(file);
  EXPECT_EQ(scene.robots[0].config->locations.At("model"), file + ":5:32");
  EXPECT_EQ(scene.locations.Below("robots[0]").At("config.model"), file + ":5:32");
}

TEST(Locations, CopiesThroughYamlHaveNone) {
  const RobotConfig copy = FromYamlUnchecked<RobotConfig>(kArm);
  EXPECT_EQ(copy.locations.At("model"), "");
}

TEST(Locations, ASpecFromNoFileHasNone) {
  const RobotConfig robot;
  EXPECT_EQ(robot.locations.At("model"), "");
  EXPECT_EQ(robot.locations.Below("move_groups").At("arm"), "");
}

}  // namespace
}  // namespace robocell
