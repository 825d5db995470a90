#include "robocell/scenes/catalogue.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

// Measures a model on its collision geometry.
ObjectSize MeasureModel(const std::string& path) {
  SceneSpec spec{
      .name = "object " + path, .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back({.name = "object", .mjcf_path = path});  // mocap bodies cannot be free
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  ObjectSize size;
  const int body = FindId(m, mjOBJ_BODY, scene.compiled()->object("object").root_body);
  for (int g = 0; g < m->ngeom; ++g) {
    if (!internal::IsCollisionGeom(m, g) || !internal::IsInSubtree(m, m->geom_bodyid[g], body))
      continue;
    double most[2];
    for (int i = 0; i < 2; ++i) {
      const Interval e = internal::GeomExtent(m, scene.data(), g, Eigen::Vector3d::Unit(i));
      most[i] = std::max(std::abs(e.lower), std::abs(e.upper));
    }
    size.radius = std::max(size.radius, std::hypot(most[0], most[1]));
    const Interval upright = internal::GeomExtent(m, scene.data(), g, Eigen::Vector3d::UnitZ());
    size.height = std::max(size.height, -upright.lower);
    size.top = std::max(size.top, upright.upper);
  }
  return size;
}

ObjectSize SizeOfModel(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, ObjectSize> known;
  const std::lock_guard lock(mutex);
  const std::string hash = internal::ModelFileSet(assets::Resolve(path)).hash;
  const auto it = known.find(hash);
  return it != known.end() ? it->second : known.emplace(hash, MeasureModel(path)).first->second;
}

Vec4 Colour(Rng& rng) {
  static constexpr Vec4 kColours[] = {{0.85, 0.25, 0.2, 1}, {0.2, 0.45, 0.8, 1},
                                      {0.25, 0.65, 0.3, 1}, {0.95, 0.7, 0.2, 1},
                                      {0.6, 0.35, 0.7, 1},  {0.9, 0.9, 0.88, 1}};
  return kColours[rng.UniformInt(std::size(kColours))];
}

// Half sizes: graspable by a common parallel gripper in at least one direction.
Vec3 PrimitiveSize(Shape shape, Rng& rng) {
  switch (shape) {
    case Shape::kBox:
      return {rng.Uniform(0.012, 0.024), rng.Uniform(0.014, 0.035), rng.Uniform(0.015, 0.035)};
    case Shape::kCylinder:
      return {rng.Uniform(0.013, 0.025), rng.Uniform(0.02, 0.05), 0};
    case Shape::kSphere:
      break;
  }
  return {rng.Uniform(0.017, 0.027), 0, 0};
}

SceneObject Primitive(Shape shape, const std::string& name, Rng& rng) {
  SceneObject object{.name = name, .shape = shape};
  object.size = PrimitiveSize(shape, rng);
  object.rgba = Colour(rng);
  object.mass = rng.Uniform(0.05, 0.2);
  object.friction = Vec3{rng.Uniform(0.7, 1.1), 0.02, 0.001};
  // A sphere without rolling friction never comes to rest.
  object.condim = shape == Shape::kSphere ? Condim::kRolling : Condim::kTorsional;
  if (shape == Shape::kSphere) object.friction = Vec3{(*object.friction)[0], 0.02, 0.002};
  return object;
}

constexpr const char* kPrimitives = "primitives";  // their category

std::vector<std::string> Primitives() { return {"box", "cylinder", "sphere"}; }

bool IsPrimitive(const std::string& kind) {
  const std::vector<std::string> primitives = Primitives();
  return std::ranges::find(primitives, kind) != primitives.end();
}

// Returns the folders of the kinds that are models. The name of a primitive means the primitive.
std::map<std::string, std::string> ModelFolders() {
  std::map<std::string, std::string> folders = assets::ObjectFolders();
  std::erase_if(folders, [](const auto& entry) { return IsPrimitive(entry.first); });
  return folders;
}

// Returns what object.yaml in a folder says. Each file is read again only when it has changed.
ObjectInfo InfoIn(const std::string& folder) {
  struct Known {
    std::filesystem::file_time_type time;
    uintmax_t size = 0;
    ObjectInfo info;
  };
  static std::mutex mutex;
  static std::map<std::string, Known> known;
  const std::filesystem::path file = std::filesystem::path(folder) / "object.yaml";
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  if (error) return {};
  const uintmax_t size = std::filesystem::file_size(file, error);
  const std::lock_guard lock(mutex);
  const auto it = known.find(file.string());
  if (it != known.end() && it->second.time == time && it->second.size == size)
    return it->second.info;
  const Known& read = known[file.string()] = {time, size, LoadYaml<ObjectInfo>(file.string())};
  return read.info;
}

// Returns the same, and defaults for a file with faults: it is not asked for by its name, and its
// faults are no reason to reject others. Warns once of each fault.
ObjectInfo InfoOrWarning(const std::string& folder) {
  try {
    return InfoIn(folder);
  } catch (const Error& error) {
    static std::mutex mutex;
    static std::set<std::string> warned;
    const std::lock_guard lock(mutex);
    if (warned.insert(error.what()).second)
      LogWarn(fmt::format("object left out of categories and defaults: {}", error.what()));
    return {};
  }
}

}  // namespace

