#include "robocell/scene/compile_problem.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

// The kinds that the engine's compiler names in its messages.
constexpr mjtObj kKinds[] = {mjOBJ_BODY,     mjOBJ_JOINT,  mjOBJ_GEOM,     mjOBJ_SITE,
                             mjOBJ_CAMERA,   mjOBJ_LIGHT,  mjOBJ_MESH,     mjOBJ_TEXTURE,
                             mjOBJ_MATERIAL, mjOBJ_TENDON, mjOBJ_EQUALITY, mjOBJ_ACTUATOR,
                             mjOBJ_SENSOR};

// Returns the text between two texts; "" if one of them is missing.
std::string Between(std::string_view text, std::string_view before, std::string_view after) {
  const size_t begin = text.find(before);
  if (begin == std::string_view::npos) return "";
  const size_t end = text.find(after, begin + before.size());
  if (end == std::string_view::npos) return "";
  return std::string(text.substr(begin + before.size(), end - begin - before.size()));
}

// Returns the number at the beginning of a text.
std::string Digits(const std::string& text) {
  return text.substr(0, text.find_first_not_of("0123456789"));
}

// Returns the file of the part's named element; "" if it may be one of several.
std::string FileOf(const Part& part, const std::string& name) {
  const Part::Tool* of = nullptr;
  for (const Part::Tool& tool : part.tools) {
    if (tool.prefix.empty()) return "";
    if (name.starts_with(tool.prefix) && (!of || of->prefix.size() < tool.prefix.size()))
      of = &tool;
  }
  return of ? of->file : part.file;
}

// Returns a file of the part for messages; several where FileOf returned "".
std::string Shown(const Part& part, const std::string& file) {
  return file.empty() ? part.file + " or a tool of it" : file;
}

// Returns "arm.xml:12: "; lines count where the file is known.
std::string PlaceOf(const Part& part, const std::string& file, const std::string& line) {
  if (part.file.empty()) return "";  // a primitive without a file
  if (file.empty()) return Shown(part, file) + ": ";
  return line.empty() || line == "0" ? file + ": " : file + ":" + line + ": ";
}

// Returns "line 12", as the engine stores it when it reads an element.
std::string LineOf(mjsElement* element) {
  const mjString* info = element->elemtype == mjOBJ_JOINT      ? mjs_asJoint(element)->info
                         : element->elemtype == mjOBJ_ACTUATOR ? mjs_asActuator(element)->info
                                                               : nullptr;
  return info ? Digits(Between(mjs_getString(info) + std::string("\n"), "line ", "\n")) : "";
}

// Returns the engine's message for the part alone; "" if it compiles.
std::string ProblemAlone(const Part& part) {
  try {
    Compile(part.spec.get());
  } catch (const SpecError& error) {
    return error.what();
  }
  return "";
}

// "mesh 'foo' not found in geom 8": an asset that an element refers to and the model lacks.
struct MissingAsset {
  mjtObj kind = mjOBJ_UNKNOWN;
  std::string name;
};

std::optional<MissingAsset> FindMissingAsset(const std::string& text) {
  for (const mjtObj kind : {mjOBJ_MESH, mjOBJ_MATERIAL, mjOBJ_TEXTURE, mjOBJ_HFIELD}) {
    const std::string name =
        Between(text, fmt::format("Error: {} '", KindName(kind)), "' not found in ");
    if (!name.empty()) return MissingAsset{kind, name};
  }
  return std::nullopt;
}

// Returns true if an element refers to the asset.
bool Wants(mjsElement* element, const MissingAsset& asset) {
  std::vector<const mjString*> names;
  const bool material = asset.kind == mjOBJ_MATERIAL;
  switch (element->elemtype) {
    case mjOBJ_GEOM: {
      const mjsGeom* geom = mjs_asGeom(element);
      names = {material                     ? geom->material
               : asset.kind == mjOBJ_HFIELD ? geom->hfieldname
                                            : geom->meshname};
      break;
    }
    case mjOBJ_SITE:
      names = {material ? mjs_asSite(element)->material : mjs_asSite(element)->meshname};
      break;
    case mjOBJ_SKIN:
      names = {mjs_asSkin(element)->material};
      break;
    case mjOBJ_TENDON:
      names = {mjs_asTendon(element)->material};
      break;
    default:
      break;
  }
  return std::any_of(names.begin(), names.end(), [&](const mjString* name) {
    return name && asset.name == mjs_getString(name);
  });
}

// Describes the first element that refers to it: "geom 0 (unnamed, of body 'fore'): "; "" if
// unknown.
std::string WhoWants(const Part& part, const MissingAsset& asset, const std::string& text) {
  if (const std::string name = Between(text, "Element name '", "'"); !name.empty()) {
    const std::string rest = Between(text + "\n", "' not found in ", "\n");
    return fmt::format("{} '{}': ", rest.substr(0, rest.find(' ')), name);
  }
  for (const mjtObj kind : {mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_SKIN, mjOBJ_TENDON}) {
    for (mjsElement* element : SpecElements(part.spec.get(), kind)) {
      if (Wants(element, asset)) return DescribeSpecElement(element) + ": ";
    }
  }
  return "";
}

