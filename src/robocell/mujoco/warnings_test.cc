#include "robocell/mujoco/warnings.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <limits>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/step.h"

namespace robocell {
namespace {

TEST(EngineWarnings, AreCountedAndReadable) {
  const internal::WarningCapture quiet;
  const ModelPtr model = Compile(ParseXmlString(R"(<mujoco>
      <worldbody><body><joint name="elbow"/><geom size=".1"/></body></worldbody>
      <actuator><motor joint="elbow"/></actuator>
    </mujoco>)")
                                     .get());
  const DataPtr data = MakeData(model.get());
  const EngineWarnings before = ReadWarnings(data.get());
  data->ctrl[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(Step(model.get(), data.get(), 3).ok());
  const EngineWarnings raised = ReadWarnings(data.get()) - before;
  EXPECT_EQ(raised.count(mjWARN_BADCTRL), 3);
  EXPECT_EQ(raised.total(), 3);
  EXPECT_EQ(raised.Text(), "3 x bad number in ctrl");
  EXPECT_STREQ(WarningName(mjWARN_BADCTRL), "bad_ctrl");
  EXPECT_EQ(EngineWarnings{}.Text(), "");
}

}  // namespace
}  // namespace robocell
