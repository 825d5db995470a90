#include "robocell/env/object_variations.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {

ObjectVariations::ObjectVariations(const EnvConfig& config, Scene scene)
    : scene_(std::move(scene)) {
  for (const auto& [id, range] : config.variations.entries()) ranges_.emplace_back(id, *range);
  for (size_t i = 0; i < ranges_.size(); ++i) drawn_.insert(drawn_.end(), {1, 1, 0, 0, 0});
  Bind();
}

// Binds to a model as it was compiled: the object's own values are varied.
void ObjectVariations::Bind() {
  if (ranges_.empty() || generation_ == scene_.generation()) return;
  objects_.clear();
  for (const auto& [id, range] : ranges_) objects_.push_back(Read(id, range));
  scratch_ = MakeData(scene_.model());
  generation_ = scene_.generation();
}

ObjectVariations::Varied ObjectVariations::Read(const std::string& object,
                                                const ObjectVariation& range) const {
  const mjModel* m = scene_.model();
  Varied out{.range = range};
  const int root = RequireId(m, mjOBJ_BODY, scene_.compiled()->object(object).root_body,
                             "scene '" + scene_.name() + "'");
  for (int b = 0; b < m->nbody; ++b) {
    if (!IsInSubtree(m, b, root)) continue;
    out.bodies.push_back(b);
    out.mass.push_back(m->body_mass[b]);
    out.inertia.insert(out.inertia.end(), m->body_inertia + 3 * b, m->body_inertia + 3 * b + 3);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsInSubtree(m, m->geom_bodyid[g], root)) continue;
    out.geoms.push_back(g);
    out.friction.insert(out.friction.end(), m->geom_friction + 3 * g, m->geom_friction + 3 * g + 3);
    // A geom takes the colour of its material as long as its own is not set.
    const int material = m->geom_matid[g];
    const float* rgba = material < 0 ? m->geom_rgba + 4 * g : m->mat_rgba + 4 * material;
    out.rgba.insert(out.rgba.end(), rgba, rgba + 4);
  }
  return out;
}

void ObjectVariations::Write(const Varied& object, std::span<const double> drawn) {
  mjModel* m = scene_.mutable_model();
  for (size_t i = 0; i < object.bodies.size(); ++i) {
    m->body_mass[object.bodies[i]] = drawn[0] * object.mass[i];
    for (size_t k = 0; k < 3; ++k)
      m->body_inertia[3 * object.bodies[i] + k] = drawn[0] * object.inertia[3 * i + k];
  }
  for (size_t i = 0; i < object.geoms.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      m->geom_friction[3 * object.geoms[i] + k] = drawn[1] * object.friction[3 * i + k];
      if (object.range.colour == 0) continue;
      m->geom_rgba[4 * object.geoms[i] + k] = static_cast<float>(
          std::clamp(static_cast<double>(object.rgba[4 * i + k]) + drawn[2 + k], 0.0, 1.0));
    }
  }
}

void ObjectVariations::Draw(Rng& rng) {
  std::vector<double> drawn;
  for (const auto& [id, range] : ranges_) {
    drawn.push_back(rng.Uniform(range.mass[0], range.mass[1]));
    drawn.push_back(rng.Uniform(range.friction[0], range.friction[1]));
    for (int k = 0; k < 3; ++k) drawn.push_back(rng.Uniform(-range.colour, range.colour));
  }
  Apply(drawn);
}

void ObjectVariations::Apply(std::span<const double> drawn) {
  if (drawn.size() != kNumbers * ranges_.size()) {
    throw ArgumentError(fmt::format("variations of {} are {} numbers, got {}",
                                    Counted(std::ssize(ranges_), "object"),
                                    kNumbers * ranges_.size(), drawn.size()));
  }
  drawn_.assign(drawn.begin(), drawn.end());
  if (ranges_.empty()) return;
  Bind();
  for (size_t i = 0; i < objects_.size(); ++i)
    Write(objects_[i], drawn.subspan(kNumbers * i, kNumbers));
  mjModel* m = scene_.mutable_model();
  const mjStatistic before = m->stat;
  Guarded("scene '" + scene_.name() + "'", [&] { mj_setConst(m, scratch_.get()); });
  // The visual scale stays; the solver's scale follows from the masses.
  m->stat.extent = before.extent;
  m->stat.meansize = before.meansize;
  std::copy_n(before.center, 3, m->stat.center);
}

}  // namespace robocell::internal
