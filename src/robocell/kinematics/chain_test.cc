// Tests properties of a Chain, and the errors when it cannot be made.
#include "robocell/kinematics/chain.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr char kTwoArms[] = R"(<mujoco><compiler angle='radian'/><worldbody>
  <body name='cart' mocap='true'>
    <body name='left_base'><body name='left_upper'><joint name='left_a' range='-1 2' axis='0 1 0'/><geom size='.1'/>
      <body name='left_lower' pos='.3 0 0'><joint type='slide' axis='1 0 0'/><geom size='.1'/>
        <body name='left_tool'><joint name='left_grip'/><geom size='.1'/><site name='left_tcp'/></body></body></body></body>
    <body name='right_base'><body name='right_upper'><joint name='right_a'/><geom size='.1'/>
      <body name='right_wrist'><joint name='right_ball' type='ball'/><geom size='.1'/>
        <body name='right_hand'><joint name='right_b'/><geom size='.1'/></body></body></body></body>
  </body>
  <body name='ball'><freejoint name='ball_free'/><geom size='.1'/><site name='ball_top'/></body>
</worldbody></mujoco>)";

class ChainTest : public testing::Test {
 protected:
  Chain Make(std::string_view base, const ChainTip& tip, const ChainOptions& options = {}) {
    return Chain(t_.model(), base, tip, options);
  }
  TestModel t_ = TestModel::FromXml(kTwoArms);
};

TEST_F(ChainTest, ListsItsJointsInChainOrderWithLimitsAndAddresses) {
  const Chain chain = Make("left_base", ChainTip::Site("left_tcp"));
  EXPECT_EQ(chain.joint_names(),
            (std::vector<std::string>{"left_a", "left_lower:joint0", "left_grip"}));
  const ChainJoint& a = chain.joints()[0];
  EXPECT_TRUE(a.limited);
  EXPECT_EQ(a.lower, -1);
  EXPECT_EQ(a.upper, 2);
  EXPECT_EQ(a.body, "left_upper");
  EXPECT_EQ(a.qpos_address, t_.model()->jnt_qposadr[a.id]);
  EXPECT_EQ(chain.joints()[1].type, ChainJointType::kSlide);
  EXPECT_FALSE(chain.joints()[1].limited);
  EXPECT_EQ(chain.joints()[1].lower, -INFINITY);
  EXPECT_EQ(chain.description(), "chain 'left_base' -> site 'left_tcp'");
}

TEST_F(ChainTest, OutlivesTheModel) {
  const Chain chain = Make("left_base", ChainTip::Site("left_tcp"));
  const Pose before = chain.Fk(JointVector{0.1, 0.2, 0.3});
  t_ = TestModel::FromXml("<mujoco/>");
  EXPECT_EQ(chain.Fk(JointVector{0.1, 0.2, 0.3}), before);
}

TEST_F(ChainTest, ACopyOutlivesTheChain) {
  std::optional<Chain> chain = Make("left_base", ChainTip::Site("left_tcp"));
  const JointVector q{0.1, 0.2, 0.3};
  const Pose before = chain->Fk(q);
  const Chain copy = *chain;
  EXPECT_EQ(&copy.model(), &chain->model());  // shared, so copies are cheap
  EXPECT_EQ(&copy.lanes(), &chain->lanes());
  chain = Make("right_base", ChainTip::Body("right_upper"));
  EXPECT_EQ(copy.Fk(q), before);
  EXPECT_EQ(copy.joint_names().front(), "left_a");
  chain.reset();
  EXPECT_EQ(copy.Fk(q), before);
}

TEST_F(ChainTest, PrefixesBaseTipAndTool) {
  const Chain chain = Make("base", ChainTip::Site("tcp"), {.prefix = "left_", .tool_body = "tool"});
  EXPECT_EQ(chain.base_body(), "left_base");
  EXPECT_EQ(chain.tip().name, "left_tcp");
}

TEST_F(ChainTest, CanStartAtAMocapBodyButNotPassThroughIt) {
  EXPECT_EQ(Make("cart", ChainTip::Site("left_tcp")).n_joints(), 3);
  ExpectThrow<ArgumentError>(
      [&] { Make("world", ChainTip::Site("left_tcp")); },
      "kinematic chain 'world' -> site 'left_tcp': body 'cart' on the way is a "
      "mocap body, which no "
      "joint moves. Start the chain at 'cart' or below it.");
}

TEST_F(ChainTest, RejectsBallAndFreeJointsByName) {
  ExpectThrow<ArgumentError>(
      [&] { Make("right_base", ChainTip::Body("right_hand")); },
      "joint 'right_ball' on the way is a ball joint; a chain has hinges and slides "
      "only. Start the "
      "chain at body 'right_wrist', which that joint moves, or end it before.");
  ExpectThrow<ArgumentError>([&] { Make("world", ChainTip::Site("ball_top")); },
                             "joint 'ball_free' on the way is a free");
  EXPECT_EQ(Make("right_wrist", ChainTip::Body("right_hand")).joint_names(),
            std::vector<std::string>{"right_b"});
}

TEST_F(ChainTest, SuggestsNamesForAMissingBaseTipOrTool) {
  ExpectThrow<NotFoundError>([&] { Make("left_bas", ChainTip::Site("left_tcp")); },
                             "Did you mean 'left_base'");
  ExpectThrow<NotFoundError>([&] { Make("left_base", ChainTip::Site("left_tpc")); },
                             "no site 'left_tpc'");
  ExpectThrow<NotFoundError>([&] { Make("left_base", ChainTip::Body("left_tcp")); },
                             "no body 'left_tcp'");
  ExpectThrow<NotFoundError>(
      [&] { Make("left_base", ChainTip::Site("left_tcp"), {.tool_body = "left_tol"}); },
      "Did you mean 'left_tool'");
}

