// EnvBatch: copies of one environment that step together on threads. They share one frozen model,
// or have a copy of it each when objects vary (EnvConfig::variations). The assignment of copies to
// threads changes no result: each copy has its own state and its own seeds.
//
//   EnvBatch batch(config, 64);
//   batch.Reset(seeds);                                       // one for each copy, or none
//   const BatchStep& step = batch.Step(actions, resets);      // (64, n) numbers, row after row
//   batch.observations();                                     // (64, m) numbers, row after row
//   batch.Act({{"robots/left/action/arm", q}});               // by name: (64, 7) numbers
//   batch.Row().at("robots/left/arm/qpos");                   // by name: (64, 7) numbers
//
// Messages call the copies `name[i]`. One renderer draws their images, one copy after the other,
// when all have stepped: env(i).frames().
//
// Throws the errors of Env, and ArgumentError for more copies than fit into the machine's memory. A
// rejected action leaves all copies as they are; another error of a copy is rethrown after all have
// finished, the one of the lowest number. After such a step all copies need a reset: some have
// stepped, and their rewards are lost. Threads: one caller at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/env/env.h"

namespace robocell {

namespace internal {
struct SharedDrawing;
class WorkerThreads;
}  // namespace internal

struct BatchStep {
  std::vector<double> reward;
  std::vector<uint8_t> terminated;  // success
  std::vector<uint8_t> truncated;   // diverged, or too many steps
  std::vector<EnvStep> steps;
};

class EnvBatch {
 public:
  // Numbers by the names of columns in datasets: those of each copy, row after row.
  using RowsByName = std::map<std::string, std::vector<double>>;

  // `threads` 0: one for each core, including the caller's; never more than copies. Episodes are
  // truncated after `max_episode_steps`, if set; at least 1. Until it gets a seed, a copy draws its
  // own starts, the same ones each time. `factory` makes the data of their scenes.
  EnvBatch(const EnvConfig& config, int count, int threads = 0,
           std::optional<int> max_episode_steps = {}, const DataFactory& factory = {});
  ~EnvBatch();

  int size() const { return static_cast<int>(envs_.size()); }
  const EnvConfig& config() const { return config_; }
  const EnvLayout& layout() const { return envs_.front()->layout(); }
  Env& env(int i) { return *envs_[i]; }

  // Resets the copies for which `which` is true, all if it is empty. Seeds as for Env::Reset, one
  // for each copy; the keyframe is that of all. The next episodes of Step begin at home.
  void Reset(std::span<const std::optional<uint64_t>> seeds, const std::vector<bool>& which = {},
             const std::optional<KeyframeChoice>& keyframe = {});
  // Steps all copies except those for which `reset_instead` is true, which begin their next
  // episode: reward 0, neither terminated nor truncated. `poll` is called on the caller's thread,
  // often; its exception ends all copies' steps and is rethrown, and all copies need a reset.
  const BatchStep& Step(std::span<const double> actions,
                        const std::vector<bool>& reset_instead = {},
                        const std::function<void()>& poll = {});
  // The same with commands by the names of features().commanded() of the copies, as Env::Act has
  // them. Throws NotFoundError with the nearest names, and ArgumentError for rows of a wrong size.
  const BatchStep& Act(const RowsByName& commands, const std::vector<bool>& reset_instead = {},
                       const std::function<void()>& poll = {});
  std::span<const double> observations() const { return observations_; }
  // Returns the present state of all copies by the names of features().observed(), without images.
  // Throws Error if the copies have different features at present.
  RowsByName Row();
  // Returns the outcome of copy `i` in the last step; the default after its reset.
  const EnvStep& last_step(int i) const { return step_.steps[i]; }
  // Returns true if a motion led towards the last pose that was commanded to robot `robot` (of
  // layout().robots) of copy `i`.
  bool ik_success(int i, size_t robot) const;
  // Returns a colour picture of each copy's present state for viewing, one after another, each with
  // rows from the top. One renderer, created at the first call, draws all of them.
  std::vector<uint8_t> Draw(const CameraView& camera, int width, int height);
  // Returns the instruction of each copy's task, in words.
  std::vector<std::string> instructions() const;

  // Closes all copies' scenes and ends the threads: ClosedError from then on.
  void Close();
  void RequireOpen() const;

 private:
  void ForEach(const std::function<void(int)>& work);
  void ResetOne(int i, const EnvResetOptions& options);
  // Makes the step of a copy.
  using MakeStep = std::function<EnvStep(int i, const std::function<void()>& poll)>;
  void StepOne(int i, const MakeStep& make, const std::function<void()>& poll);
  // `require` throws for a copy whose step would be rejected.
  const BatchStep& StepAll(const std::vector<bool>& reset_instead,
                           const std::function<void(int)>& require, const MakeStep& make,
                           const std::function<void()>& poll);
  std::vector<RowsByName> CommandsOfCopies(const RowsByName& commands);
  void RequireSized(const char* call, size_t given, const char* what) const;
  void CopyObservation(int i);
  void DrawFrames();

  EnvConfig config_;
  std::optional<int> max_episode_steps_;
  std::vector<std::unique_ptr<Env>> envs_;
  std::vector<int> episode_steps_;
  std::vector<double> observations_;
  BatchStep step_;
  std::shared_ptr<internal::SharedDrawing> pictures_;
  std::unique_ptr<internal::WorkerThreads> workers_;
};

}  // namespace robocell
