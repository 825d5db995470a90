// Finding: what a check says about somebody's robot. One struct for all checks, so that whoever
// shows them (the command line, a log, a report) needs to know only this one.
#pragma once

#include <string>
#include <vector>

namespace robocell {

enum class Severity {
  kNote,     // good to know; needs no change
  kWarning,  // it works, and is probably not what was meant
};

struct Finding {
  std::string subject;  // "robot 'left'", "robot 'left' / camera 'wrist'"
  Severity severity = Severity::kWarning;
  std::string place;  // "arm.yaml:9:14" or "arm.xml:12"; "" when it stands in no file
  std::string text;   // what is found, why, and the next step
  std::string edit;   // the entry of the robot file's `edits` that mends it; "" when none does
};

// "arm.yaml:9:14: robot 'left': joint 'hip' may turn from ...".
std::string Line(const Finding& finding);
// The same without the subject, where only one robot is spoken of.
std::string LineWithoutSubject(const Finding& finding);

// The lines of all warnings, without the notes.
std::vector<std::string> WarningLines(const std::vector<Finding>& findings);

}  // namespace robocell
