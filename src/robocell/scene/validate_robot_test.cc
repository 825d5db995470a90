// Tests elements that a robot file names and its model lacks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/robot_files.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using RobotNames = RobotFiles;

TEST_F(RobotNames, AJointThatDoesNotExist) {
  const std::string file = RobotFile(
      "move_groups:\n"
      "  arm:\n"
      "    joints: [shoulder, elbw]\n");
  ExpectThrow<SpecError>([&] { BuildRobot(file); },
                         file + ":5:24: robot 'left': no joint 'elbw'. Its joints: ");
}

}  // namespace
}  // namespace robocell::internal
