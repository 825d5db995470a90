// Edits: small changes to a robot's model while it is loaded.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/edit_values.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/tool_elements.h"

namespace robocell::internal {
namespace {

// One edit on one model.
class Editor {
 public:
  Editor(const Edit& edit, const List<AttachmentSpec>& tools, Part& part, std::string place,
         CompileLog& log)
      : edit_(edit),
        tools_(tools),
        part_(part),
        spec_(part.spec.get()),
        place_(std::move(place)),
        log_(log) {}

  void Apply() {
    if (edit_.remove) return Delete();
    if (edit_.add_site) return AddSite();
    if (edit_.add_camera) return AddCamera();
    if (edit_.add_sensor) return AddSensor();
    if (edit_.body) return Change(Find(*edit_.body, mjOBJ_BODY));
    if (edit_.site) return Change(Find(*edit_.site, mjOBJ_SITE));
    if (edit_.joint) return Change(Find(*edit_.joint, mjOBJ_JOINT));
    if (edit_.geom) return Change(Find(*edit_.geom, mjOBJ_GEOM));
    if (edit_.camera) return Change(Find(*edit_.camera, mjOBJ_CAMERA));
    if (edit_.actuator) return Change(FindActuator(*edit_.actuator));
  }

 private:
  mjsElement* Find(const ElementRef& ref, mjtObj kind) {
    if (!ref.body.empty()) return FindInBody(ref, kind);
    mjsElement* element = FindSpecElement(spec_, kind, ref.name);
    if (!element)
      Miss(NoSuchName("the model", KindName(kind), ref.name, SpecNames(spec_, kind)) +
           HowToReferToUnnamed(kind) + OfATool(ref.name));
    return element;
  }

  // Explains why a tool's element is not found; "" for other names.
  std::string OfATool(const std::string& name) const {
    const AttachmentSpec* tool = ToolOf(tools_, name);
    if (!tool) return "";
    return fmt::format(
        " Names with '{}' belong to the attached tool, and edits change the robot's own model: "
        "change {} instead{}",
        tool->prefix, tool->mjcf_path,
        edit_.add_site ? ". A TCP needs no site: set attachment_site and tcp_offset" : "");
  }

  // Returns " 9 geoms have no name; write for example {geom: {body: palm, index: 0}}"; "" if all
  // have names.
  std::string HowToReferToUnnamed(mjtObj kind) {
    std::vector<std::string> bodies;
    for (mjsElement* element : SpecElements(spec_, kind)) {
      mjsBody* body = SpecName(element).empty() ? mjs_getParent(element) : nullptr;
      if (body) bodies.push_back(SpecName(body->element));
    }
    return bodies.empty() ? "" : UnnamedHint(KindName(kind), bodies.size(), bodies.front());
  }

  mjsElement* FindInBody(const ElementRef& ref, mjtObj kind) {
    mjsBody* body = mjs_findBody(spec_, ref.body.c_str());
    if (!body)
      return Miss(NoSuchName("the model", "body", ref.body, SpecNames(spec_, mjOBJ_BODY)) +
                  OfATool(ref.body)),
             nullptr;
    const std::vector<mjsElement*> elements = BodyElements(body, kind);
    if (ref.index >= 0 && ref.index < static_cast<int>(elements.size())) return elements[ref.index];
    Miss(fmt::format("body '{}' has {} {}(s), so there is none with index {} (they count from 0)",
                     ref.body, elements.size(), KindName(kind), ref.index));
    return nullptr;
  }

  // Finds it by its name, or as the only one that acts on a joint, tendon, site or body.
  mjsElement* FindActuator(const ElementRef& ref) {
    if (!ref.kind || *ref.kind == ElementKind::kActuator) return Find(ref, mjOBJ_ACTUATOR);
    const mjtObj kind = EngineKind(*ref.kind);
    if (!Find(ref, kind)) return nullptr;
    std::vector<std::string> found;
    for (mjsElement* element : SpecElements(spec_, mjOBJ_ACTUATOR)) {
      const mjsActuator* actuator = mjs_asActuator(element);
      if (TargetKind(actuator->trntype) == kind && mjs_getString(actuator->target) == ref.name)
        found.push_back(SpecName(element));
    }
    if (found.size() == 1) return FindSpecElement(spec_, mjOBJ_ACTUATOR, found[0]);
    Miss(found.empty() ? fmt::format("no actuator acts on {}. Its actuators: {}", Describe(ref),
                                     ListNames(SpecNames(spec_, mjOBJ_ACTUATOR)))
                       : fmt::format("{} actuators act on {}; write which: {}", found.size(),
                                     Describe(ref), ListNames(found)));
    return nullptr;
  }

