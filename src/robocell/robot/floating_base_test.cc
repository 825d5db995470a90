// Tests which floating bases are held by nothing.
#include "robocell/robot/floating_base.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/files.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class FloatingBase : public ::testing::Test {
 protected:
  // A box of `size` (half lengths, m) with a free joint at a height, with an arm of one joint.
  std::string Why(const std::string& size, double height, const std::string& fields = "",
                  const std::string& joint = "<freejoint name='root'/>") {
    const std::string model =
        folder_.Write("box", fmt::format(R"(<worldbody><body name="trunk" pos="0 0 {}">{}
      <geom type="box" size="{}" mass="5"/><body name="arm" pos="0 0 0.1"><joint name="hip" axis="0 1 0"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.2" mass="0.1" contype="0" conaffinity="0"/>
      <site name="tip" pos="0 0 0.2"/></body></body></worldbody>
      <actuator><position name="drive" joint="hip" kp="50" kv="5"/></actuator>)",
                                         height, joint, size));
    const std::string file = (folder_.path() / "box.yaml").string();
    AtomicWrite(file, "name: box\nmodel: " + model +
                          "\nmove_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n" +
                          fields);
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.config = RobotConfig::Load(file), .prefix = "b_"});
    const Scene scene = Scene::Build(spec);
    return WhyBaseFalls(scene, scene.compiled()->robots().front());
  }

  ModelFolder folder_;
};

TEST_F(FloatingBase, ThatFallsIsNamedWithTheHeight) {
  const std::string why = Why("0.1 0.1 0.1", 1);
  EXPECT_THAT(why, StartsWith("its base floats on the free joint of 'trunk' and falls 0.90 m"));
  EXPECT_THAT(why, HasSubstr("`edits: [{delete: {joint: 'root'}}]`"));
}

TEST_F(FloatingBase, ThatStandsIsFine) { EXPECT_EQ(Why("0.1 0.1 0.1", 0.1), ""); }

TEST_F(FloatingBase, ThatTipsOverIsNamedWithTheAngle) {
  // A board that stands on its edge, a little beside the point of balance.
  EXPECT_THAT(Why("0.3 0.1 0.005", 0.3, "edits: [{body: trunk, euler: [0, 1.45, 0]}]\n"),
              HasSubstr("'trunk' and "));
}

TEST_F(FloatingBase, AdviceFixesTheBase) {
  for (const std::string joint : {"<freejoint name='root'/>", "<freejoint/>"}) {
    const std::string why = Why("0.1 0.1 0.1", 1, "", joint);
    const size_t begin = why.find("`edits") + 1;
    const std::string edit = why.substr(begin, why.find('`', begin) - begin);
    EXPECT_EQ(Why("0.1 0.1 0.1", 1, edit + "\n", joint), "") << edit;
  }
}

}  // namespace
}  // namespace robocell::internal
