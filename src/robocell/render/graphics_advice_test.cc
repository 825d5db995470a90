#include "robocell/render/graphics_advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kLlvmpipe = "egl: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5";
constexpr const char* kCard = "egl: NVIDIA H100 80GB HBM3/PCIe/SSE2, OpenGL 4.6.0 NVIDIA 550.54";

// A machine that exists as empty files.
class FakeMachine : public ::testing::Test {
 protected:
  void Add(const std::string& file) {
    const auto path = folder_ / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << "";
  }
  void AddDriver() {
    Add("dev/nvidia0");
    Add("usr/lib/x86_64-linux-gnu/libEGL_nvidia.so.0");
    Add("usr/share/glvnd/egl_vendor.d/10_nvidia.json");
  }
  GraphicsFacts Facts() { return ReadGraphicsFacts(folder_.path().string()); }
  std::string Advice(const char* description = kLlvmpipe) {
    return GraphicsAdvice(description, Facts());
  }

 private:
  TempDir folder_;
  const ScopedEnv vendors_{"__EGL_VENDOR_LIBRARY_FILENAMES", ""},
      capabilities_{"NVIDIA_DRIVER_CAPABILITIES", ""}, ours_{"ROBOCELL_EGL_DEVICE", ""},
      theirs_{"MUJOCO_EGL_DEVICE_ID", ""}, gl_{"ROBOCELL_GL", ""}, mujoco_gl_{"MUJOCO_GL", ""};
};

TEST_F(FakeMachine, WithoutAGraphicsCardGivesNoAdvice) {
  Add("dev/nvidiactl");
  Add("dev/dri/card0");  // a screen, which draws nothing
  EXPECT_FALSE(Facts().has_gpu());
  EXPECT_EQ(Advice(), "");
}

TEST_F(FakeMachine, AWorkingCardGivesNoAdvice) {
  AddDriver();
  EXPECT_EQ(Advice(kCard), "");
}

TEST_F(FakeMachine, WithoutOpenGlAdvisesToInstallIt) {
  EXPECT_EQ(Advice("soft"), "") << "no card";
  AddDriver();
  EXPECT_THAT(Advice("soft"), HasSubstr("images are drawn on the processor (soft), although this "
                                        "machine has a graphics card (/dev/nvidia0). OpenGL is "
                                        "missing. Install it: `sudo apt install libegl1`"));
}

TEST_F(FakeMachine, ListsItsCards) {
  for (const char* file : {"dev/nvidia1", "dev/nvidia0", "dev/nvidia-uvm", "dev/dri/renderD128"})
    Add(file);
  EXPECT_THAT(Facts().nvidia, ElementsAre("/dev/nvidia0", "/dev/nvidia1"));
  EXPECT_THAT(Facts().dri, ElementsAre("/dev/dri/renderD128"));
}

TEST_F(FakeMachine, ACardWithoutADriverNamesThePackages) {
  Add("dev/nvidia0");
  EXPECT_EQ(Advice(),
            "images are drawn on the processor (egl: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5),"
            " although this machine has a graphics card (/dev/nvidia0). The driver's EGL library "
            "libEGL_nvidia.so.0 is missing. Install it: `sudo apt install libegl-nvidia0` "
            "(Debian), `sudo apt install libnvidia-gl-<version of the driver>` (Ubuntu)");
}

TEST_F(FakeMachine, AContainerWithoutGraphicsExplainsHowToStartIt) {
  Add("dev/nvidia0");
  Add(".dockerenv");
  EXPECT_THAT(Advice(), HasSubstr("Start it with NVIDIA_DRIVER_CAPABILITIES=all (`docker run"));
  const ScopedEnv compute("NVIDIA_DRIVER_CAPABILITIES", "compute,utility");
  EXPECT_THAT(Advice(), HasSubstr("NVIDIA_DRIVER_CAPABILITIES=all, not compute,utility as now"));
}

TEST_F(FakeMachine, AMissingVendorFileIsShown) {
  Add("dev/nvidia0");
  Add("usr/lib/x86_64-linux-gnu/libEGL_nvidia.so.0");
  Add("usr/share/glvnd/egl_vendor.d/50_mesa.json");
  EXPECT_THAT(Advice(), HasSubstr("Write /usr/share/glvnd/egl_vendor.d/10_nvidia.json with the "
                                  "text {\"file_format_version\": \"1.0.0\", \"ICD\": "
                                  "{\"library_path\": \"libEGL_nvidia.so.0\"}}"));
}

TEST_F(FakeMachine, AVariableThatHidesTheDriverIsNamed) {
  AddDriver();
  const ScopedEnv mesa("__EGL_VENDOR_LIBRARY_FILENAMES", "/x/50_mesa.json");
  EXPECT_THAT(Advice(), HasSubstr("__EGL_VENDOR_LIBRARY_FILENAMES=/x/50_mesa.json hides the card's "
                                  "driver from EGL. Unset it"));
}

TEST_F(FakeMachine, AVariableThatChoosesSoftwareIsNamed) {
  AddDriver();
  const ScopedEnv device("MUJOCO_EGL_DEVICE_ID", "1");
  EXPECT_THAT(Advice(), HasSubstr("MUJOCO_EGL_DEVICE_ID=1 chooses a device that is software."));
  const ScopedEnv gl("MUJOCO_GL", "osmesa");
  EXPECT_THAT(Advice("osmesa: llvmpipe (LLVM 15.0.6, 256 bits)"),
              HasSubstr("MUJOCO_GL=osmesa selects OSMesa, which always draws on the processor."));
}

TEST_F(FakeMachine, ABrokenDriverPointsToNvidiaSmi) {
  AddDriver();
  EXPECT_THAT(Advice(), HasSubstr("See what `nvidia-smi` says"));
}

TEST_F(FakeMachine, AMesaCardNeedsItsDriver) {
  Add("dev/dri/renderD128");
  EXPECT_THAT(Advice(), HasSubstr("(/dev/dri/renderD128). Install the card's OpenGL driver: `sudo "
                                  "apt install libegl1 libegl-mesa0 libgl1-mesa-dri`"));
}

TEST(GraphicsFactsTest, AnInaccessibleCardNamesTheRequiredGroup) {
  const GraphicsFacts facts{.dri = {"/dev/dri/renderD128"}, .unreadable = {"/dev/dri/renderD128"}};
  EXPECT_THAT(
      GraphicsAdvice(kLlvmpipe, facts),
      HasSubstr("This user may not open /dev/dri/renderD128. Join the group that it belongs "
                "to: `sudo usermod -aG render,video $USER`"));
}

}  // namespace
}  // namespace robocell
