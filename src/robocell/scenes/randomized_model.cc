#include "robocell/scenes/randomized_model.h"

#include <fmt/format.h>
#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/scenes/randomized_look.h"
#include "robocell/scenes/randomized_numbers.h"

namespace robocell::internal {
namespace {

constexpr std::string_view kScale = "_scale";

// Returns "specular" and whether it is a factor, for "specular_scale".
std::pair<std::string_view, bool> SplitScale(std::string_view property) {
  if (!property.ends_with(kScale)) return {property, false};
  return {property.substr(0, property.size() - kScale.size()), true};
}

constexpr std::array<std::string_view, 5> kPhysics = {"mass", "inertia", "friction", "damping",
                                                      "gain"};
constexpr std::array<std::string_view, 6> kLooks = {"colour",      "specular", "shininess",
                                                    "reflectance", "texture",  "texture_seed"};

bool IsOf(std::string_view property, const auto& list) {
  return std::ranges::find(list, property) != list.end();
}

// Returns true for fields that values change, and for those that follow from masses.
bool IsVaried(std::string_view field) {
  for (const std::string_view each : {"geom_rgba",
                                      "geom_matid",
                                      "geom_friction",
                                      "mat_texid",
                                      "mat_texuniform",
                                      "mat_texrepeat",
                                      "mat_emission",
                                      "mat_specular",
                                      "mat_shininess",
                                      "mat_reflectance",
                                      "mat_metallic",
                                      "mat_roughness",
                                      "mat_rgba",
                                      "light_active",
                                      "light_pos",
                                      "light_dir",
                                      "light_diffuse",
                                      "light_specular",
                                      "light_poscom0",
                                      "light_pos0",
                                      "light_dir0",
                                      "cam_poscom0",
                                      "cam_pos0",
                                      "cam_mat0",
                                      "body_mass",
                                      "body_inertia",
                                      "body_subtreemass",
                                      "body_invweight0",
                                      "flexedge_invweight0",
                                      "dof_invweight0",
                                      "dof_M0",
                                      "dof_length",
                                      "dof_damping",
                                      "tendon_invweight0",
                                      "actuator_acc0",
                                      "actuator_gainprm",
                                      "actuator_biasprm"}) {
    if (field == each) return true;
  }
  return false;
}

// Returns true for fields that mj_setConst writes too, from the pose of the reference alone: a model
// may have others since it was compiled, such as the anchors of a connection that was moved.
bool IsOfReference(std::string_view field) {
  for (const std::string_view each :
       {"eq_data", "tendon_length0", "tendon_lengthspring", "actuator_length0"}) {
    if (field == each) return true;
  }
  return false;
}

// Calls f(name, address, bytes) for each array of the model.
template <class F>
void ForEachArray(mjModel* m, const F& f) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"  // sizes of few arrays
  MJMODEL_POINTERS_PREAMBLE(m)
#pragma GCC diagnostic pop
#define X(type, name, rows, columns)  \
  f(std::string_view(#name), m->name, \
    sizeof(type) * static_cast<size_t>(m->rows) * static_cast<size_t>(columns));
#define XNV X
  MJMODEL_POINTERS
#undef X
#undef XNV
}

}  // namespace

void AddStudio(SceneSpec& spec) {
  for (const SceneObject& object : spec.objects) {
    if (object.name != kStudio) continue;
    if (object.mjcf_path == kStudio) return;
    throw ArgumentError(
        fmt::format("object '{}': this name belongs to the lights and materials that `randomize` "
                    "adds to the scene; give the object another name",
                    kStudio));
  }
  spec.objects.push_back({.name = kStudio, .mjcf_path = kStudio, .fixed = true});
}

RandomizedModel::RandomizedModel(const Scene& scene, std::string directory)
    : scene_(scene), directory_(std::move(directory)), targets_(scene) {}

RandomizedModel::~RandomizedModel() {
  try {
    if (!saved_.empty() && !scene_.closed()) Restore();
  } catch (const Error& error) {
    LogDebug(fmt::format("randomised values stay in the model: {}", error.what()));
  }
}

std::string RandomizedModel::place() const { return "scene '" + scene_.name() + "'"; }

void RandomizedModel::KeepBytes(void* at, size_t bytes) {
  if (bytes == 0) return;
  const auto* from = static_cast<const std::byte*>(at);
  saved_.push_back({at, std::vector<std::byte>(from, from + bytes)});
}

// Keeps every array that Apply or the engine's mj_setConst may write.
void RandomizedModel::KeepAll() {
  mjModel* m = scene_.mutable_model();
  saved_.clear();
  Keep(&m->vis, 1);
  Keep(&m->stat, 1);
  ForEachArray(m, [&](std::string_view name, void* at, size_t bytes) {
    if (IsVaried(name)) KeepBytes(at, bytes);
  });
}

void RandomizedModel::Restore() {
  if (saved_.empty()) return;
  if (generation_ != scene_.generation()) return saved_.clear();
  mjModel* m = scene_.mutable_model();
  for (const Saved& each : saved_) std::memcpy(each.at, each.bytes.data(), each.bytes.size());
  saved_.clear();
  if (std::exchange(textures_differ_, false)) TexturesChange(m);
}

void RandomizedModel::Apply(const RandomizedValues& values, Part part) {
  if (generation_ != scene_.generation() && !saved_.empty()) {
    saved_.clear();
    throw Error(place() +
                ": objects were added or removed while values were randomised, so that the model's "
                "own values are lost; declare the objects in the scene (`parked`)");
  }
  Restore();
  if (generation_ != scene_.generation()) scratch_.reset();
  generation_ = scene_.generation();
  const std::vector<std::string> properties = [] {
    std::vector<std::string> all;
    for (const std::string_view each : kLooks) all.emplace_back(each);
    for (const std::string_view each : kPhysics) all.emplace_back(each);
    return all;
  }();
  KeepAll();
  inertia_differs_ = false;
  std::vector<std::pair<std::string, RandomizedLook>> looks;
  // The order of names decides, not that of the entries: a record gives the same bits again.
  std::vector<RandomizedValues::Entry> sorted = values.entries();
  std::ranges::sort(sorted, {}, &RandomizedValues::Entry::first);
  for (const auto& [name, value] : sorted) {
    if (name.starts_with("light/") || name.starts_with("sky/") || name.starts_with("clutter/") ||
        name == "action_delay")
      continue;
    const size_t slash = name.rfind('/');
    const std::string of = slash == std::string::npos ? name : name.substr(0, slash);
    const std::string property = slash == std::string::npos ? "" : name.substr(slash + 1);
    const auto [kind, is_scale] = SplitScale(property);
    if (!IsOf(kind, kLooks) && !IsOf(kind, kPhysics))
      throw NotFoundError(NoSuchName(fmt::format("randomized value '{}'", name), "property",
                                     std::string(kind), properties));
    const RandomizedTarget& target = targets_.At(of, place() + ": randomized value '" + name + "'");
    if (IsOf(kind, kPhysics)) {
      ApplyPhysics(target, property, *value, name);
      continue;
    }
    if (part == Part::kPhysics) continue;
    if (looks.empty() || looks.back().first != of) {
      const auto known =
          std::ranges::find(looks, of, &std::pair<std::string, RandomizedLook>::first);
      if (known == looks.end())
        looks.emplace_back(of, RandomizedLook{});
      else
        std::rotate(known, known + 1, looks.end());
    }
    RandomizedLook& look = looks.back().second;
    if (kind == "texture") {
      if (value->word.empty())
        throw ArgumentError(
            fmt::format("randomized value '{}' must be the name of a texture", name));
      look.texture = value->word;
    } else if (kind == "texture_seed") {
      look.seed = static_cast<uint32_t>(std::clamp(NumberOf(*value, name), 0.0, 4294967295.0));
    } else if (kind == "colour") {
      const std::vector<double>& rgb = NumbersOf(*value, 3, name);
      look.colour = {RandomizedLook::Number{rgb[0], is_scale},
                     RandomizedLook::Number{rgb[1], is_scale},
                     RandomizedLook::Number{rgb[2], is_scale}};
    } else {
      const RandomizedLook::Number number{NumberOf(*value, name), is_scale};
      (kind == "specular"    ? look.specular
       : kind == "shininess" ? look.shininess
                             : look.reflectance) = number;
    }
  }
  if (part == Part::kAll) {
    ApplyLights(values);
    ApplySky(values);
    std::ranges::sort(looks, {}, &std::pair<std::string, RandomizedLook>::first);
    StudioMaterials studio(scene_.model());
    for (const auto& [of, look] : looks) ApplyLook(targets_.At(of, place()), look, studio);
    if (textures_differ_) TexturesChange(scene_.model());
  }
  if (inertia_differs_) RecomputeConstants();
  scene_.Forward();
}

void RandomizedModel::ApplyPhysics(const RandomizedTarget& target, std::string_view property,
                                   const RandomizedValue& value, const std::string& name) {
  mjModel* m = scene_.mutable_model();
  const auto [kind, is_scale] = SplitScale(property);
  const double number = NumberOf(value, name);
  const auto refuse = [&](const std::string& why) {
    throw ArgumentError(fmt::format("{}: randomized value '{}': {}", place(), name, why));
  };
  if (number < 0 || ((kind == "mass" || kind == "inertia") && number == 0))
    refuse(fmt::format("is {:g}; it must be {}", number, number < 0 ? "at least 0" : "above 0"));
  if (!is_scale && (kind == "inertia" || kind == "gain"))
    refuse(fmt::format("is a factor; write {}_scale", name));
  if (kind == "mass" || kind == "inertia") {
    double factor = number, total = 0;
    for (const int b : target.bodies) total += m->body_mass[b];
    if (total <= 0) refuse(fmt::format("'{}' has no mass", target.name));
    if (!is_scale) factor = number / total;
    for (const int b : target.bodies) {
      if (kind == "mass") m->body_mass[b] *= factor;
      for (int k = 0; k < 3; ++k) m->body_inertia[3 * b + k] *= factor;
    }
    inertia_differs_ = true;
  } else if (kind == "friction") {
    for (const int g : target.geoms) {
      mjtNum* friction = m->geom_friction + static_cast<ptrdiff_t>(3) * g;
      if (!is_scale)
        friction[0] = number;
      else
        for (int k = 0; k < 3; ++k) friction[k] *= number;
    }
  } else if (kind == "damping") {
    for (const int dof : target.dofs)
      m->dof_damping[dof] = is_scale ? number * m->dof_damping[dof] : number;
  } else {
    for (const int a : target.servos) {
      m->actuator_gainprm[static_cast<ptrdiff_t>(mjNGAIN) * a] *= number;
      for (int k = 0; k < 3; ++k)
        m->actuator_biasprm[static_cast<ptrdiff_t>(mjNBIAS) * a + k] *= number;
    }
  }
}

// Computes what follows from masses. The visual scale stays, and what follows from the reference.
void RandomizedModel::RecomputeConstants() {
  mjModel* m = scene_.mutable_model();
  if (!scratch_) scratch_ = MakeData(m);
  const mjStatistic before = m->stat;
  std::vector<Saved> reference;
  ForEachArray(m, [&](std::string_view name, void* at, size_t bytes) {
    if (!IsOfReference(name) || bytes == 0) return;
    const auto* from = static_cast<const std::byte*>(at);
    reference.push_back({at, std::vector<std::byte>(from, from + bytes)});
  });
  Guarded(place(), [&] { mj_setConst(m, scratch_.get()); });
  for (const Saved& each : reference) std::memcpy(each.at, each.bytes.data(), each.bytes.size());
  m->stat.extent = before.extent;
  m->stat.meansize = before.meansize;
  std::copy_n(before.center, 3, m->stat.center);
}

}  // namespace robocell::internal
