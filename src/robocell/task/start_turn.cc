#include "robocell/task/start_turn.h"

#include <algorithm>
#include <cstddef>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"

namespace robocell {

std::string StartTurn::Choose(std::vector<std::string> options) const {
  if (options.empty())
    throw ArgumentError("no option can take its turn among none; give at least one");
  const size_t count = options.size();
  if (longest) *longest = std::max(*longest, count);
  const auto scene_number = static_cast<size_t>(scene);
  const auto episode_number = static_cast<size_t>(episode);
  Rng rng = Rng::Stream(seed, "kinds of a square", scene_number / count, episode_number / count);
  rng.Shuffle(options);
  return options[(scene_number % count + episode_number % count) % count];
}

}  // namespace robocell