// The element's number differs in the scene, and its name may have a prefix there: only the part
// alone counts.
std::optional<std::string> MissingAssetProblem(const std::string& text, const Part& part,
                                               const std::string& prefix) {
  const auto in_scene = FindMissingAsset(text);
  if (!in_scene) return std::nullopt;
  const std::string alone = ProblemAlone(part);
  const auto asset = FindMissingAsset(alone);
  if (!asset || asset->kind != in_scene->kind) return std::nullopt;
  if (in_scene->name != asset->name && in_scene->name != prefix + asset->name) return std::nullopt;
  const std::vector<std::string> names = SpecNames(part.spec.get(), asset->kind);
  const char* kind = KindName(asset->kind);
  const std::string what = names.empty()
                               ? fmt::format(
                                     "no {0} '{1}', and the model has none: put <{0} name=\"{1}\" "
                                     ".../> into its <asset>",
                                     kind, asset->name)
                               : NoSuchName("", kind, asset->name, names);
  return PlaceOf(part, FileOf(part, asset->name), Digits(Between(alone + "\n", ", line ", "\n"))) +
         WhoWants(part, *asset, alone) + what;
}

// Advice for the engine's message; "" if there is none.
std::string NextStep(const std::string& complaint, mjtObj kind, const std::string& name,
                     bool is_robot, bool has_file) {
  if (kind != mjOBJ_BODY || complaint.find("mass and inertia") == std::string::npos) return "";
  if (!has_file) return "; give the object a greater `mass`";
  const std::string edit = fmt::format(
      " (in the robot's file, for example: edits: [{{geom: {{body: {}, index: 0}}, mass: 0.05}}])",
      name);
  return fmt::format(
      ". A body that moves needs a mass: give one of its geoms a `mass`{} or the body an "
      "<inertial>",
      is_robot ? edit : "");
}

}  // namespace

std::optional<std::string> CompileProblem(const std::string& text, const Part& part,
                                          const std::string& prefix) {
  const std::string full_name = Between(text, "Element name '", "'");
  const std::string complaint = Between(text, "Error: ", "\n");
  const std::string line = Digits(Between(text + "\n", ", line ", "\n"));
  if (const auto problem = MissingAssetProblem(text, part, prefix)) return problem;
  // Unnamed elements do not identify their part; a part that does not compile alone does.
  if (full_name.empty() && !complaint.empty() &&
      Between(ProblemAlone(part), "Error: ", "\n") == complaint)
    return PlaceOf(part, part.tools.empty() ? part.file : "", line) + complaint;
  if (full_name.size() <= prefix.size() || !full_name.starts_with(prefix)) return std::nullopt;
  const std::string name = full_name.substr(prefix.size());
  std::vector<mjtObj> kinds;
  for (const mjtObj kind : kKinds) {
    if (FindSpecElement(part.spec.get(), kind, name)) kinds.push_back(kind);
  }
  if (kinds.empty()) return std::nullopt;
  const std::string file = FileOf(part, name);
  const bool is_certain = kinds.size() == 1;  // the engine gives only the name
  const bool editable = part.place.starts_with("robot ") && file == part.file;
  return fmt::format("{}{} '{}': {}{}", PlaceOf(part, file, line),
                     is_certain ? KindName(kinds[0]) : "element", name, complaint,
                     NextStep(complaint, kinds[0], name, editable, !part.file.empty()));
}

std::optional<Repeated> RepeatedName(const std::string& text) {
  Repeated repeated{.kind = "", .name = Between(text, "repeated name '", "' in ")};
  if (repeated.name.empty()) return std::nullopt;
  const std::string rest = Between(text + "\n", "' in ", "\n");
  repeated.kind = rest.substr(0, rest.find_first_of(" ,.;\n"));
  return repeated;
}

bool HasElement(const Part& part, const std::string& prefix, const Repeated& element) {
  if (!element.name.starts_with(prefix)) return false;
  const std::string name = element.name.substr(prefix.size());
  return std::any_of(std::begin(kKinds), std::end(kKinds), [&](mjtObj kind) {
    return KindName(kind) == element.kind && FindSpecElement(part.spec.get(), kind, name);
  });
}

std::string FileWith(const Part& part, const std::string& name) {
  return Shown(part, FileOf(part, name));
}

std::string PlaceInModel(const Part& part, mjtObj kind, const std::string& name) {
  mjsElement* element = FindSpecElement(part.spec.get(), kind, name);
  const std::string place = PlaceOf(part, FileOf(part, name), element ? LineOf(element) : "");
  return place.substr(0, place.size() - std::string_view(": ").size());
}

}  // namespace robocell::internal
