#include "robocell/mujoco/model_watch.h"

#include <mutex>
#include <unordered_map>
#include <utility>

namespace robocell {
namespace {

using State = ModelWatch::State;

// State of the watched models. It lives as long as the process, because models may be freed at its
// end.
struct Watched {
  std::mutex mutex;
  std::unordered_map<const mjModel*, std::weak_ptr<State>> states;
};

Watched& AllWatched() {
  static auto* watched = new Watched;
  return *watched;
}

}  // namespace

ModelWatch::ModelWatch(const mjModel* model) {
  Watched& watched = AllWatched();
  const std::lock_guard lock(watched.mutex);
  std::erase_if(watched.states, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<State>& known = watched.states[model];
  std::shared_ptr<State> state = known.lock();
  if (!state) known = state = std::make_shared<State>();
  state_ = std::move(state);
}

void ModelEnds(const mjModel* model) noexcept {
  Watched& watched = AllWatched();
  const std::lock_guard lock(watched.mutex);
  const auto found = watched.states.find(model);
  if (found == watched.states.end()) return;
  if (const std::shared_ptr<State> state = found->second.lock())
    state->gone.store(true, std::memory_order_release);
  watched.states.erase(found);
}

void TexturesChange(const mjModel* model) noexcept {
  Watched& watched = AllWatched();
  const std::lock_guard lock(watched.mutex);
  const auto found = watched.states.find(model);
  if (found == watched.states.end()) return;
  if (const std::shared_ptr<State> state = found->second.lock())
    state->textures.fetch_add(1, std::memory_order_release);
}

}  // namespace robocell
