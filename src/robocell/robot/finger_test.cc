// Tests the fingers of grippers against distances that follow from their shapes.
#include "robocell/robot/finger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Hand {
 public:
  explicit Hand(const std::string& inside)
      : model_(Compile(
            ParseXmlString("<mujoco><compiler angle='radian'/>" + inside + "</mujoco>").get())),
        data_(MakeData(model_.get())) {}
  const mjModel* model() const { return model_.get(); }
  mjData* data() const { return data_.get(); }
  ElementId Id(mjtObj kind, const char* name) const {
    return {kind, RequireId(model(), kind, name, "test")};
  }
  FingerPair Bodies(const char* first, const char* second) const {
    return MakeFingers(model(), Id(mjOBJ_BODY, first), Id(mjOBJ_BODY, second), "robot 'left'");
  }
  void Move(const std::vector<double>& qpos) const {
    std::copy(qpos.begin(), qpos.end(), data()->qpos);
    mj_kinematics(model(), data());
  }
  double Distance(const FingerPair& pair) const {
    return FingerDistance(model(), data(), pair.fingers[0], pair.fingers[1]);
  }

 private:
  ModelPtr model_;
  DataPtr data_;
};

// Two boxes of 1 cm that slide apart, with a site at the centre of each.
Hand ParallelHand() {
  const auto finger = [](const std::string& name, const char* axis) {
    return "<body name='" + name + "'><joint type='slide' axis='" + axis + "'/><geom name='" +
           name + "_pad' type='box' size='.01 .005 .02'/><geom name='" + name +
           "_look' type='box' size='.01 .009 .02' contype='0' conaffinity='0'/><site name='" +
           name + "_tip'/></body>";
  };
  return Hand("<worldbody><body name='palm'><geom name='palm' size='.01' pos='0 0 -.1'/>" +
              finger("left", "0 1 0") + finger("right", "0 -1 0") +
              "<body name='cover'><geom name='cover' size='.01' pos='0 0 -.2'/></body></body>"
              "</worldbody>");
}

TEST(Finger, IsMeasuredByItsCollidingGeoms) {
  const Hand hand = ParallelHand();
  const FingerPair pair = hand.Bodies("left", "right");
  EXPECT_EQ(pair.hand, hand.Id(mjOBJ_BODY, "palm").id);
  EXPECT_THAT(pair.fingers[0].geoms, ElementsAre(hand.Id(mjOBJ_GEOM, "left_pad").id));
  EXPECT_THAT(pair.fingers[0].side,
              ElementsAre(hand.Id(mjOBJ_GEOM, "left_pad").id, hand.Id(mjOBJ_GEOM, "left_look").id));
  EXPECT_TRUE(pair.fingers[0].is_body);
}

TEST(Finger, DistancesAreThoseOfTheFaces) {
  const Hand hand = ParallelHand();
  const FingerPair pair = hand.Bodies("left", "right");
  for (const double q : {0.006, 0.01, 0.04, 0.2}) {
    hand.Move({q, q});
    EXPECT_NEAR(hand.Distance(pair), 2 * q - 0.01, 1e-9) << q;
    const NearestPoints nearest =
        NearestOf(hand.model(), hand.data(), pair.fingers[0], pair.fingers[1]);
    EXPECT_NEAR(nearest.first[1], q - 0.005, 1e-6);
    EXPECT_NEAR(nearest.second[1], 0.005 - q, 1e-6);
  }
}

TEST(Finger, TheDistanceIsTheSameFromBothSides) {
  const Hand hand = ParallelHand();
  const FingerPair pair = hand.Bodies("left", "right"), other = hand.Bodies("right", "left");
  hand.Move({0.03, 0.01});
  EXPECT_NEAR(hand.Distance(pair), hand.Distance(other), 1e-12);
}

TEST(Finger, OverlapsHaveNoDistanceAndANegativeDepth) {
  const Hand hand = ParallelHand();
  const FingerPair pair = hand.Bodies("left", "right");
  hand.Move({0.003, 0.003});
  EXPECT_EQ(hand.Distance(pair), 0);
  EXPECT_NEAR(NearestOf(hand.model(), hand.data(), pair.fingers[0], pair.fingers[1]).distance,
              -0.004, 1e-6);
}

TEST(Finger, FarFingersAreAMetreApart) {
  const Hand hand = ParallelHand();
  hand.Move({3, 3});
  EXPECT_EQ(hand.Distance(hand.Bodies("left", "right")), 1);
}

