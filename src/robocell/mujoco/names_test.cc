#include "robocell/mujoco/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"

namespace robocell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StrEq;

ModelPtr Arm() {
  return Compile(ParseXmlString(R"(<mujoco>
    <worldbody>
      <body name="link1"><joint name="joint1" axis="0 0 1"/><geom size=".1"/>
        <body name="link2" pos="1 0 0"><joint name="joint2"/><joint axis="0 1 0"/><geom name="tip" size=".1"/></body>
      </body>
      <body><geom size=".1"/></body>
      <camera name="front"/>
    </worldbody>
    <keyframe><key name="home"/></keyframe>
  </mujoco>)")
                     .get());
}

TEST(Names, AreListedByIdWithEmptyOnesForUnnamedElements) {
  ModelPtr model = Arm();
  EXPECT_THAT(ElementNames(model.get(), mjOBJ_JOINT), ElementsAre("joint1", "joint2", ""));
  EXPECT_THAT(ElementNames(model.get(), mjOBJ_BODY), ElementsAre("world", "link1", "link2", ""));
  EXPECT_THAT(ElementNames(model.get(), mjOBJ_KEY), ElementsAre("home"));
  EXPECT_TRUE(ElementNames(model.get(), mjOBJ_SENSOR).empty());
}

TEST(Names, AreFoundExactly) {
  ModelPtr model = Arm();
  EXPECT_EQ(RequireId(model.get(), mjOBJ_JOINT, "joint2", "here"), 1);
  EXPECT_EQ(FindId(model.get(), mjOBJ_JOINT, "Joint2"), -1);
  EXPECT_EQ(FindId(model.get(), mjOBJ_JOINT, ""), -1);
}

TEST(Names, AMissingNameErrorHasPlaceAlternativesAndTheNearest) {
  ModelPtr model = Arm();
  try {
    RequireId(model.get(), mjOBJ_JOINT, "joint3", "scene 'pick' / robot 'left'");
    FAIL() << "found";
  } catch (const NotFoundError& error) {
    EXPECT_STREQ(error.what(),
                 "scene 'pick' / robot 'left': no joint 'joint3'. Its joints: joint1, joint2. Did "
                 "you mean 'joint2'?");
  }
}

TEST(Names, UnnamedElementsAreDescribedByTheirOwner) {
  ModelPtr model = Arm();
  EXPECT_EQ(Describe(model.get(), mjOBJ_JOINT, 0), "joint 'joint1'");
  EXPECT_EQ(Describe(model.get(), mjOBJ_JOINT, 2), "joint 2 (unnamed, of body 'link2')");
  EXPECT_EQ(Describe(model.get(), mjOBJ_GEOM, 2), "geom 2 (unnamed, of body 3 (unnamed))");
}

TEST(Names, KindsHaveCommonNames) {
  EXPECT_THAT(KindName(mjOBJ_BODY), StrEq("body"));
  EXPECT_THAT(KindName(mjOBJ_XBODY), StrEq("body"));
  EXPECT_THAT(KindName(mjOBJ_CAMERA), StrEq("camera"));
  EXPECT_THAT(KindName(mjOBJ_KEY), StrEq("keyframe"));
  EXPECT_THAT(KindName(mjOBJ_UNKNOWN), StrEq("element"));
}

}  // namespace
}  // namespace robocell
