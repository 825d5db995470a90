#include "robocell/env/env_record.h"

#include <fmt/format.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/env.h"

namespace robocell {
namespace {

void RequireRecord(const Env& env, const EnvRecord& record) {
  const auto steps = static_cast<size_t>(record.steps());
  const auto action = static_cast<size_t>(env.layout().action.size());
  const auto seen = static_cast<size_t>(env.layout().observation.size());
  if (record.actions.size() == steps * action && record.observations.size() == (steps + 1) * seen)
    return;
  throw ArgumentError(
      fmt::format("environment '{}': a record of {} steps has {} x {} numbers of actions and {} x "
                  "{} of observations here, got {} and {}; it is of another configuration",
                  env.config().name, steps, steps, action, steps + 1, seen, record.actions.size(),
                  record.observations.size()));
}

// Writes the quaternion that is the same rotation and nearer to what was seen.
void AlignTquat(const VectorPart& tquat, std::span<const double> seen,
                std::vector<double>& recorded) {
  double dot = 0;
  for (int i = tquat.begin + 3; i < tquat.begin + 7; ++i) dot += seen[i] * recorded[i];
  for (int i = tquat.begin + 3; dot < 0 && i < tquat.begin + 7; ++i) recorded[i] = -recorded[i];
}

// The same for roll, pitch and yaw, by whole turns.
void AlignAngles(const VectorPart& xyzrpy, std::span<const double> seen,
                 std::vector<double>& recorded) {
  for (int i = xyzrpy.begin + 3; i < xyzrpy.begin + 6; ++i)
    recorded[i] += 2 * kPi * std::round((seen[i] - recorded[i]) / (2 * kPi));
}

// What was recorded, as near as the same poses can be written to what was seen.
std::vector<double> Aligned(const EnvLayout& layout, std::span<const double> seen,
                            std::span<const double> recorded) {
  std::vector<double> out(recorded.begin(), recorded.end());
  for (const RobotLayout& robot : layout.robots) {
    AlignTquat(robot.tquat, seen, out);
    AlignAngles(robot.xyzrpy, seen, out);
  }
  for (const ObjectLayout& object : layout.objects) AlignTquat(object.tquat, seen, out);
  return out;
}

// "" unless a number is farther than that from what was recorded.
std::string DifferenceOf(const Env& env, std::span<const double> row, double tolerance) {
  const std::span<const double> seen = env.observation();
  const std::vector<double> recorded = tolerance > 0 ? Aligned(env.layout(), seen, row)
                                                     : std::vector<double>(row.begin(), row.end());
  for (size_t i = 0; i < seen.size(); ++i) {
    if (std::abs(seen[i] - recorded[i]) <= tolerance) continue;
    return fmt::format("{} is {}, recorded {}",
                       NameOfObservation(env.layout(), static_cast<int>(i)), seen[i], recorded[i]);
  }
  return "";
}

}  // namespace

EnvReplay ReplayRecord(Env& env, const EnvRecord& record, StateFrame frame, double tolerance,
                       const std::function<void()>& poll) {
  RequireRecord(env, record);
  env.SetState(record.start, frame);
  const auto row = [](const std::vector<double>& all, int i, int size) {
    return std::span(all).subspan(static_cast<size_t>(i) * size, size);
  };
  const int seen = env.layout().observation.size(), action = env.layout().action.size();
  EnvReplay replay;
  std::string difference = DifferenceOf(env, row(record.observations, 0, seen), tolerance);
  if (!difference.empty()) replay.difference = "at the start: " + difference;
  while (replay.same() && replay.steps < record.steps()) {
    const int i = replay.steps++;
    const EnvStep step = env.Step(row(record.actions, i, action), poll);
    difference = DifferenceOf(env, row(record.observations, i + 1, seen), tolerance);
    if (step.reason == EndReason::kDiverged)
      difference = "the simulation diverged: " + step.message;
    if (difference.empty() && !(std::abs(step.reward - record.rewards[i]) <= tolerance))
      difference = fmt::format("the reward is {}, recorded {}", step.reward, record.rewards[i]);
    if (!difference.empty())
      replay.difference = fmt::format("after step {}: {}", replay.steps, difference);
  }
  return replay;
}

void Env::StartRecord() {
  RequireReady();
  if (record_) {
    throw Error(
        fmt::format("{}: it is being recorded already, {} steps by now; stop_record "
                    "(StopRecord) gives them",
                    place(), record_->steps()));
  }
  record_ = EnvRecord{.start = state(), .observations = observation_};
}

EnvRecord Env::StopRecord() {
  if (!record_)
    throw Error(place() +
                ": nothing is being recorded: start_record (StartRecord) begins it, and a reset or "
                "going back to a state drops it");
  EnvRecord record = std::move(*record_);
  record_.reset();
  return record;
}

void Env::Note(std::span<const double> action, double reward) {
  record_->actions.insert(record_->actions.end(), action.begin(), action.end());
  record_->observations.insert(record_->observations.end(), observation_.begin(),
                               observation_.end());
  record_->rewards.push_back(reward);
}

}  // namespace robocell
