#include "robocell/base/suggestions.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Names = std::vector<std::string>;

const Names kJoints = {"joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"};

TEST(NearestNames, FindsTypingErrors) {
  const Names names = {"wrist_camera", "gripper", "left_finger", "right_finger", "base"};
  EXPECT_THAT(NearestNames("griper", names), ElementsAre("gripper"));    // missing
  EXPECT_THAT(NearestNames("grippper", names), ElementsAre("gripper"));  // doubled
  EXPECT_THAT(NearestNames("girpper", names), ElementsAre("gripper"));   // swapped
  EXPECT_THAT(NearestNames("grIpper", names), ElementsAre("gripper"));   // case
  EXPECT_THAT(NearestNames("wrist-camera", names), ElementsAre("wrist_camera"));
  EXPECT_THAT(NearestNames("bsae", names), ElementsAre("base"));
}

TEST(NearestNames, PutsTheNearestFirstAndKeepsTheOrderOfEquals) {
  EXPECT_THAT(NearestNames("joint8", kJoints), ElementsAre("joint7", "joint6", "joint5"));
  EXPECT_THAT(NearestNames("joint77", kJoints, 1), ElementsAre("joint7"));
  EXPECT_THAT(NearestNames("cup", {"cups", "cup_2", "cub"}), ElementsAre("cups", "cub", "cup_2"));
}

TEST(NearestNames, FindsNamesWithAnotherPrefix) {
  EXPECT_THAT(NearestNames("joint3", {"left_joint2", "left_joint3"}), ElementsAre("left_joint3"));
  EXPECT_THAT(NearestNames("left/tcp", {"base", "tcp"}), ElementsAre("tcp"));
}

TEST(NearestNames, IsEmptyWithoutASimilarName) {
  EXPECT_THAT(NearestNames("camera", {"joint1", "gripper"}), IsEmpty());
  EXPECT_THAT(NearestNames("ab", {"xy", "q"}), IsEmpty());
  EXPECT_THAT(NearestNames("", {"a", "ab", ""}), IsEmpty());
  EXPECT_THAT(NearestNames("x", {}), IsEmpty());
}

TEST(NearestNames, NeverNamesOneTwice) {
  EXPECT_THAT(NearestNames("bsae", {"base", "base", "case"}), ElementsAre("base", "case"));
}

TEST(ListNames, ShortensNumberedRuns) {
  EXPECT_EQ(ListNames(kJoints), "joint1 ... joint7");
  EXPECT_EQ(ListNames({"joint1", "joint2", "joint3"}), "joint1, joint2, joint3");
  EXPECT_EQ(ListNames({"j1", "j2", "j4", "j5"}), "j1, j2, j4, j5");
  EXPECT_EQ(ListNames({"a1", "a2", "b3", "a4"}), "a1, a2, b3, a4");
  EXPECT_EQ(ListNames({"j4", "j3", "j2", "j1"}), "j4, j3, j2, j1");
}

TEST(ListNames, CountsOmittedNames) {
  EXPECT_EQ(ListNames({"a", "b", "c"}, 2), "a, b and 1 more");
  EXPECT_EQ(ListNames({"a", "b", "c"}, 3), "a, b, c");
}

TEST(ListNames, ShowsEmptyLists) {
  EXPECT_EQ(ListNames({}), "(none)");
  EXPECT_EQ(ListNames({"a", "", "c"}), "a, '', c");
}

TEST(DidYouMean, IsASentenceOrNothing) {
  EXPECT_EQ(DidYouMean("joint77", kJoints), " Did you mean 'joint7'?");
  EXPECT_EQ(DidYouMean("camera", kJoints), "");
  EXPECT_EQ(DidYouMean("goalz", {"goal", "goals", "spread"}), " Did you mean 'goal' or 'goals'?");
}

TEST(Counted, IsInThePluralUnlessOne) {
  EXPECT_EQ(Counted(1, "number"), "1 number");
  EXPECT_EQ(Counted(2, "number"), "2 numbers");
  EXPECT_EQ(Counted(0, "copy"), "0 copies");
  EXPECT_EQ(Counted(1, "copy"), "1 copy");
  EXPECT_EQ(Counted(3, "kind of object"), "3 kinds of object");
}

TEST(NoSuchName, NamesPlaceElementAlternativesAndTheNearest) {
  EXPECT_EQ(NoSuchName("scene 'pick' / robot 'left'", "joint", "joint8", kJoints),
            "scene 'pick' / robot 'left': no joint 'joint8'. Its joints: joint1 ... joint7. "
            "Did you mean 'joint7'?");
  EXPECT_EQ(NoSuchName("", "body", "x", {"arm"}), "no body 'x'. Known bodies: arm.");
  EXPECT_EQ(NoSuchName("", "object or body", "x", {"arm"}),
            "no object or body 'x'. Known objects or bodies: arm.");
  EXPECT_EQ(NoSuchName("", "kind of object", "x", {"mug"}),
            "no kind of object 'x'. Known kinds of object: mug.");
  EXPECT_EQ(NoSuchName("file 'a.yaml'", "key", "x", {}),
            "file 'a.yaml': no key 'x'. Its keys: (none).");
  EXPECT_EQ(NoSuchName("robot", "mass", "x", {"a"}), "robot: no mass 'x'. Its masses: a.");
}

}  // namespace
}  // namespace robocell
