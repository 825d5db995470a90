// Tests measured grippers against distances that follow from their joints and shapes.
#include "robocell/robot/gripper_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Returns the gripper of two slides with its pads, 1 cm thick, `offset` (m) to each side when it is
// closed.
std::string GripperModel(const std::string& offset = "0.006") {
  std::string text = kTwoFingerGripper;
  for (const auto& [name, y] : {std::pair("left", offset), std::pair("right", "-" + offset)}) {
    const std::string place = std::string("name=\"") + name + "\" pos=\"0 ";
    text.replace(text.find(place) + place.size(), 1, y);
  }
  return text;
}

// A gripper alone in a scene. With control 0..255 its pads slide 0 to 4 cm to each side.
class GripperRangeTest : public ::testing::Test {
 protected:
  Scene Build(const std::string& model = GripperModel()) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "hand", .path = folder_.Write("hand", model)});
    return Scene::Build(spec);
  }
  static int Id(const Scene& scene, mjtObj kind, const std::string& name) {
    const RobotRecord& robot = scene.compiled()->robot("hand");
    return RequireId(scene.model(), kind, robot.prefix + name, "test");
  }
  static GripperParts PartsOf(const Scene& scene) {
    const mjModel* m = scene.model();
    const auto body = [&](const char* name) {
      return ElementId{mjOBJ_BODY, Id(scene, mjOBJ_BODY, name)};
    };
    const int actuator = Id(scene, mjOBJ_ACTUATOR, "grip");
    return {Id(scene, mjOBJ_BODY, "palm"),
            {m->actuator_ctrladr[actuator]},
            MakeFingers(m, body("left"), body("right"), "test")};
  }
  static std::string Replaced(const std::string& what, const std::string& with) {
    std::string text = GripperModel();
    return text.replace(text.find(what), what.size(), with);
  }

 private:
  ModelFolder folder_;
};

using Ends = std::array<std::vector<double>, 2>;

TEST_F(GripperRangeTest, DistancesAreThoseOfTheJoints) {
  const Scene scene = Build();
  const GripperParts parts = PartsOf(scene);
  const Ends ends = {{{255}, {127.5}}};
  const SettledFingers settled = SettleFingers(scene, parts, ends);
  EXPECT_NEAR(settled.distances[0], 2 * 0.04 + 0.002, 5e-4);
  EXPECT_NEAR(settled.distances[1], 2 * 0.02 + 0.002, 5e-4);
  const int joint = Id(scene, mjOBJ_JOINT, "left_slide");
  const auto values = SettledJointValues(scene, parts, ends, joint);
  EXPECT_NEAR(values[0], 0.04, 3e-4);
  EXPECT_NEAR(values[1], 0.02, 3e-4);
  EXPECT_FALSE(settled.pressed.has_value());
}

TEST_F(GripperRangeTest, ThePresentStateAndOtherScenesPlayNoPart) {
  const Scene scene = Build(), other = Build();
  const Ends ends = {{{255}, {127.5}}};
  const SettledFingers first = SettleFingers(scene, PartsOf(scene), ends);
  mjData* data = other.data();
  data->qpos[other.model()->jnt_qposadr[Id(other, mjOBJ_JOINT, "left_slide")]] = 0.03;
  data->ctrl[0] = 10;
  const SettledFingers second = SettleFingers(other, PartsOf(other), ends);
  EXPECT_EQ(first.distances, second.distances);
  EXPECT_EQ(first.pushed, second.pushed);
}

TEST_F(GripperRangeTest, TheOrderOfTheEndsIsThatOfTheDistances) {
  const Scene scene = Build();
  const SettledFingers opening = SettleFingers(scene, PartsOf(scene), {{{127.5}, {255}}});
  EXPECT_LT(opening.distances[0], opening.distances[1]);
}

TEST_F(GripperRangeTest, FingersThatMeetTouch) {
  const Scene scene = Build(GripperModel("0.004"));
  const GripperParts parts = PartsOf(scene);
  EXPECT_NEAR(SettleFingers(scene, parts, {{{255}, {0}}}).distances[1], 0, 1e-3);
  const std::string prefix = scene.compiled()->robot("hand").prefix;
  EXPECT_THAT(TouchingFingers(scene, parts, {{{255}, {0}}}),
              ElementsAre("'" + prefix + "left' and '" + prefix + "right'"));
  EXPECT_THAT(TouchingFingers(scene, parts, {{{255}, {200}}}), IsEmpty());
}

TEST_F(GripperRangeTest, FingersThatAlwaysOverlapAreNamed) {
  const Scene scene = Build();
  EXPECT_FALSE(OverlapOfFingers(scene, PartsOf(scene), {{{255}, {127.5}}}).has_value());
  const Scene thick = Build(Replaced("size=\"0.01 0.005 0.02\" type=\"box\"",
                                     "size=\"0.01 0.06 0.02\" type=\"box\" contype=\"0\" "
                                     "conaffinity=\"0\""));
  const auto geoms = OverlapOfFingers(thick, PartsOf(thick), {{{255}, {127.5}}});
  ASSERT_TRUE(geoms.has_value());
  EXPECT_THAT(*geoms,
              ElementsAre(Id(thick, mjOBJ_GEOM, "left_pad"), Id(thick, mjOBJ_GEOM, "right_pad")));
}

TEST_F(GripperRangeTest, ActuatorsAreThoseOfTheControls) {
  const Scene scene = Build();
  EXPECT_THAT(ActuatorsOf(scene.model(), PartsOf(scene)),
              ElementsAre(Id(scene, mjOBJ_ACTUATOR, "grip")));
  GripperParts none = PartsOf(scene);
  none.ctrl_addresses.clear();
  EXPECT_THAT(ActuatorsOf(scene.model(), none), IsEmpty());
}

// A spring without a damper swings on.
TEST_F(GripperRangeTest, FingersThatNeverRestAreAnError) {
  const Scene scene = Build(Replaced("0 -1000 -10", "0 -1000 0"));
  ExpectThrow<ArgumentError>(
      [&] {
        SettleFingers(scene, PartsOf(scene), {{{255}, {127.5}}});
      },
      "the fingers do not come to rest: 20 s after control 127.5");
}

TEST(CtrlText, HasBracketsForSeveralActuators) {
  EXPECT_EQ(CtrlText({0.7}), "0.7");
  EXPECT_EQ(CtrlText({0.7, -0.7}), "[0.7, -0.7]");
}

}  // namespace
}  // namespace robocell::internal
