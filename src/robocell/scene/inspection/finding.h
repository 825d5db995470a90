// Finding: the result of a check of a robot. All checks use one struct, so that code that shows
// them (the command line, a log, a report) only needs this one.
#pragma once

#include <string>
#include <vector>

namespace robocell {

enum class Severity {
  kNote,     // a remark that needs no change
  kWarning,  // valid, but probably unintended
};

struct Finding {
  std::string subject;  // "robot 'left'", "robot 'left' / camera 'wrist'"
  Severity severity = Severity::kWarning;
  std::string place;  // "arm.yaml:9:14" or "arm.xml:12"; "" if it is in no file
  std::string text;   // the finding, its reason, and the next step
  std::string edit;   // the entry of the robot file's `edits` that fixes it; "" if there is none
};

// Returns "arm.yaml:9:14: robot 'left': joint 'hip' may turn from ...".
std::string Line(const Finding& finding);
// Returns the same without the subject, for texts about a single robot.
std::string LineWithoutSubject(const Finding& finding);

}  // namespace robocell
