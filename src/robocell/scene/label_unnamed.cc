#include "robocell/scene/label_unnamed.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <map>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

constexpr mjtObj kOfBodies[] = {mjOBJ_JOINT, mjOBJ_SITE, mjOBJ_BODY};
constexpr const char* kJointMark = ":joint";

// Makes a name longer that is already taken.
void Label(mjSpec* spec, mjsElement* element, std::string label) {
  if (!SpecName(element).empty()) return;
  while (FindSpecElement(spec, element->elemtype, label)) label += '_';
  SetSpecName(element, label, "labelling what has no name");
}

void LabelBelow(mjSpec* spec, mjsBody* body) {
  const std::string name = SpecName(body->element);
  for (const mjtObj kind : kOfBodies) {
    int index = 0;
    for (mjsElement* element : BodyElements(body, kind))
      Label(spec, element, fmt::format("{}:{}{}", name, KindName(kind), index++));
  }
  for (mjsElement* child : BodyElements(body, mjOBJ_BODY)) LabelBelow(spec, mjs_asBody(child));
}

void LabelRoots(mjSpec* spec, const std::string& root) {
  int index = 0;
  for (mjsElement* body : BodyElements(WorldBody(spec), mjOBJ_BODY)) {
    Label(spec, body, index == 0 ? root : fmt::format("{}{}", root, index));
    ++index;
  }
}

void LabelActuators(mjSpec* spec) {
  std::map<std::string, int> seen;  // counts by target
  for (mjsElement* element : SpecElements(spec, mjOBJ_ACTUATOR)) {
    const std::string target = mjs_getString(mjs_asActuator(element)->target);
    const int index = seen[target]++;
    Label(spec, element, fmt::format("{}:actuator{}", target, index));
  }
}

}  // namespace

void LabelUnnamed(mjSpec* spec, const std::string& root) {
  LabelRoots(spec, root);
  LabelBelow(spec, WorldBody(spec));
  LabelActuators(spec);
}

std::string HowToNameJoint(const std::string& label) {
  const size_t mark = label.rfind(kJointMark);
  if (mark == std::string::npos) return "";
  const std::string index = label.substr(mark + std::string(kJointMark).size());
  if (index.empty() || index.find_first_not_of("0123456789") != std::string::npos) return "";
  return fmt::format(
      " ('{}' has no name in the model; to give it one: edits: [{{joint: {{body: {}, index: {}}}, "
      "name: NAME}}])",
      label, label.substr(0, mark), index);
}

}  // namespace robocell::internal
