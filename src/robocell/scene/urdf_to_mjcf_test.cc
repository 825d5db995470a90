// Tests that the MJCF of a URDF is the same model.
#include "robocell/scene/urdf_to_mjcf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/testing/urdf_texts.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using UrdfConversion = internal::UrdfTexts;

TEST_F(UrdfConversion, ConvertedTextIsTheSameModel) {
  std::vector<std::string> notes;
  const std::filesystem::path out = folder_.path() / "out";
  std::filesystem::create_directories(out);
  const std::string text = UrdfToMjcf(Write(Arm()), out, &notes);
  EXPECT_THAT(notes, Contains(HasSubstr("position servos")));
  AtomicWrite(out / "arm.xml", text);
  const ModelPtr back = Compile(ParseXmlFile(out / "arm.xml").get());
  const ModelPtr model = Model(Arm());
  EXPECT_EQ(back->nbody, model->nbody);
  EXPECT_EQ(back->nactuator, 2);
  for (int i = 0; i < 3 * model->nbody; ++i)
    EXPECT_NEAR(back->body_inertia[i], model->body_inertia[i], 1e-5);
}

}  // namespace
}  // namespace robocell
