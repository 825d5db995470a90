#include "robocell/diagnose/checks.h"

namespace robocell::internal {
namespace {

#define ROBOCELL_ADDRESS(function) &(function),
constexpr ModelCheck* kModelChecks[] = {ROBOCELL_MODEL_CHECKS(ROBOCELL_ADDRESS)};
constexpr RobotTrial* kRobotTrials[] = {ROBOCELL_ROBOT_TRIALS(ROBOCELL_ADDRESS)};
#undef ROBOCELL_ADDRESS

// The warnings of every compile of a scene.
void InspectCompiled(const CompiledRobot& robot, CompileLog& log) {
  Findings findings(robot.place(), [&](const std::string& subject, std::string_view field) {
    return log.SourceOf(subject, field);
  });
  for (ModelCheck* check : kModelChecks) check(robot, findings);
  for (const Finding& finding : findings.list()) {
    if (finding.severity == Severity::kNote)
      log.Note(finding.subject, finding.text);
    else
      log.WarnAt(finding.place, finding.subject, finding.text);
  }
}

// Scenes are compiled in a lower layer, which does not know this one.
[[maybe_unused]] const bool kInstalled = InstallRobotInspection(&InspectCompiled);

}  // namespace

std::span<ModelCheck* const> ModelChecks() { return kModelChecks; }
std::span<RobotTrial* const> RobotTrials() { return kRobotTrials; }

}  // namespace robocell::internal
