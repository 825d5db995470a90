// The order in which EGL devices are tried: graphics cards first, software last, and the variables
// that choose one. It decides from descriptions only and does not call EGL. Internal to render/.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace robocell {

struct EglDevice {
  std::string vendor = {};  // "NVIDIA", "Mesa Project"; may be empty
  bool software = false;    // it declares that it draws on the processor
  std::optional<int> cuda = {};
};

// The variables of the environment; empty where they are not set.
struct EglDeviceChoice {
  std::string robocell_device = {};  // ROBOCELL_EGL_DEVICE
  std::string mujoco_device = {};    // MUJOCO_EGL_DEVICE_ID
  std::string cuda_visible = {};     // CUDA_VISIBLE_DEVICES
  // ROBOCELL_EGL_TURN: the number of a worker among those of a run, which take the cards in turn.
  int turn = 0;

  static EglDeviceChoice FromEnvironment();
  bool operator==(const EglDeviceChoice&) const = default;
};

// Returns indices of the devices in the order in which they are tried. If a variable chooses a
// device, it is the only one.
//
// ROBOCELL_EGL_DEVICE counts the devices as EGL lists them. MUJOCO_EGL_DEVICE_ID has its meaning in
// MuJoCo 4.0: if the driver reports the CUDA number of each device, a position in
// CUDA_VISIBLE_DEVICES or a CUDA number, otherwise an index in EGL's list. Without a choice,
// devices in CUDA_VISIBLE_DEVICES come first, then other graphics cards, then software. The first
// ones are tried from the `turn`-th on: those in CUDA_VISIBLE_DEVICES, otherwise the cards of the
// first one's kind.
//
// Throws ArgumentError, with variable and devices, for a choice that is not a device number.
std::vector<size_t> OrderEglDevices(std::span<const EglDevice> devices,
                                    const EglDeviceChoice& choice);

// Returns the number of the card whose turn it is, for a process that does not list the devices:
// the same for two workers only if they draw on the same card. `cards`: on this machine.
int TurnAmongCards(const EglDeviceChoice& choice, size_t cards);

// Returns "device 0 (NVIDIA)".
std::string DescribeEglDevice(std::span<const EglDevice> devices, size_t index);

// Returns true if the renderer that OpenGL reports draws on the processor: "llvmpipe (LLVM 15.0.6,
// 256 bits)".
bool IsSoftwareRenderer(std::string_view renderer);

}  // namespace robocell
