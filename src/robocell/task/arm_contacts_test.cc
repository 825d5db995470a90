// Tests which arms touch and grasp an object.
#include "robocell/task/arm_contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/testing/two_hands.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

class ArmContactsTest : public TwoHandsTest {};

TEST_F(ArmContactsTest, AreOfTheHandsThatHoldIt) {
  const internal::ArmContacts contacts(*scene_, "bar");
  EXPECT_THAT(contacts.arms(), ElementsAre("hands/left", "hands/right"));
  for (const bool left : {false, true}) {
    for (const bool right : {false, true}) {
      Hold(left, right);
      const internal::ArmContacts::Seen seen = contacts.Look();
      EXPECT_EQ(seen.grasping(), left + right);
      EXPECT_EQ(seen.touching(), left + right);
      EXPECT_FALSE(seen.other);
      EXPECT_EQ(seen.only_holder(), left == right ? -1 : right ? 1 : 0);
    }
  }
}

TEST_F(ArmContactsTest, WithTheFloorAreNoHold) {
  const internal::ArmContacts contacts(*scene_, "bar");
  Hold(false, false, Lying());
  EXPECT_TRUE(contacts.Look().other);
  EXPECT_EQ(contacts.Look().only_holder(), -1);
}

TEST_F(ArmContactsTest, OfAnUnknownBodyAreAnError) {
  EXPECT_THROW(internal::ArmContacts(*scene_, "bra"), NotFoundError);
}

}  // namespace
}  // namespace robocell
