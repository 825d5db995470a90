// Tests a TCP that is given in two ways.
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(ToolPoints, RejectContradictoryValues) {
  ModelFolder folder;
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  const auto build = [&] {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "left", .config = config, .prefix = "l_"});
    return Scene::Build(spec);
  };
  config.attachment_site = "flange";
  config.tcp_offset = Pose(Eigen::Vector3d(0, 0, 0.1));
  ExpectThrow<SpecError>(
      [&] { build(); },
      "scene 'test' / robot 'left': the TCP is given twice: site 'flange' is the arm's leaf, but "
      "attachment_site * tcp_offset is 0.1 m and 0 rad away from it; keep one of them");
  config.tcp_offset = Pose();
  EXPECT_NO_THROW(build());
}

}  // namespace
}  // namespace robocell
