#include "robocell/scene/finger_bodies.h"

#include <gtest/gtest.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

class FingerBodiesTest : public ArmWithHand {
 protected:
  std::optional<std::array<int, 2>> Of(const std::string& fingers) {
    const Scene scene = Build();
    MoveGroupConfig group = *scene.compiled()->robots()[0].config.move_groups.find("hand");
    if (!fingers.empty()) group.fingers = {Body(fingers), Body("right")};
    return FingerBodies(scene.model(), scene.compiled()->robots()[0], group);
  }
  static ElementRef Body(const std::string& name) {
    return {.kind = ElementKind::kBody, .name = name};
  }
  int Id(const std::string& name) { return FindId(Build().model(), mjOBJ_BODY, "a/" + name); }
};

TEST_F(FingerBodiesTest, AreTheNamedOnesOrThoseOfTheJoints) {
  Model();
  const std::array<int, 2> both = {Id("left"), Id("right")};
  EXPECT_EQ(Of(""), both);
  EXPECT_EQ(Of("left"), both);
  EXPECT_EQ(Of("fore"), (std::array<int, 2>{Id("fore"), Id("right")}));
}

TEST_F(FingerBodiesTest, AreUnknownIfOneIsMissing) {
  Model();
  EXPECT_EQ(Of("lfet"), std::nullopt);
}

}  // namespace
}  // namespace robocell::internal