TEST_F(ChainTest, ListsTheBodiesToTheTipForAWrongBase) {
  ExpectThrow<ArgumentError>(
      [&] { Make("right_base", ChainTip::Site("left_tcp")); },
      "body 'left_tool' does not hang on 'right_base'. The bodies from the world to the tip: cart, "
      "left_base, left_upper, left_lower, left_tool. Choose the base among them.");
}

TEST_F(ChainTest, RejectsAToolOutsideTheChain) {
  ExpectThrow<ArgumentError>(
      [&] { Make("left_base", ChainTip::Body("left_lower"), {.tool_body = "right_hand"}); },
      "tool body 'right_hand' does not hang on the chain.");
  EXPECT_NO_THROW(Make("left_base", ChainTip::Body("left_lower"), {.tool_body = "left_tool"}));
}

TEST_F(ChainTest, RejectsALinkOfTheChainAsTheTool) {
  for (const char* link : {"left_base", "left_upper", "left_lower"}) {
    ExpectThrow<ArgumentError>(
        [&] { Make("left_base", ChainTip::Site("left_tcp"), {.tool_body = link}); },
        std::string("tool body '") + link +
            "' is a link of the chain itself, at or before its "
            "joint 'left_");
  }
}

TEST_F(ChainTest, RejectsANullModel) {
  ExpectThrow<ArgumentError>([] { Chain(nullptr, "base", ChainTip::Site("tip")); },
                             "kinematic chain 'base' -> site 'tip': there is no model");
}

TEST_F(ChainTest, RejectsAChainWithoutJoints) {
  ExpectThrow<ArgumentError>([&] { Make("left_base", ChainTip::Body("left_base")); },
                             "kinematic chain 'left_base' -> body 'left_base': there is no joint "
                             "between base and tip, so nothing moves. End it at one of the bodies "
                             "that move with respect to 'left_base', or at a site there: "
                             "left_upper, left_lower, left_tool.");
  ExpectThrow<ArgumentError>([&] { Make("right_base", ChainTip::Body("right_base")); },
                             "or at a site there: right_upper.");
  ExpectThrow<ArgumentError>([&] { Make("left_tool", ChainTip::Site("left_tcp")); },
                             "No hinge or slide moves a body on 'left_tool'; choose another base.");
}

TEST_F(ChainTest, RejectsTooManyJointsAndNamesThem) {
  std::string links, ends;
  for (int i = 1; i <= 17; ++i) {
    links +=
        fmt::format("<body name='b{0}' pos='.1 0 0'><joint name='j{0}'/><geom size='.02'/>", i);
    ends += "</body>";
  }
  t_ = TestModel::FromXml("<mujoco><worldbody>" + links + ends + "</worldbody></mujoco>");
  EXPECT_EQ(Make("world", ChainTip::Body("b16")).n_joints(), 16);
  ExpectThrow<ArgumentError>([&] { Make("world", ChainTip::Body("b17")); },
                             "a chain has at most 16 joints, this one has more: j1 ... j16, 'j17'");
}

TEST_F(ChainTest, RejectsNonFiniteJointValues) {
  const Chain chain = Make("left_base", ChainTip::Site("left_tcp"));
  const std::string name = chain.joint_names()[1];
  Eigen::MatrixXd jacobian(6, 3);
  std::vector<Pose> bodies(3);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), kInfinity, -kInfinity}) {
    const JointVector q{1, bad, -kInfinity};
    const std::string text = fmt::format(
        "chain 'left_base' -> site 'left_tcp': q: joint '{}' is {}; joint values must be finite",
        name, bad);
    ExpectThrow<ArgumentError>([&] { chain.Fk(q); }, text);
    ExpectThrow<ArgumentError>([&] { chain.FkAll(q, bodies); }, text);
    ExpectThrow<ArgumentError>([&] { chain.Jacobian(q, jacobian); }, text);
  }
  EXPECT_NO_THROW(chain.Fk(JointVector{1e300, -1e300, 0}));
}

TEST_F(ChainTest, RejectsAWrongNumberOfJointValues) {
  const Chain chain = Make("left_base", ChainTip::Site("left_tcp"));
  ExpectThrow<ArgumentError>(
      [&] {
        chain.Fk(JointVector{1, 2});
      },
      "chain 'left_base' -> site 'left_tcp': q: expected 3 joint values, got 2");
  Eigen::MatrixXd jacobian(6, 4);
  ExpectThrow<ArgumentError>(
      [&] {
        chain.Jacobian(JointVector{1, 2, 3}, jacobian);
      },
      "columns of the Jacobian: expected 3 joint values, got 4");
  const std::array<double, 2> qpos = {0, 0};
  ExpectThrow<ArgumentError>([&] { Make("left_base", ChainTip::Site("left_tcp"), {.qpos = qpos}); },
                             "qpos has 2 values, the model's has ");
}

TEST_F(ChainTest, FindsAJointByNameOrSuggestsOne) {
  const Chain chain = Make("left_base", ChainTip::Site("left_tcp"));
  EXPECT_EQ(chain.joint_index("left_grip"), 2);
  ExpectThrow<NotFoundError>([&] { chain.joint_index("left_gripp"); }, "Did you mean 'left_grip'");
}

}  // namespace
}  // namespace robocell
