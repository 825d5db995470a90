// Tests where the distance of two fingers is found to follow their motion, and where it is not.
#include "robocell/robot/finger_path.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

// Two capsules of 0.1 m, each on a joint of this kind and axis, 0.06 m apart.
class FingersOfTwoCapsules {
 public:
  explicit FingersOfTwoCapsules(const std::string& left, const std::string& right) {
    const auto finger = [](const std::string& name, const char* x, const std::string& joint) {
      return "<body name='" + name + "' pos='" + x + " 0 0'><joint " + joint +
             "/><geom type='capsule' size='0.008' fromto='0 0 0 0 0 0.1'/></body>";
    };
    const std::string file =
        folder_.Write("fingers", "<worldbody><body name='hand'><geom size='0.01' pos='0 0 -0.1'/>" +
                                     finger("left", "-0.03", left) +
                                     finger("right", "0.03", right) + "</body></worldbody>");
    model_ = Compile(ParseXmlFile(file).get());
    const auto body = [&](const char* name) {
      return ElementId{mjOBJ_BODY, RequireId(model(), mjOBJ_BODY, name, "test")};
    };
    pair_ = MakeFingers(model(), body("left"), body("right"), "test");
  }
  const mjModel* model() const { return model_.get(); }
  std::optional<FlatDistance> Flat(const std::vector<double>& from,
                                   const std::vector<double>& to) const {
    return FindFlatDistance(model(), pair_, from, to);
  }

 private:
  ModelFolder folder_;
  ModelPtr model_;
  FingerPair pair_;
};

TEST(FingerPath, TheDistanceOfParallelFingersFollowsTheirMotion) {
  const FingersOfTwoCapsules fingers("type='slide' axis='1 0 0'", "type='slide' axis='-1 0 0'");
  EXPECT_FALSE(fingers.Flat({-0.02, -0.02}, {0.02, 0.02}).has_value());
}

// Tips that open beyond the hinges leave the hinges as the nearest parts, 0.044 m apart.
TEST(FingerPath, TheDistanceOfHingedFingersIsAtTheirNearestPoint) {
  const FingersOfTwoCapsules fingers("axis='0 -1 0'", "axis='0 1 0'");
  const std::optional<FlatDistance> flat = fingers.Flat({0.6, 0.6}, {-0.2, -0.2});
  ASSERT_TRUE(flat.has_value());
  EXPECT_NEAR(flat->distance, 0.06 - 2 * 0.008, 1e-3);
  EXPECT_NEAR(flat->share, 0.6 / 0.8, 0.1);
  EXPECT_FALSE(fingers.Flat({0, 0}, {-0.2, -0.2}).has_value())
      << "the tips come nearer all the way";
}

}  // namespace
}  // namespace robocell::internal
