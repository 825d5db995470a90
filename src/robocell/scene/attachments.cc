// Mounts tools on a robot's own model.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/placement.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

// The tool brings those of its mounted body of these kinds, and all of the other kinds.
constexpr mjtObj kInBodies[] = {mjOBJ_BODY, mjOBJ_JOINT,  mjOBJ_GEOM,
                                mjOBJ_SITE, mjOBJ_CAMERA, mjOBJ_LIGHT};
constexpr mjtObj kInModels[] = {mjOBJ_MESH,     mjOBJ_HFIELD,   mjOBJ_SKIN,
                                mjOBJ_TEXTURE,  mjOBJ_MATERIAL, mjOBJ_TENDON,
                                mjOBJ_EQUALITY, mjOBJ_ACTUATOR, mjOBJ_SENSOR};

std::vector<mjsElement*> Mounted(mjsBody* root) {
  std::vector<mjsElement*> elements = {root->element};
  const auto add = [&](const std::vector<mjsElement*>& more) {
    elements.insert(elements.end(), more.begin(), more.end());
  };
  for (const mjtObj kind : kInBodies) add(BodyElements(root, kind, true));
  for (const mjtObj kind : kInModels) add(SpecElements(mjs_getSpec(root->element), kind));
  return elements;
}

// The engine requires unique names. Its own message names the first element and no file, and for
// some kinds comes only after compiling. Returns false if a name was reported.
bool ValidateNamesAreNew(const AttachmentSpec& attachment, const Part& tool, mjsBody* root,
                         const Part& robot, CompileLog& log) {
  std::vector<std::string> both;
  std::string first;
  for (mjsElement* element : Mounted(root)) {
    const std::string own = SpecName(element), name = attachment.prefix + own;
    if (own.empty() || !FindSpecElement(robot.spec.get(), element->elemtype, name)) continue;
    if (both.empty()) first = name;
    both.push_back(fmt::format("{} '{}'", KindName(element->elemtype), name));
  }
  if (both.empty()) return true;
  const std::string advice =
      attachment.prefix.empty()
          ? "set the attachment's `prefix`, which its names begin with then"
          : fmt::format("give the attachment another `prefix` than '{}'", attachment.prefix);
  log.Problem(
      tool.place,
      fmt::format("{} would come from {} and {} in {} already; {}", ListNames(both, 3), tool.file,
                  both.size() == 1 ? "is" : "are", FileWith(robot, first), advice),
      "prefix");
  return false;
}

void AddExclusions(const AttachmentSpec& attachment, const std::string& place, Part& robot,
                   CompileLog& log) {
  mjSpec* spec = robot.spec.get();
  for (const auto& pair : attachment.contact_exclusions) {
    bool known = true;
    for (const std::string& body : pair) {
      if (mjs_findBody(spec, body.c_str())) continue;
      log.Missing(place,
                  "contact_exclusions: " +
                      NoSuchName("the robot", "body", body, SpecNames(spec, mjOBJ_BODY)),
                  "contact_exclusions");
      known = false;
    }
    if (!known) continue;
    mjsExclude* exclude = mjs_addExclude(spec);
    mjs_setString(exclude->bodyname1, pair[0].c_str());
    mjs_setString(exclude->bodyname2, pair[1].c_str());
  }
}

// A mounted tool moves with the robot, although its model's file lets it fall.
void LeaveOutFreeJoint(const Part& tool, mjsBody* root, CompileLog& log) {
  mjsElement* joint = FreeJointOf(root);
  if (!joint) return;
  Tried(tool.place, [&] { mjs_delete(tool.spec.get(), joint); });
  log.Note(tool.place, fmt::format("the free joint of '{}' is left out: it is mounted here",
                                   SpecName(root->element)));
}

void AddAttachment(const AttachmentSpec& attachment, const std::string& directory,
                   const std::string& place, Part& robot, const SceneSpec& scene, CompileLog& log) {
  const std::string root_label = std::filesystem::path(attachment.mjcf_path).stem().string();
  const auto loaded = LoadPart(attachment.mjcf_path, directory, place, "mjcf_path", scene.options,
                               root_label, log, UrdfServos::kAll);
  if (!loaded) return;
  const Part& tool = *loaded;
  mjsBody* root = ChooseRoot(tool, std::nullopt, log);
  if (!root) return;
  const auto at =
      Place(attachment.attach_to, attachment.pose(), robot.spec.get(), scene, {}, place, log);
  if (!at) return;
  if (!ValidateNamesAreNew(attachment, tool, root, robot, log)) return;
  LeaveOutFreeJoint(tool, root, log);
  const Pose authored = attachment.reset_root_pose ? Pose() : PoseInParent(root->element);
  AttachPart(at->parent, tool, root, at->pose * authored, attachment.prefix, log);
  robot.keys.Merge(tool.keys, attachment.prefix);
  robot.tools.push_back({attachment.prefix, tool.file});
  AddExclusions(attachment, place, robot, log);
}

}  // namespace

void AddAttachments(const List<AttachmentSpec>& attachments, const Locations& locations,
                    const std::string& directory, Part& robot, const SceneSpec& scene,
                    CompileLog& log) {
  for (size_t i = 0; i < attachments.size(); ++i) {
    const AttachmentSpec& attachment = attachments[i];
    const std::string& name = attachment.prefix.empty() ? attachment.mjcf_path : attachment.prefix;
    const std::string place = robot.place + " / attachment '" + name + "'";
    log.Locate(place, locations.Below(fmt::format("attachments[{}]", i)));
    AddAttachment(attachment, directory, place, robot, scene, log);
  }
}

}  // namespace robocell::internal
