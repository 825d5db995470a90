#include "robocell/viewer/panels.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace robocell
