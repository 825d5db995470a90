#include "robocell/scene/inspection/finding.h"

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

}  // namespace robocell
