#include "robocell/diagnose/check_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/long_form.h"

namespace robocell {
namespace {

using ::testing::IsEmpty;

TEST(CheckRobot, ShippedRobotsFollowTheirCommands) {
  const auto doubts = [](const char* file) {
    const Robot robot = RobotAlone(LoadShipped(file));
    std::vector<std::string> all = robot.scene().compiled()->warnings();
    for (std::string& doubt : LinesOfRobot(robot)) all.push_back(std::move(doubt));
    return all;
  };
  EXPECT_THAT(doubts("models/robots/rc7/rc7.yaml"), IsEmpty());
  EXPECT_THAT(doubts("examples/desk6/desk6.yaml"), IsEmpty());
  for (const auto& [file, model] : {std::pair{"xarm7.yaml", "ufactory_xarm7"},
                                    {"panda.yaml", "franka_emika_panda"},
                                    {"fr3_2f85.yaml", "franka_fr3"},
                                    {"gen3_2f85.yaml", "kinova_gen3"}}) {
    // The short form tries a gripper that belongs to the model and one beside it.
    const bool is_short =
        model == std::string_view("ufactory_xarm7") || model == std::string_view("franka_fr3");
    if (!LongForm() && !is_short) continue;
    REQUIRE_MENAGERIE(model);
    EXPECT_THAT(doubts((std::string("examples/") + file).c_str()), IsEmpty()) << file;
  }
}

}  // namespace
}  // namespace robocell
