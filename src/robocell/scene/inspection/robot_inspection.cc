#include "robocell/scene/inspection/robot_inspection.h"

#include <string_view>

namespace robocell::internal {
namespace {

#define ROBOCELL_ADDRESS(function) &(function),
constexpr ModelCheck* kModelChecks[] = {ROBOCELL_MODEL_CHECKS(ROBOCELL_ADDRESS)};
#undef ROBOCELL_ADDRESS

}  // namespace

void InspectRobot(const CompiledRobot& robot, CompileLog& log) {
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

}  // namespace robocell::internal