std::vector<std::string> ObjectKinds() {
  std::vector<std::string> kinds = Primitives();
  for (const auto& [name, folder] : ModelFolders()) kinds.push_back(name);
  return kinds;
}

bool IsObjectKind(const std::string& name) {
  return IsPrimitive(name) || assets::ObjectFolder(name).has_value();
}

std::vector<std::string> DefaultObjectKinds() {
  std::vector<std::string> kinds = Primitives();
  const std::string built_in = assets::ModelsRoot() + "/objects/";
  for (const auto& [name, folder] : ModelFolders()) {
    // A user's mug in the place of the built-in one is drawn as that was.
    if (InfoOrWarning(folder).drawn_by_default || InfoOrWarning(built_in + name).drawn_by_default)
      kinds.push_back(name);
  }
  return kinds;
}

ObjectInfo ObjectInfoOf(const std::string& kind) {
  if (IsPrimitive(kind))
    return {.category = kPrimitives, .grasps = {ObjectGrasp::kTop, ObjectGrasp::kSide}};
  if (const auto folder = assets::ObjectFolder(kind)) return InfoIn(*folder);
  const std::vector<std::string> equipment = assets::BuiltinEquipment();
  if (std::ranges::find(equipment, kind) != equipment.end())
    return InfoIn(assets::ModelsRoot() + "/equipment/" + kind);
  throw NotFoundError(NoSuchName("the catalogue", "kind", kind, ObjectKinds()));
}

std::map<std::string, std::vector<std::string>> ObjectCategories() {
  std::map<std::string, std::vector<std::string>> categories = {{kPrimitives, Primitives()}};
  for (const auto& [name, folder] : ModelFolders()) {
    if (const std::string category = InfoOrWarning(folder).category; !category.empty())
      categories[category].push_back(name);
  }
  return categories;
}

std::vector<std::string> ObjectKindsOf(const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  const auto add = [&](const std::string& kind) {
    if (std::ranges::find(chosen, kind) == chosen.end()) chosen.push_back(kind);
  };
  std::optional<std::map<std::string, std::vector<std::string>>> categories;
  for (const std::string& name : names) {
    if (IsObjectKind(name)) {
      add(name);
      continue;
    }
    if (!categories) categories = ObjectCategories();
    const auto category = categories->find(name);
    if (category == categories->end()) {
      add(name);
    } else {
      std::ranges::for_each(category->second, add);
    }
  }
  return chosen;
}

std::vector<std::string> KindsToDraw(const NameList& objects) {
  return objects.empty() ? DefaultObjectKinds() : ObjectKindsOf(objects.names);
}

std::string WordOfKind(const std::string& kind) {
  std::string word = kind;
  std::ranges::replace(word, '_', ' ');
  return word;
}

SceneObject MakeCatalogueObject(const std::string& kind, const std::string& name, Rng& rng) {
  if (kind == "box") return Primitive(Shape::kBox, name, rng);
  if (kind == "cylinder") return Primitive(Shape::kCylinder, name, rng);
  if (kind == "sphere") return Primitive(Shape::kSphere, name, rng);
  if (!IsObjectKind(kind))
    throw NotFoundError(NoSuchName("task.objects", "kind", kind, ObjectKinds()));
  return {.name = name, .mjcf_path = kind, .fixed = false};
}

ObjectSize ObjectSizes::Of(const SceneObject& object) {
  if (!object.shape) {
    const auto it = models_.find(object.mjcf_path);
    if (it != models_.end()) return it->second;
    return models_.emplace(object.mjcf_path, SizeOfModel(object.mjcf_path)).first->second;
  }
  const Vec3& s = *object.size;
  switch (*object.shape) {
    case Shape::kBox:
      return {std::hypot(s[0], s[1]), s[2], s[2]};
    case Shape::kCylinder:
      return {s[0], s[1], s[1]};
    case Shape::kSphere:
      break;
  }
  return {s[0], s[0], s[0]};
}

std::string WhyTooLarge(const SceneObject& object, const ObjectSize& size) {
  const double extent = std::max(2 * size.radius, size.height + size.top);
  if (object.fixed == true || extent <= kLargestObject) return "";
  return TooLargeText(object.name, extent, !object.shape);
}

std::string TooLargeText(const std::string& object, double size, bool is_model) {
  return fmt::format(
      "object '{}' is {:.3g} m large, and lengths are in metres. Is it in millimetres? Then {} (in "
      "millimetres it would be {:.3g} m)",
      object, size,
      is_model ? "give its <mesh> scale=\"0.001 0.001 0.001\""
               : "write its size and its position a thousandth as large",
      size / 1000);
}

}  // namespace robocell
