#include "robocell/mujoco/model_watch.h"

#include <mutex>
#include <unordered_map>
#include <utility>

namespace robocell {
namespace {

using Flag = std::atomic<bool>;

// State of the watched models. It lives as long as the process, because models may be freed at its
// end.
struct Watched {
  std::mutex mutex;
  std::unordered_map<const mjModel*, std::weak_ptr<Flag>> flags;
};

Watched& AllWatched() {
  static auto* watched = new Watched;
  return *watched;
}

}  // namespace

ModelWatch::ModelWatch(const mjModel* model) {
  Watched& watched = AllWatched();
  const std::lock_guard lock(watched.mutex);
  std::erase_if(watched.flags, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<Flag>& known = watched.flags[model];
  std::shared_ptr<Flag> flag = known.lock();
  if (!flag) known = flag = std::make_shared<Flag>(false);
  gone_ = std::move(flag);
}

void ModelEnds(const mjModel* model) noexcept {
  Watched& watched = AllWatched();
  const std::lock_guard lock(watched.mutex);
  const auto found = watched.flags.find(model);
  if (found == watched.flags.end()) return;
  if (const std::shared_ptr<Flag> flag = found->second.lock())
    flag->store(true, std::memory_order_release);
  watched.flags.erase(found);
}

}  // namespace robocell
