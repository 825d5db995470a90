// EnvBatch: copies of one environment on one frozen model, or on a copy of it each when objects
// vary (EnvConfig::variations), stepped together on threads. Which thread steps which copy changes
// nothing: each has its own state and its own seeds.
//
//   EnvBatch batch(config, 64);
//   batch.Reset(seeds);                                       // one for each copy, or none
//   const BatchStep& step = batch.Step(actions, resets);      // (64, n) numbers, row after row
//   batch.observations();                                     // (64, m) numbers, row after row
//
// Copies are called `name[i]` in messages. Their images are drawn by one renderer, one copy after
// the other, when all have stepped: env(i).frames().
//
// Errors: those of Env; ArgumentError for more copies than the machine has memory for. An action
// that is refused leaves all copies as they are; what else one copy throws comes out after all have
// finished, the first by its number. After a step that failed so, all copies want a reset: some
// have stepped, and what they were rewarded with is lost. Threads: one caller at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/env/env.h"

namespace robocell {

namespace internal {
class WorkerThreads;
}

struct BatchStep {
  std::vector<double> reward;
  std::vector<uint8_t> terminated;  // success
  std::vector<uint8_t> truncated;   // diverged, or too many steps
  std::vector<EnvStep> steps;
};

class EnvBatch {
 public:
  // `threads` 0: as many as the machine has cores, the caller's included; never more than copies.
  // Episodes are truncated after `max_episode_steps`, if any; at least 1. Until it is given a seed,
  // a copy has starts of its own, the same ones each time.
  EnvBatch(const EnvConfig& config, int count, int threads = 0,
           std::optional<int> max_episode_steps = {});
  ~EnvBatch();

  int size() const { return static_cast<int>(envs_.size()); }
  const EnvConfig& config() const { return config_; }
  const EnvLayout& layout() const { return envs_.front()->layout(); }
  Env& env(int i) { return *envs_[i]; }

  // Resets the copies that `which` is true for, all when it is empty. Seeds as of Env::Reset, one
  // for each copy.
  void Reset(std::span<const std::optional<uint64_t>> seeds, const std::vector<bool>& which = {});
  // Steps all copies but those that `reset_instead` is true for, which begin their next episode:
  // reward 0, neither terminated nor truncated.
  // `poll` is called on the caller's thread, often; what it throws ends all copies' steps and comes
  // out, and all copies want a reset.
  const BatchStep& Step(std::span<const double> actions,
                        const std::vector<bool>& reset_instead = {},
                        const std::function<void()>& poll = {});
  std::span<const double> observations() const { return observations_; }
  // Whether a motion led towards the last pose that was commanded to robot `robot` (of
  // layout().robots) of copy `i`.
  bool ik_success(int i, size_t robot) const;
  // A colour picture of each copy's present state, one after another, each of rows from the top:
  // for people. All are drawn by one renderer, which is made at the first call.
  std::vector<uint8_t> Draw(const CameraView& camera, int width, int height);
  // The instruction of each copy's task, in words.
  std::vector<std::string> instructions() const;

  // Closes all copies' scenes and ends the threads: ClosedError from then on.
  void Close();
  void RequireOpen() const;

 private:
  void ForEach(const std::function<void(int)>& work);
  void ResetOne(int i, std::optional<uint64_t> seed);
  void StepOne(int i, std::span<const double> action, const std::function<void()>& poll);
  void CopyObservation(int i);
  void DrawFrames();

  EnvConfig config_;
  std::optional<int> max_episode_steps_;
  std::vector<std::unique_ptr<Env>> envs_;
  std::vector<int> episode_steps_;
  std::vector<double> observations_;
  BatchStep step_;
  std::shared_ptr<SharedDrawing> pictures_;
  std::unique_ptr<internal::WorkerThreads> workers_;
};

}  // namespace robocell
