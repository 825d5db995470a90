#include "robocell/spec/attachment_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/robot_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ValidationError;

TEST(AttachmentSpec, GoesOnABodySiteOrFrame) {
  const AttachmentSpec spec{.mjcf_path = "hand.xml"};
  EXPECT_THAT(ValidationError(spec),
              HasSubstr("attach_to: an attachment needs a body, site or frame "
                        "of its robot, not 'world'"));
}

TEST(AttachmentSpec, RejectsADuplicate) {
  RobotConfig robot = ArmFile();
  const AttachmentSpec hand{
      .mjcf_path = "hand.xml", .attach_to = {AttachKind::kSite, "flange"}, .prefix = "hand_"};
  robot.attachments = {hand, hand};
  EXPECT_EQ(ValidationError(robot),
            "it is not valid: attachment 'hand_' (attachments[1]): 'hand.xml' is attachments[0] "
            "too, at the same place: "
            "is it listed twice? Remove one of them");
  robot.attachments[1].attach_to.name = "other_flange";
  EXPECT_THAT(ValidationError(robot), HasSubstr("with the same prefix 'hand_': is it listed "
                                                "twice? Each needs a different prefix"));
  robot.attachments[1].prefix = "other_";
  EXPECT_EQ(ValidationError(robot), "") << "two hands";
}

}  // namespace
}  // namespace robocell
