// Tests arms of three to five joints, which reach a pose in one or a few ways: a start that leads
// elsewhere finds nothing. Targets are reachable by construction.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell {
namespace {

// A turning or sliding base, joints that pitch, and with four or more joints one that rolls.
std::string FewJointsXml(Rng* rng, int joints, const std::string& base) {
  std::string xml =
      "<mujoco><compiler angle='radian' autolimits='true'/><default><geom size='.01'/></default>"
      "<worldbody><body name='base'><geom/><body pos='0 0 .1'>" +
      base + "<geom/>";
  for (int i = 1; i < joints; ++i) {
    const bool rolls = i == joints - 1 && joints >= 4;
    const double range = rolls ? std::numbers::pi : rng->Uniform(1.5, 2.4);
    xml += fmt::format("<body pos='{} 0 .03'><joint axis='{}' range='-{} {}'/><geom/>",
                       rng->Uniform(0.05, 0.25), rolls ? "1 0 0" : "0 1 0", range, range);
  }
  xml += fmt::format("<site name='tip' pos='{} 0 0'/>", rng->Uniform(0.03, 0.12));
  for (int i = 0; i < joints; ++i) xml += "</body>";
  return xml + "</body></worldbody></mujoco>";
}

class ArmOfFewJoints : public testing::TestWithParam<std::tuple<int, const char*>> {};
INSTANTIATE_TEST_SUITE_P(
    Bases, ArmOfFewJoints,
    testing::Combine(testing::Values(3, 4, 5),
                     testing::Values("<joint axis='0 0 1' range='-3.14159265 3.14159265'/>",
                                     "<joint axis='0 0 1' range='-6.2831853 6.2831853'/>",
                                     "<joint axis='0 0 1' range='-2.83 2.83'/>",
                                     "<joint axis='0 0 1'/>",
                                     "<joint type='slide' axis='1 0 0' range='-.5 .5'/>")));

// The number of starts that a reach map gives each place. The first starts alone missed most
// places behind the base, at the ends of its joint's range.
TEST_P(ArmOfFewJoints, ReachesReachableTargetsFromNineStarts) {
  const auto [joints, base] = GetParam();
  Rng rng = Rng::Stream(1, "few joints", joints);
  const TestModel model = TestModel::FromXml(FewJointsXml(&rng, joints, base));
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  std::vector<Pose> targets;
  for (int b = 0; b < 3000; ++b) targets.push_back(chain.Fk(RandomJoints(chain, &rng)));
  const Eigen::Vector3d axis(1, 0, 0);
  for (IkOptions options :
       {IkOptions{.position_only = true}, IkOptions{.axis = axis}, IkOptions{}}) {
    options.tolerance = 1e-3;
    options.max_restarts = 8;
    const IkBatchResult found = IkBatch(chain, targets, {}, {.ik = options});
    int behind = 0, missed = 0;
    for (int b = 0; b < found.size; ++b) {
      const Eigen::Vector3d& place = targets[b].translation();
      if (std::abs(std::atan2(place.y(), place.x())) < std::numbers::pi - 0.2) continue;
      ++behind;
      missed += found.success[b] == 0;
    }
    EXPECT_GE(found.solved(), 2940) << options.position_only << options.axis.has_value();
    EXPECT_LE(missed, 3 + behind / 30) << behind;
  }
}

}  // namespace
}  // namespace robocell
