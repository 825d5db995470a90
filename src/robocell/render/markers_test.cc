#include "robocell/render/markers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace robocell {
namespace {

// Each arrow points along z of its own pose, which is an axis of the frame.
TEST(Markers, AFrameIsAnArrowAlongEachOfItsAxes) {
  const Pose frame = Pose::FromRpy({1, 2, 3}, {0.3, -0.4, 0.5});
  std::vector<Marker> markers;
  AddFrame(markers, frame, 0.1);
  ASSERT_EQ(markers.size(), 3);
  for (int axis = 0; axis < 3; ++axis) {
    const Marker& arrow = markers[static_cast<size_t>(axis)];
    EXPECT_EQ(arrow.shape, Marker::kArrow);
    EXPECT_EQ(arrow.pose.translation(), frame.translation());
    const Eigen::Vector3d along = arrow.pose.rotation().col(2);
    EXPECT_NEAR((along - frame.rotation().col(axis)).norm(), 0, 1e-12) << axis;
    EXPECT_EQ(arrow.size[1], 0.1);
    const auto brightest = std::ranges::max_element(arrow.rgba.begin(), arrow.rgba.begin() + 3);
    EXPECT_EQ(brightest - arrow.rgba.begin(), axis) << "x red, y green, z blue";
  }
}

TEST(Markers, AFrameWithATextHasALabel) {
  std::vector<Marker> markers;
  AddFrame(markers, Pose(), 0.1, "tcp");
  ASSERT_EQ(markers.size(), 4);
  EXPECT_EQ(markers[3].shape, Marker::kText);
  EXPECT_EQ(std::string(markers[3].text.data()), "tcp");
}

TEST(Markers, LongTextsAreTruncatedAndEnd) {
  std::vector<Marker> markers;
  AddText(markers, {0, 0, 1}, std::string(200, 'x'));
  EXPECT_EQ(std::string(markers[0].text.data()), std::string(63, 'x'));
}

TEST(Markers, APointIsASphereOfItsRadius) {
  std::vector<Marker> markers;
  AddPoint(markers, {1, 2, 3}, 0.05, {0, 1, 0, 0.5f});
  EXPECT_EQ(markers[0].shape, Marker::kSphere);
  EXPECT_EQ(markers[0].size[0], 0.05);
  EXPECT_EQ(markers[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(markers[0].rgba[3], 0.5f);
}

}  // namespace
}  // namespace robocell
