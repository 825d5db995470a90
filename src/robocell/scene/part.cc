#include "robocell/scene/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <mujoco/mujoco.h>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/label_unnamed.h"
#include "robocell/scene/options.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/urdf_model.h"
#include "robocell/scene/validate_model_file.h"

namespace robocell::internal {
namespace {

std::vector<std::string> Names(const std::vector<mjsElement*>& elements) {
  std::vector<std::string> names;
  for (mjsElement* element : elements) {
    names.push_back(SpecName(element));
    if (names.back().empty()) names.back() = DescribeSpecElement(element);
  }
  return names;
}

// Returns the elements of a kind in the part's world except `except`.
std::vector<std::string> InWorld(const Part& part, mjtObj kind, mjsElement* except = nullptr) {
  std::vector<std::string> out;
  for (mjsElement* element : BodyElements(WorldBody(part.spec.get()), kind)) {
    if (element != except) out.push_back(DescribeSpecElement(element));
  }
  return out;
}

// The floors of the part's world, and its other geoms.
struct WorldGeoms {
  std::vector<std::string> floors, others;
};

WorldGeoms GeomsInWorld(const Part& part) {
  WorldGeoms geoms;
  for (mjsElement* element : BodyElements(WorldBody(part.spec.get()), mjOBJ_GEOM)) {
    const bool floor = mjs_asGeom(element)->type == mjGEOM_PLANE;
    (floor ? geoms.floors : geoms.others).push_back(DescribeSpecElement(element));
  }
  return geoms;
}

// The scene has its own floors and lights: leaving out those of a model is no loss.
void WarnLeftBehind(const Part& part, mjsBody* root, CompileLog& log) {
  const auto text = [&](const std::vector<std::string>& names) {
    return fmt::format("only {} of {} is attached; left out: {}",
                       DescribeSpecElement(root->element), part.file, ListNames(names));
  };
  const WorldGeoms geoms = GeomsInWorld(part);
  std::vector<std::string> left = InWorld(part, mjOBJ_BODY, root->element);
  left.insert(left.end(), geoms.others.begin(), geoms.others.end());
  for (const mjtObj kind : {mjOBJ_SITE, mjOBJ_CAMERA}) {
    for (std::string& element : InWorld(part, kind)) left.push_back(std::move(element));
  }
  if (!left.empty())
    log.Warn(part.place, text(left) + "; move the rest of the part into that body");
  const std::vector<std::string> lights = InWorld(part, mjOBJ_LIGHT);
  if (!lights.empty()) log.Note(part.place, text(lights) + "; the scene has its own");
  if (!geoms.floors.empty())
    log.Note(part.place,
             text(geoms.floors) + "; floors are the scene's (add_floor), nothing meets this one");
}

// A plane is infinite: below a robot it would be a second floor that moves with the robot.
void WarnPlanes(const Part& part, CompileLog& log) {
  if (part.field != "model" && part.field != "path") return;  // robots only
  for (mjsElement* element : SpecElements(part.spec.get(), mjOBJ_GEOM)) {
    const mjsGeom* geom = mjs_asGeom(element);
    const mjsBody* body = mjs_getParent(element);
    if (geom->type != mjGEOM_PLANE || !body || body == WorldBody(part.spec.get())) continue;
    if (geom->contype == 0 && geom->conaffinity == 0) continue;
    const std::string owner = SpecName(body->element), name = SpecName(element);
    log.Warn(part.place,
             fmt::format("{} of body '{}' is a plane without end: a second floor that goes where "
                         "the body goes. If it is only there to look at the robot alone: edits: "
                         "[{{delete: {{geom: {}}}}}]",
                         DescribeSpecElement(element), owner,
                         name.empty() ? fmt::format("{{body: {}, index: N}}", owner) : name));
  }
}

// Elements that refer to others, which the engine drops if those are not attached.
constexpr std::array kReferring = {mjOBJ_ACTUATOR, mjOBJ_SENSOR,  mjOBJ_TENDON,
                                   mjOBJ_EQUALITY, mjOBJ_EXCLUDE, mjOBJ_PAIR};

void WarnDropped(mjSpec* parent, const Part& part, mjtObj kind, size_t before,
                 const std::string& prefix, CompileLog& log) {
  const size_t wanted = SpecElements(part.spec.get(), kind).size();
  const size_t came = SpecElements(parent, kind).size() - before;
  if (came >= wanted) return;
  std::vector<std::string> lost;
  for (const std::string& name : SpecNames(part.spec.get(), kind)) {
    if (!FindSpecElement(parent, kind, prefix + name)) lost.push_back(name);
  }
  log.Warn(
      part.place,
      fmt::format("{} {}(s) of {} refer to elements that are not attached and are left out: {}",
                  wanted - came, KindName(kind), part.file,
                  lost.empty() ? "(unnamed)" : ListNames(lost)));
}

constexpr const char* kOneRoot =
    "only one can be placed: put them into one body in that file, or make a file of each";

}  // namespace

std::optional<std::string> FindModel(const std::string& name, const std::string& directory,
                                     const std::string& place, const std::string& field,
                                     CompileLog& log) {
  try {
    return assets::Resolve(name, directory);
  } catch (const NotFoundError& error) {
    log.Missing(place, error.what(), field);
  } catch (const ArgumentError& error) {
    log.Problem(place, error.what(), field);
  }
  return std::nullopt;
}

SpecPtr ParseModel(const std::string& file, const std::string& place, UrdfServos servos,
                   CompileLog& log) {
  if (!IsUrdf(file)) {
    RequireOnlyFiles(file);
    return ParseXmlFile(file);
  }
  const Urdf urdf = ReadUrdf(file);
  SpecPtr spec = MakeUrdfSpec(urdf);
  for (const std::string& note : urdf.notes) log.Warn(place, note);
  if (servos == UrdfServos::kAll) {
    for (const std::string& note : AddUrdfServos(urdf, spec.get())) log.Note(place, note);
  }
  return spec;
}

std::optional<Part> LoadPart(const std::string& name, const std::string& directory,
                             const std::string& place, const std::string& field,
                             const SimOptions& options, const std::string& root_label,
                             CompileLog& log, UrdfServos servos) {
  const auto file = FindModel(name, directory, place, field, log);
  if (!file) return std::nullopt;
  const size_t before = log.problem_count();
  Part part{place, field, *file, nullptr, {}};
  try {
    part.spec = ParseModel(*file, place, servos, log);
  } catch (const SpecError& error) {
    const std::string pointers = AdviceAboutPointers(*file);
    log.Problem(place, pointers.empty() ? error.what() : pointers, field);
    return std::nullopt;
  }
  if (!root_label.empty()) LabelUnnamed(part.spec.get(), root_label);
  ValidateActuatorTargets(part, log);
  ValidateHomeKeyLength(part, log);
  ValidateHomeKeyControls(part, log);
  if (log.problem_count() > before) return std::nullopt;
  part.keys = ReadKeys(part.spec.get(), place, field, *file);
  ValidatePresetSizes(part, log);
  part.other_keys = OtherKeys(part);
  DropKeys(part.spec.get());
  if (!MakeAssetPathsAbsolute(part.spec.get(), *file, place, field, log)) return std::nullopt;
  WarnOtherOptions(part.spec->option, options, place, log);
  DropGlobals(part.spec.get());
  return part;
}

mjsBody* ChooseRoot(const Part& part, const std::optional<std::string>& root_body,
                    CompileLog& log) {
  const std::vector<mjsElement*> roots = BodyElements(WorldBody(part.spec.get()), mjOBJ_BODY);
  mjsBody* root = nullptr;
  if (root_body && !root_body->empty()) {
    mjsBody* named = mjs_findBody(part.spec.get(), root_body->c_str());
    if (!named || *root_body == "world") {
      std::vector<std::string> names = SpecNames(part.spec.get(), mjOBJ_BODY);
      std::erase(names, "world");  // is the scene's
      log.Problem(part.place, NoSuchName("root_body", "body", *root_body, names), "root_body");
      return nullptr;
    }
    root = TopBody(named);
  } else if (roots.size() == 1) {
    root = mjs_asBody(roots[0]);
  } else {
    log.Problem(part.place,
                roots.empty()
                    ? part.file + " has no body to attach"
                    : fmt::format("{} has {} root bodies: {}; {}", part.file, roots.size(),
                                  ListNames(Names(roots)),
                                  root_body ? "say which one is the root_body" : kOneRoot),
                part.field);
    return nullptr;
  }
  WarnLeftBehind(part, root, log);
  WarnPlanes(part, log);
  return root;
}

void AttachPart(mjsBody* parent, const Part& part, mjsBody* root, const Pose& pose,
                const std::string& prefix, CompileLog& log) {
  mjSpec* spec = mjs_getSpec(parent->element);
  std::array<size_t, kReferring.size()> before{};
  for (size_t i = 0; i < kReferring.size(); ++i)
    before[i] = SpecElements(spec, kReferring[i]).size();
  if (prefix.empty()) MakeClassNamesUnique(part, spec);
  AttachBody(parent, root, pose, prefix, part.place);
  for (size_t i = 0; i < kReferring.size(); ++i)
    WarnDropped(spec, part, kReferring[i], before[i], prefix, log);
}

namespace {

namespace fs = std::filesystem;

// Returns the values of an attribute in XML text, wherever it stands.
std::set<std::string> AttributeValues(const std::string& xml, const std::string& attribute) {
  std::set<std::string> values;
  for (size_t at = xml.find(attribute); at != std::string::npos; at = xml.find(attribute, at + 1)) {
    const size_t open = xml.find_first_of("\"'", at);
    if (open == std::string::npos) break;
    const size_t close = xml.find(xml[open], open + 1);
    if (close == std::string::npos) break;
    values.insert(xml.substr(open + 1, close - open - 1));
  }
  return values;
}

std::string ReadText(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Collects candidates for names of default classes. The engine has no list of a spec's classes, so
// they are read from the text of the file and of its includes; extra words do no harm.
void CollectClassNames(const fs::path& file, std::set<fs::path>& seen,
                       std::set<std::string>& names) {
  if (!seen.insert(file).second) return;
  const std::string xml = ReadText(file);
  names.merge(AttributeValues(xml, "class="));
  if (xml.find("<include") == std::string::npos) return;
  for (const std::string& included : AttributeValues(xml, "file=")) {
    const fs::path path = file.parent_path() / included;
    if (path.extension() == ".xml") CollectClassNames(path, seen, names);
  }
}

std::string FreeName(const std::string& name, const mjSpec* part, const mjSpec* parent) {
  for (int i = 2;; ++i) {
    const std::string candidate = name + "_" + std::to_string(i);
    if (!mjs_findDefault(part, candidate.c_str()) && !mjs_findDefault(parent, candidate.c_str()))
      return candidate;
  }
}

// Bodies and frames name the default class of their contents.
void RenameChildClass(mjSpec* spec, const std::string& from, const std::string& to) {
  for (mjsElement* e : SpecElements(spec, mjOBJ_BODY)) {
    mjString* name = mjs_asBody(e)->childclass;
    if (mjs_getString(name) == from) mjs_setString(name, to.c_str());
  }
  for (mjsElement* e : SpecElements(spec, mjOBJ_FRAME)) {
    mjString* name = mjs_asFrame(e)->childclass;
    if (mjs_getString(name) == from) mjs_setString(name, to.c_str());
  }
}

}  // namespace

void MakeClassNamesUnique(const Part& part, const mjSpec* parent) {
  if (part.file.empty()) return;
  std::set<fs::path> seen;
  std::set<std::string> names;
  CollectClassNames(part.file, seen, names);
  mjSpec* spec = part.spec.get();
  for (const std::string& name : names) {
    mjsDefault* own = name == "main" ? nullptr : mjs_findDefault(spec, name.c_str());
    if (!own || !mjs_findDefault(parent, name.c_str())) continue;
    const std::string fresh = FreeName(name, spec, parent);
    SetSpecName(own->element, fresh, part.place);
    RenameChildClass(spec, name, fresh);
  }
}

}  // namespace robocell::internal