TEST(Finger, SitesAreMeasuredFromCentreToCentre) {
  const Hand hand = ParallelHand();
  const FingerPair pair = MakeFingers(hand.model(), hand.Id(mjOBJ_SITE, "left_tip"),
                                      hand.Id(mjOBJ_SITE, "right_tip"), "robot 'left'");
  hand.Move({0.003, 0.003});
  EXPECT_NEAR(hand.Distance(pair), 0.006, 1e-12);
  EXPECT_FALSE(FindJaw(hand.model(), pair).has_value());
}

TEST(Finger, AGeomIsMeasuredAlone) {
  const Hand hand = ParallelHand();
  const FingerPair pair = MakeFingers(hand.model(), hand.Id(mjOBJ_GEOM, "left_look"),
                                      hand.Id(mjOBJ_GEOM, "right_look"), "robot 'left'");
  hand.Move({0.02, 0.02});
  EXPECT_NEAR(hand.Distance(pair), 0.04 - 0.018, 1e-9);
}

TEST(Finger, RejectsPartsOfOneRigidBody) {
  const Hand hand = ParallelHand();
  ExpectThrow<ArgumentError>(
      [&] { hand.Bodies("palm", "cover"); },
      "robot 'left': the fingers body 'palm' and body 'cover' are parts of one rigid body, so "
      "nothing moves between them; name one element of each finger");
}

// A jaw of 10 cm that turns in the palm, whose own jaw is as long. The palm's reaches from the
// hinge (`from` 0) or is at its tip alone.
Hand JawHand(double from) {
  return Hand("<worldbody><body name='palm'><geom type='capsule' size='.005' fromto='0 0 " +
              std::to_string(from) +
              " 0 0 .1'/><body name='jaw' pos='0 .02 0'><joint name='hinge' axis='-1 0 0' "
              "range='-.5 .5' limited='true'/><geom type='capsule' size='.005' fromto='0 0 0 0 0 "
              ".1'/></body></body></worldbody>");
}

TEST(Finger, AJawIsTheFingerThatTurnsInTheOther) {
  const Hand hand = JawHand(0);
  const std::optional<Jaw> jaw = FindJaw(hand.model(), hand.Bodies("palm", "jaw"));
  ASSERT_TRUE(jaw.has_value());
  EXPECT_EQ(jaw->index, 1);
  EXPECT_EQ(jaw->joint, hand.Id(mjOBJ_JOINT, "hinge").id);
  EXPECT_EQ(FindJaw(hand.model(), hand.Bodies("jaw", "palm"))->index, 0);
  const Hand parallel = ParallelHand();
  EXPECT_FALSE(FindJaw(parallel.model(), parallel.Bodies("left", "right")).has_value());
}

// At its hinge a jaw is 2 cm away however far it opens; a tip moves away.
TEST(Finger, AWideJawIsMeasuredAtItsHinge) {
  for (const auto& [from, at_hinge] : {std::pair(0.0, true), std::pair(0.09, false)}) {
    const Hand hand = JawHand(from);
    const FingerPair pair = hand.Bodies("palm", "jaw");
    const std::vector<double> home = {0};
    EXPECT_EQ(IsMeasuredAtItsHinge(hand.model(), home, pair, *FindJaw(hand.model(), pair)),
              at_hinge)
        << from;
  }
}

TEST(Finger, TheFingertipsOfALinkageAreTheFarthestPartsTiedToIt) {
  const auto side = [](const std::string& name, const std::string& y) {
    return "<body name='" + name + "_driver' pos='0 " + y +
           " 0'><joint axis='1 0 0'/><geom size='.005' pos='0 0 .03'/></body><body name='" + name +
           "_pad' pos='0 " + y + " 0'><joint axis='1 0 0'/><geom size='.005' pos='0 0 .1'/></body>";
  };
  const Hand hand("<worldbody><body name='palm'><geom size='.01' pos='0 0 -.1'/>" +
                  side("left", ".03") + side("right", "-.03") +
                  "</body></worldbody><equality><connect body1='left_driver' body2='left_pad' "
                  "anchor='0 0 .03'/><connect body1='right_pad' body2='right_driver' "
                  "anchor='0 0 .03'/></equality>");
  const auto body = [&](const char* name) { return hand.Id(mjOBJ_BODY, name).id; };
  EXPECT_THAT(FingertipBodies(hand.model(), body("left_driver"), body("right_driver")),
              ElementsAre(body("left_pad"), body("right_pad")));
  const Hand plain = ParallelHand();
  const int left = plain.Id(mjOBJ_BODY, "left").id, right = plain.Id(mjOBJ_BODY, "right").id;
  EXPECT_THAT(FingertipBodies(plain.model(), left, right), ElementsAre(left, right));
}

}  // namespace
}  // namespace robocell::internal
