// EnvRecord: an episode of an environment, or a part of one, as it was acted and observed; and its
// replay, which says where the environment first does something else.
//
//   env.StartRecord();
//   ... env.Step(action) ...
//   const EnvRecord record = env.StopRecord();
//   const EnvReplay replay = ReplayRecord(env, record);
//   if (!replay.same()) LogWarn(replay.difference);
//   record.Save("episode.npy");  // for EnvRecord::Load, also in another process
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "robocell/env/env_state.h"

namespace robocell {

class Env;

struct EnvRecord {
  EnvState start = {};
  std::vector<double> actions = {};       // of each step, one after another
  std::vector<double> observations = {};  // at the start, and after each step
  std::vector<double> rewards = {};       // of each step

  int steps() const { return static_cast<int>(rewards.size()); }

  // A file that has the old record or the new one, never half: NumPy's .npy with one row of
  // float64, in which start, actions, observations and rewards each say first how many numbers
  // they have. IoError when it cannot be written or read, or is no record.
  void Save(const std::string& file) const;
  static EnvRecord Load(const std::string& file);
};

struct EnvReplay {
  int steps = 0;  // replayed, the one that differs included
  // "after step 3: robot.joints[2] is 0.31, recorded 0.3"; "" when all is as recorded.
  std::string difference = {};

  bool same() const { return difference.empty(); }
};

// Goes back to the start of the record and does the same again, until something is farther from
// what was recorded than `tolerance` (of each number of the observations, and the rewards). With 0
// it is the same to the bit or not; StateFrame::kRoot, for a rig that stands elsewhere, needs more.
// ArgumentError for a record of another configuration. `poll` as of Env::Step.
EnvReplay ReplayRecord(Env& env, const EnvRecord& record, StateFrame frame = StateFrame::kWorld,
                       double tolerance = 0, const std::function<void()>& poll = {});

}  // namespace robocell
