// ModelWatch: detects whether a borrowed model still exists. Its address and the engine's signature
// are not enough: a model that is compiled later may have both of a freed one.
//
// It also tells that textures were written to the model, which renderers have copies of.
//
//   const ModelWatch watch(model);
//   ... a scene may be built anew ...
//   if (watch.gone()) throw ArgumentError("call SetModel");   // nothing of the model is read
//
// A model is gone once its ModelPtr (mujoco/owners.h) or its scene (scene/compiled_scene.h) has
// ended; one that has neither is never gone. Any thread may use it, but no watch protects against a
// model that is freed while another thread still uses it.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "robocell/mujoco/forward.h"

namespace robocell {

class ModelWatch {
 public:
  ModelWatch() = default;  // watches no model
  explicit ModelWatch(const mjModel* model);

  bool gone() const { return state_ && state_->gone.load(std::memory_order_acquire); }
  // Returns a number that grows with each change of textures.
  uint64_t textures() const {
    return state_ ? state_->textures.load(std::memory_order_acquire) : 0;
  }

  struct State {
    std::atomic<bool> gone = false;
    std::atomic<uint64_t> textures = 0;
  };

 private:
  std::shared_ptr<const State> state_;
};

// Notifies the watches of a model. Its owners call this before they free it.
void ModelEnds(const mjModel* model) noexcept;

// Notifies the watches of a model that its textures, or which textures its materials have, were
// changed: renderers read them again before the next image.
void TexturesChange(const mjModel* model) noexcept;

}  // namespace robocell