  void Miss(const std::string& message) { log_.Missing(place_, message); }

  void Delete() {
    const mjtObj kind = edit_.remove->kind ? EngineKind(*edit_.remove->kind) : mjOBJ_UNKNOWN;
    if (kind == mjOBJ_KEY) return DeleteKey(edit_.remove->name);
    mjsElement* element = Find(*edit_.remove, kind);
    if (element && Tried(place_, [&] { return mjs_delete(spec_, element); }) != 0) {
      log_.Problem(place_, mjs_getError(spec_));
    }
  }

  // The keyframes were read before the edits.
  void DeleteKey(const std::string& name) { part_.keys.Remove(name); }

  void AddSite() {
    mjsElement* body = Find(*edit_.body, mjOBJ_BODY);
    if (!body) return;
    mjsSite* site = mjs_addSite(mjs_asBody(body), nullptr);
    Named(site->element, *edit_.add_site);
  }

  void AddCamera() {
    mjsElement* body = Find(*edit_.body, mjOBJ_BODY);
    if (!body) return;
    mjsCamera* camera = mjs_addCamera(mjs_asBody(body), nullptr);
    Named(camera->element, *edit_.add_camera);
  }

  void AddSensor() {
    mjsElement* site = Find(*edit_.site, mjOBJ_SITE);
    if (!site) return;
    mjsSensor* sensor = mjs_addSensor(spec_);
    sensor->objtype = mjOBJ_SITE;
    mjs_setString(sensor->objname, SpecName(site).c_str());
    if (const auto type = SensorType(edit_.type.value_or(""))) sensor->type = *type;
    Named(sensor->element, *edit_.add_sensor);
  }

  std::optional<mjtSensor> SensorType(const std::string& name) {
    const std::vector<std::pair<std::string, mjtSensor>> types = {
        {"force", mjSENS_FORCE},
        {"torque", mjSENS_TORQUE},
        {"gyro", mjSENS_GYRO},
        {"accelerometer", mjSENS_ACCELEROMETER},
        {"velocimeter", mjSENS_VELOCIMETER}};
    std::vector<std::string> names;
    for (const auto& [known, type] : types) {
      if (known == name) return type;
      names.push_back(known);
    }
    log_.Problem(place_, NoSuchName("type", "sensor", name, names));
    return std::nullopt;
  }

  void Named(mjsElement* element, const std::string& name) {
    const mjtObj kind = element->elemtype;
    if (FindSpecElement(spec_, kind, name)) {
      Tried(place_, [&] { mjs_delete(spec_, element); });
      log_.Problem(place_, fmt::format("the model already has a {} '{}'", KindName(kind), name));
      return;
    }
    SetSpecName(element, name, place_);
    Change(element);
  }

  void Change(mjsElement* element) {
    if (!element) return;
    if (edit_.name) Rename(element, *edit_.name);
    SetEdited(edit_, element, place_, log_);
  }

  void Rename(mjsElement* element, const std::string& name) {
    part_.keys.Rename(element->elemtype, SpecName(element), name);
    SetSpecName(element, name, place_);
  }

  const Edit& edit_;
  const List<AttachmentSpec>& tools_;
  Part& part_;
  mjSpec* spec_;
  std::string place_;
  CompileLog& log_;
};

}  // namespace

void ApplyEdits(const RobotConfig& config, Part& robot, CompileLog& log) {
  for (size_t i = 0; i < config.edits.size(); ++i) {
    const std::string edit = fmt::format("edits[{}]", i);
    const std::string here = fmt::format("{} / {}", robot.place, edit);
    log.Locate(here, config.locations.Below(edit));
    Editor(config.edits[i], config.attachments, robot, here, log).Apply();
  }
}

}  // namespace robocell::internal
