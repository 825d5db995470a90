#include "robocell/rollout/episode_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/robot/joint_group.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

// A group of the user's own kind with a coordinate that is no joint of the model.
class Belt : public JointGroup {
 public:
  explicit Belt(const Scene& scene)
      : JointGroup(scene,
                   {.robot = "rc7",
                    .group = "belt",
                    .joints = {"joint1"},
                    .root = {false, "link1"},
                    .leaf = {false, "link1"},
                    .robot_base = {false, "base_link"}},
                   MoveGroupKind::kGeneric) {}
  const std::vector<std::string>& joint_names() const override { return names_; }

 private:
  std::vector<std::string> names_ = {"travel"};
};

std::string Units(const EpisodeSchema& schema, const std::string& column) {
  return schema.column(schema.FindColumn(column)).units;
}

TEST(RobotColumns, UnitsAreThoseOfTheJoints) {
  Robot robot = RobotAlone(Rc7());
  EpisodeSchema schema;
  const RobotColumns columns(schema, robot);
  EXPECT_EQ(Units(schema, "robots/rc7/arm/qpos"), "rad");
  EXPECT_EQ(Units(schema, "robots/rc7/arm/qvel"), "rad/s");
  EXPECT_EQ(Units(schema, "robots/rc7/gripper/qpos"), "m");
  EXPECT_EQ(Units(schema, "robots/rc7/gripper/qvel"), "m/s");
}

TEST(RobotColumns, CoordinatesThatAreNoJointsHaveNoUnits) {
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  EpisodeSchema schema;
  const RobotColumns columns(schema, robot);
  EXPECT_EQ(Units(schema, "robots/rc7/belt/qpos"), "");
  EXPECT_EQ(Units(schema, "robots/rc7/belt/qvel"), "");
}

TEST(RobotColumns, AGroupThatChangesDuringTheEpisodeIsRefused) {
  Robot robot = RobotAlone(Rc7());
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  EpisodeSchema schema;
  RobotColumns columns(schema, robot);
  TempDir folder;
  EpisodeWriter writer(folder.path(), "e", schema);
  columns.PutState(writer);
  columns.PutAction(writer);
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  const std::string replaced =
      "robot 'rc7' / group 'belt' was replaced during the episode, whose columns were laid out at "
      "its start; change groups before, in the sampler or in the begin() of the expert";
  ExpectThrow<Error>([&] { columns.PutState(writer); }, replaced);
  ExpectThrow<Error>([&] { columns.PutAction(writer); }, replaced);
}

TEST(RobotColumns, AGroupThatIsAddedDuringTheEpisodeIsRefused) {
  Robot robot = RobotAlone(Rc7());
  EpisodeSchema schema;
  RobotColumns columns(schema, robot);
  TempDir folder;
  EpisodeWriter writer(folder.path(), "e", schema);
  robot.SetGroup(std::make_shared<Belt>(robot.scene()));
  ExpectThrow<Error>([&] { columns.PutState(writer); },
                     "group 'belt' was added during the episode");
}

}  // namespace
}  // namespace robocell
