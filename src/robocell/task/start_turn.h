// StartTurn: the number of a start in its run. Tasks and samplers spread their choices by it, so that
// a short run has some of everything; random draws would leave gaps.
//
//   const std::string kind = turn().Choose({"box", "mug", "nut"});   // in Task::Prepare
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace robocell {

struct StartTurn {
  uint64_t seed = 0;  // the run's
  int scene = 0;      // index of the scene in the source
  int episode = 0;    // number of the episode in that scene
  // If set, becomes the largest number of options that took turns: after that many episodes each of
  // them has come.
  std::shared_ptr<size_t> longest = {};

  // Returns the option whose turn it is. Options take turns in a Latin square of scenes and
  // episodes: each of K comes once in any K episodes of a scene that start at a multiple of K, and
  // once in the same episode of K such scenes, however many of both a run has. Each square draws its
  // order anew: base placements take turns too, and with one order for all, each option would only be
  // seen from its own part of the range. Throws ArgumentError without options.
  std::string Choose(std::vector<std::string> options) const;
};

}  // namespace robocell
