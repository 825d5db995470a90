#include "robocell/scene/finger_bodies.h"

#include <gtest/gtest.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

class FingerBodiesTest : public ArmWithHand {
 protected:
  std::vector<int> Of(const std::string& fingers) {
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
  const std::vector<int> both = {Id("left"), Id("right")};
  EXPECT_EQ(Of(""), both);
  EXPECT_EQ(Of("left"), both);
  EXPECT_EQ(Of("fore"), (std::vector<int>{Id("fore"), Id("right")}));
}

TEST_F(FingerBodiesTest, AreUnknownIfOneIsMissing) {
  Model();
  EXPECT_TRUE(Of("lfet").empty());
}

TEST_F(FingerBodiesTest, TheHandCarriesAllOfThem) {
  Model();
  const Scene scene = Build();
  const int hand = HandOf(scene.model(), {Id("left"), Id("right"), Id("left")});
  EXPECT_EQ(hand, scene.model()->body_parentid[Id("left")]);
  EXPECT_EQ(HandOf(scene.model(), {Id("left")}), Id("left"));
}

// Marks the joint of the slider for both forms of a tie, and nothing without one.
TEST(DofsThatDriveFingers, AreThoseBehindATie) {
  const auto dofs = [](const std::string& equality) {
    ModelFolder folder;
    const RobotSpec robot{
        .path = folder.Write("hand",
                             "<worldbody><body name='palm'><geom size='.01'/><body name='slider'>"
                             "<joint name='slide' type='slide'/><geom size='.01'/><body name='a'>"
                             "<joint name='a'/><geom size='.01'/></body><body name='b'>"
                             "<joint name='b'/><geom size='.01'/></body></body></body></worldbody>"
                             "<equality>" +
                                 equality + "</equality>")};
    SceneSpec spec = EmptyScene();
    spec.robots.push_back(robot);
    const Scene scene = Scene::Build(spec);
    const mjModel* m = scene.model();
    int slider = -1;
    for (int b = 0; b < m->nbody; ++b) {
      if (ElementName(m, mjOBJ_BODY, b).ends_with("slider")) slider = b;
    }
    return DofsThatDriveFingers(m, slider);
  };
  EXPECT_EQ(dofs("<joint joint1='a' joint2='slide'/>"), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(dofs("<connect body1='a' body2='palm' anchor='0 0 0'/>"),
            (std::vector<bool>{true, false, false}));
  EXPECT_EQ(dofs("<joint joint1='a' joint2='b'/>"), (std::vector<bool>{false, false, false}));
  EXPECT_EQ(dofs(""), (std::vector<bool>{false, false, false}));
}

}  // namespace
}  // namespace robocell::internal
