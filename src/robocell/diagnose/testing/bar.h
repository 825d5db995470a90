// For tests only: a robot of one joint that gravity acts on.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {

// A horizontal bar on a hinge: gravity acts with 1 kg * g * 0.25 m = 2.45 N m.
class BarTrial : public ::testing::Test {
 protected:
  std::vector<std::string> Doubts(const std::string& servo, const std::string& fields = "",
                                  const std::string& rest = "", const std::string& joint = "") {
    const std::string model = folder_.Write(
        "bar", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.5"/><body name="bar"><joint name="hip" axis="0 1 0" range="-2 2" {}/>
<geom type="capsule" size="0.02" fromto="0.02 0 0 0.48 0 0" mass="1"/><site name="tip" pos="0.5 0 0"/>
</body>{}</body></worldbody><actuator><position name="drive" joint="hip" {}/></actuator>)",
                           joint, rest, servo));
    AtomicWrite(file_,
                "name: bar\nmodel: " + model +
                    "\nmove_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n" +
                    fields);
    return LinesOfRobot(RobotAlone(RobotConfig::Load(file_)));
  }

  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "bar.yaml").string();
};

}  // namespace robocell
