#include "robocell/diagnose/check_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/diagnose/check_robot.h"
#include "robocell/spec/problems.h"

namespace robocell {
namespace {

constexpr int kLeastSide = 32;  // pixels

// Tries the run's robot in a scene of its own. It stands on a floor: a free base that falls carries
// nothing.
std::vector<Finding> TryRobotAlone(const RunConfig& run) {
  SceneSpec spec{.name = run.run,
                 .timestep = run.rates.timestep().value(),
                 .add_floor = true,
                 .add_skybox = false,
                 .options = run.options};
  const RobotConfig& config = run.robot.config;
  spec.robots.push_back(
      {.name = config.name, .config = config, .control_modes = config.used_modes()});
  return CheckRobot(Robot::Of(Scene::Build(spec), config.name),
                    {.beside_warnings = true, .for_run = true});
}

// An error of the trial becomes a problem of the robot.
void AddRobotWarnings(const RunConfig& run, std::vector<Finding>& warnings) {
  try {
    for (const Finding& finding : TryRobotAlone(run)) {
      if (finding.severity == Severity::kWarning) warnings.push_back(finding);
    }
  } catch (const IoError&) {
    throw;  // an error of the disk, not of the run
  } catch (const Error& error) {
    Problems problems(run.locations);
    problems.AddAt("robot", error.what());
    problems.Throw("run '" + run.run + "'");
  }
}

void AddSmallStreams(const RunConfig& run, std::vector<Finding>& warnings) {
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    const CameraConfig& stream = run.cameras.streams[i];
    const int width = run.cameras.width(stream), height = run.cameras.height(stream);
    if (std::min(width, height) >= kLeastSide) continue;
    warnings.push_back({.subject = fmt::format("cameras.streams[{}]", i),
                        .place = run.locations.At(fmt::format("cameras.streams[{}]", i)),
                        .text = fmt::format(
                            "images of '{}' have {} x {} pixels, on which next to nothing is seen; "
                            "`cameras.resolution` is [width, height] in pixels",
                            stream.name, width, height)});
  }
}

}  // namespace

std::vector<Finding> CheckRun(const RunConfig& run, const RunDemands& demands) {
  std::vector<Finding> warnings = ValidateRun(run, demands);
  if (demands.scripted_expert) AddRobotWarnings(run, warnings);
  AddSmallStreams(run, warnings);
  return warnings;
}

}  // namespace robocell
