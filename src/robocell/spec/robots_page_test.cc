// Tests that the reference in docs/robots.md has exactly the fields that the specs declare.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "robocell/base/files.h"
#include "robocell/spec/robot_config.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

// Returns the first cells of the table below "### <heading>", without their backticks.
std::vector<std::string> FieldsOnPage(const std::string& heading) {
  std::istringstream page(ReadFile(SourceDir() + "/docs/robots.md"));
  std::vector<std::string> fields;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("#")) inside = line == "### " + heading;
    if (!inside || !line.starts_with("| `")) continue;
    const size_t end = line.find('`', 3);
    fields.push_back(line.substr(3, end - 3));
  }
  return fields;
}

template <class T>
void ExpectAllFieldsOnPage() {
  EXPECT_EQ(FieldsOnPage(T::kTypeName), FieldNames<T>()) << T::kTypeName;
}

TEST(RobotsPage, HasEveryFieldInOrderAndNoOther) {
  ExpectAllFieldsOnPage<RobotConfig>();
  ExpectAllFieldsOnPage<BaseConfig>();
  ExpectAllFieldsOnPage<MoveGroupConfig>();
  ExpectAllFieldsOnPage<GripperCtrl>();
  ExpectAllFieldsOnPage<GripperDistance>();
  ExpectAllFieldsOnPage<GripperJointRange>();
  ExpectAllFieldsOnPage<TaskSpaceConfig>();
  ExpectAllFieldsOnPage<AttachmentSpec>();
  ExpectAllFieldsOnPage<CameraSpec>();
  ExpectAllFieldsOnPage<ForceTorqueSensorSpec>();
  ExpectAllFieldsOnPage<Edit>();
}

TEST(RobotsPage, DetectsAMissingField) {
  EXPECT_THAT(FieldsOnPage("RobotConfig"), ::testing::Contains("arrival_tolerance"));
  EXPECT_THAT(FieldsOnPage("NoSuchType"), ::testing::IsEmpty());
}

}  // namespace
}  // namespace robocell
