// Measures the time of an image, stage by stage. It is stopped until a test or a benchmark starts
// it. Internal to render/.
//
//   renderer.clock().Run();
//   renderer.Render(...);
//   const double ms = renderer.clock().milliseconds(SoftStage::kShading);
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace robocell::internal {

enum class SoftStage {
  kList,       // poses, and the engine's list of what is visible
  kScene,      // instances of the list, lights
  kTriangles,  // vertices, set-up and blocks, without samples
  kExact,      // depth and bodies
  kShadows,    // maps of the lights
  kShading,    // colours, and packing them where nothing follows
  kEdges,      // blocks that need samples
  kSamples,    // triangles in those blocks
  kSmoothing,  // their means
  kLayers,     // transparent surfaces, and packing
  kCount
};

inline constexpr std::array<const char*, static_cast<size_t>(SoftStage::kCount)> kSoftStageNames = {
    "list",    "scene", "triangles", "depth and bodies", "shadow maps",
    "shading", "edges", "samples",   "smoothing",        "layers and packing"};

class SoftClock {
 public:
  // Restarts.
  void Run() {
    seconds_.fill(0);
    runs_ = true;
  }

  void Begin() {
    if (runs_) last_ = Clock::now();
  }
  // Counts the time since the last call for this stage.
  void Mark(SoftStage stage) {
    if (!runs_) return;
    const Clock::time_point now = Clock::now();
    seconds_[static_cast<size_t>(stage)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

  // Sums over all images since Run.
  double milliseconds(SoftStage stage) const { return 1e3 * seconds_[static_cast<size_t>(stage)]; }

 private:
  using Clock = std::chrono::steady_clock;
  std::array<double, static_cast<size_t>(SoftStage::kCount)> seconds_{};
  bool runs_ = false;
  Clock::time_point last_;
};

}  // namespace robocell::internal
