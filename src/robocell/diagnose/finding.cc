#include "robocell/diagnose/finding.h"

namespace robocell {
namespace {

std::string After(const std::string& begin, const std::string& rest) {
  return begin.empty() ? rest : begin + ": " + rest;
}

}  // namespace

std::string Line(const Finding& finding) {
  return After(finding.place, After(finding.subject, finding.text));
}

std::string LineWithoutSubject(const Finding& finding) {
  return After(finding.place, finding.text);
}

std::vector<std::string> WarningLines(const std::vector<Finding>& findings) {
  std::vector<std::string> lines;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::kWarning) lines.push_back(Line(finding));
  }
  return lines;
}

}  // namespace robocell
