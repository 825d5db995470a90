// Advice for a machine that has a graphics card but renders on the processor. It reads files and
// variables, and draws nothing.
//
//   const std::string text = GraphicsAdvice(DescribeGl(), ReadGraphicsFacts());
//   if (!text.empty()) LogWarn(text);
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace robocell {

// The graphics of a machine, from its files and the environment.
struct GraphicsFacts {
  std::vector<std::string> nvidia = {};      // /dev/nvidia0 ...
  std::vector<std::string> dri = {};         // /dev/dri/renderD128 ...
  std::vector<std::string> unreadable = {};  // those of the two that this user may not open
  bool nvidia_library = false;               // libEGL_nvidia.so.0 is installed
  bool nvidia_vendor_file = false;           // a file like 10_nvidia.json registers it with EGL
  bool container = false;
  // Variables; empty if not set.
  std::string vendor_files = {};         // __EGL_VENDOR_LIBRARY_FILENAMES
  std::string driver_capabilities = {};  // NVIDIA_DRIVER_CAPABILITIES
  std::string device_variable = {};      // "MUJOCO_EGL_DEVICE_ID=1", which chooses a device
  std::string gl_variable = {};          // "MUJOCO_GL=osmesa", which chooses a back end

  bool has_gpu() const { return !nvidia.empty() || !dri.empty(); }
};

// Reads the facts of this machine, with all files below `root`.
GraphicsFacts ReadGraphicsFacts(const std::string& root = "/");

// Returns "" if `description` (of DescribeGl, or "soft") is that of a graphics card, or if there is
// none.
// Otherwise returns a sentence with the present renderer, the idle card, and the next step.
std::string GraphicsAdvice(std::string_view description, const GraphicsFacts& facts);

}  // namespace robocell
