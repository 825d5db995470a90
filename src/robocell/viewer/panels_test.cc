#include "robocell/viewer/panels.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstdint>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, PanelsSwitchWhatIsShown) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  Click(viewer, "View", "Contacts");
  EXPECT_TRUE(viewer.view().flags.contacts);
  Click(viewer, "View", "Contacts");
  EXPECT_FALSE(viewer.view().flags.contacts);
  viewer.view().flags.joints = true;  // by the program
  viewer.Show();
  Click(viewer, "View", "Shadows");
  EXPECT_FALSE(viewer.view().flags.shadows);
  EXPECT_TRUE(viewer.view().flags.joints) << "another box leaves it";
  viewer.ShowPanels("Frames", "");
  Click(viewer, "Frames", "cube");
  EXPECT_TRUE(viewer.view().ShowsFrame({ViewElement::kBody, "cube"}));
  viewer.ShowPanels("Trace", "");
  Click(viewer, "Trace", "arm");
  EXPECT_TRUE(viewer.view().Traces({ViewElement::kTcp, "arm"}));
  viewer.ShowPanels("RTF", "");
  Click(viewer, "RTF", "Unlimited");
  EXPECT_EQ(viewer.realtime_factor(), 0);
  viewer.ShowPanels("Run", "");
  Click(viewer, "Run", "Close");
  EXPECT_FALSE(viewer.is_running());
}

TEST_F(Viewers, PanelsSetTheSpeedTheTraceAndWhatDraggingDoes) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.ShowPanels("RTF", "");
  Click(viewer, "RTF", "Requested", 60);
  for (const int key :
       {mjKEY_END, mjKEY_BACKSPACE, mjKEY_BACKSPACE, static_cast<int>('3'), mjKEY_ENTER})
    Key(viewer, key);
  EXPECT_EQ(viewer.realtime_factor(), 3);
  viewer.ShowPanels("Trace", "");
  Click(viewer, "Trace", "Seconds", 60);
  EXPECT_GT(viewer.view().traces.length(), 30);
  viewer.ShowPanels("Run", "");
  std::vector<uint8_t> before, after;
  int width = 0, height = 0;
  before = viewer.Pixels(&width, &height);
  Click(viewer, "Run", "Help");
  after = viewer.Pixels(&width, &height);
  EXPECT_NE(before, after);
  Click(viewer, "Run", "", -40);
  EXPECT_TRUE(viewer.paused());
}

TEST_F(Viewers, ThePanelOfPerturbationsMakesEachDragAPull) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  viewer.view().SetFreeCamera(1, 90, -30, {0.6, 0.2, 0.02});
  viewer.view().SelectBody("cube");
  viewer.ShowPanels("Perturb", "");
  const auto [x, y] = viewer.PlaceOf("Perturb", "Drag");
  const Eigen::Vector2d pull(x + 40, y + 8);  // "Pull", beside "View"
  Drag(viewer, pull, pull);
  Release(viewer, pull);
  viewer.SetPanelsShown(false);
  const auto before = std::get<OrbitCamera>(viewer.view().view());
  Drag(viewer, {320, 240}, {320, 400}, mjBUTTON_RIGHT);  // the left one: a double click
  EXPECT_TRUE(viewer.view().holds());
  EXPECT_EQ(std::get<OrbitCamera>(viewer.view().view()).lookat, before.lookat);
  for (int i = 0; i < 150; ++i) viewer.Step();
  EXPECT_GT(scene_.body_pose("cube").translation().z(), 0.04);
}

// Many cameras with long names: more than a box of the panels holds.
TEST(NameChoice, ReachesEveryNameByThePage) {
  internal::NameChoice choice;
  std::vector<std::string> names;
  for (int i = 0; i < 60; ++i) names.push_back("left/wrist_camera_number_" + std::to_string(i));
  choice.all = [&] { return names; };
  choice.chosen = names[50];
  std::set<std::string> reached;
  do {
    choice.Choose();
    ASSERT_LE(choice.shown.size(), mjMAXUIMULTI);
    size_t letters = 0;
    for (const std::string& name : choice.shown) letters += name.size() + 1;
    EXPECT_LE(letters, mjMAXUITEXT);
    EXPECT_EQ(choice.shown[static_cast<size_t>(choice.index)], names[50]);
    reached.insert(choice.shown.begin(), choice.shown.end());
  } while (++choice.page < choice.pages);
  EXPECT_EQ(reached.size(), names.size());
  choice.index = 1;
  choice.TakeIndex();
  EXPECT_EQ(choice.chosen, choice.shown[1]);
  names.resize(3);
  choice.chosen = names[1];
  choice.Choose();
  EXPECT_EQ(choice.shown, names) << "in their order where all have room";
  EXPECT_EQ(choice.index, 1);
}

}  // namespace
}  // namespace robocell
