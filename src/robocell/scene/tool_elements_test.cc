// Tests advice about elements that came with a tool.
#include "robocell/scene/tool_elements.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class ToolElements : public ::testing::Test {
 protected:
  AttachmentSpec Tool(const std::string& prefix) {
    return {.mjcf_path = gripper_, .attach_to = {AttachKind::kSite, "flange"}, .prefix = prefix};
  }
  SceneSpec ArmWith(const std::vector<Edit>& edits) {
    SceneSpec spec = EmptyScene();
    RobotConfig config = ArmConfig(folder_.Write("arm", kTwoJointArm));
    config.attachments.push_back(Tool("g_"));
    for (const Edit& edit : edits) config.edits.push_back(edit);
    spec.robots.push_back({.config = config, .prefix = "r_"});
    return spec;
  }

  ModelFolder folder_;
  std::string gripper_ = folder_.Write("gripper", kTwoFingerGripper);
};

TEST_F(ToolElements, BelongToTheToolWithTheLongestPrefix) {
  const List<AttachmentSpec> tools = {Tool("g_"), Tool("g_2_"), Tool("")};
  EXPECT_EQ(ToolOf(tools, "g_left"), &tools[0]);
  EXPECT_EQ(ToolOf(tools, "g_2_left"), &tools[1]);
  EXPECT_EQ(ToolOf(tools, "fore"), nullptr);
}

TEST_F(ToolElements, AreChangedInTheirFile) {
  const Scene scene = Scene::Build(ArmWith({}));
  const CompiledScene& compiled = *scene.compiled();
  const auto how = [&](const char* body) {
    return HowToAddSite(compiled, compiled.robots()[0], body, "tip", "[0, 0, 0.1]");
  };
  EXPECT_EQ(how("r_fore").text, "edits: [{add_site: tip, body: fore, pos: [0, 0, 0.1]}] adds one");
  EXPECT_EQ(how("r_fore").edit, "{add_site: tip, body: fore, pos: [0, 0, 0.1]}");
  EXPECT_EQ(how("r_g_left").text,
            "add one, at [0, 0, 0.1], to body 'left' in the file of the tool, gripper.xml");
  EXPECT_EQ(how("r_g_left").edit, "");
}

TEST_F(ToolElements, AreNotFoundByEdits) {
  ExpectThrow<NotFoundError>(
      [&] { Scene::Build(ArmWith({{.body = ElementRef{.name = "g_left"}, .add_site = "tip"}})); },
      "no body 'g_left'. Its bodies: world, base, upper, fore. Names with 'g_' belong to the "
      "attached tool, and edits change the robot's own model: change " +
          gripper_ + " instead. A TCP needs no site: set attachment_site and tcp_offset");
}

}  // namespace
}  // namespace robocell::internal
