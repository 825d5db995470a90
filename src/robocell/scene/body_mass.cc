#include "robocell/scene/body_mass.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

bool IsFromGeoms(mjsBody* body) {
  const mjtInertiaFromGeom from = mjs_getCompiler(body->element)->inertiafromgeom;
  return from == mjINERTIAFROMGEOM_TRUE ||
         (from == mjINERTIAFROMGEOM_AUTO && !body->explicitinertial);
}

bool HasVolume(const mjsGeom* geom) {
  return geom->type != mjGEOM_PLANE && geom->type != mjGEOM_HFIELD;
}

bool IsInWeighedGroup(const mjsGeom* geom) {
  const int* range = mjs_getCompiler(geom->element)->inertiagrouprange;
  return geom->group >= range[0] && geom->group <= range[1];
}

// The geoms that make up the mass of their body.
std::vector<mjsGeom*> Weighed(mjsBody* body) {
  std::vector<mjsGeom*> geoms;
  for (mjsElement* element : BodyElements(body, mjOBJ_GEOM)) {
    mjsGeom* geom = mjs_asGeom(element);
    const double weight = std::isnan(geom->mass) ? geom->density : geom->mass;
    if (HasVolume(geom) && IsInWeighedGroup(geom) && weight > 0) geoms.push_back(geom);
  }
  return geoms;
}

std::string GeomMassEdit(mjsBody* body) {
  return fmt::format("{{geom: {{body: '{}', index: 0}}, mass: ...}}", SpecName(body->element));
}

std::optional<std::string> SetMassOfGeoms(mjsBody* body, double mass) {
  const std::vector<mjsGeom*> geoms = Weighed(body);
  const std::string name = DescribeSpecElement(body->element);
  if (geoms.empty()) {
    return fmt::format(
        "{} has neither an <inertial> nor geoms with a mass, so its mass can be "
        "that of nothing; write an <inertial> into the file, or give a geom a mass: "
        "{}",
        name, GeomMassEdit(body));
  }
  if (geoms.size() == 1) return geoms[0]->mass = mass, std::nullopt;
  double sum = 0;
  for (const mjsGeom* geom : geoms) sum += geom->mass;
  if (std::isnan(sum)) {
    return fmt::format(
        "{} has no <inertial>: its mass is that of its {} geoms, of which not all say "
        "theirs; write it geom by geom: {}, or an <inertial> into the file",
        name, geoms.size(), GeomMassEdit(body));
  }
  for (mjsGeom* geom : geoms) geom->mass *= mass / sum;
  return std::nullopt;
}

void SetMassOfInertial(mjsBody* body, double mass) {
  if (body->mass > 0) {
    const double scale = mass / body->mass;
    for (double& inertia : body->inertia) inertia *= scale;
    for (double& inertia : body->fullinertia) inertia *= scale;
  }
  body->mass = mass;
}

}  // namespace

std::optional<std::string> SetBodyMass(mjsBody* body, double mass) {
  if (const double least = mjs_getCompiler(body->element)->boundmass; mass < least) {
    return fmt::format(
        "the file's <compiler boundmass=\"{}\"> raises all masses below it, that of {} "
        "too; write at least {}, or change boundmass in the file",
        least, DescribeSpecElement(body->element), least);
  }
  if (IsFromGeoms(body)) return SetMassOfGeoms(body, mass);
  SetMassOfInertial(body, mass);
  return std::nullopt;
}

std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass) {
  mjsBody* body = mjs_getParent(geom->element);
  const std::string name = DescribeSpecElement(geom->element);
  if (!IsFromGeoms(body)) {
    return fmt::format(
        "the mass of {} does not count, that of its body is written as <inertial>; "
        "write {{body: '{}', mass: ...}}",
        name, SpecName(body->element));
  }
  if (!HasVolume(geom)) {
    return fmt::format(
        "{} is a plane or a height field, which has no mass; give it to another geom", name);
  }
  if (!IsInWeighedGroup(geom)) {
    const int* range = mjs_getCompiler(geom->element)->inertiagrouprange;
    return fmt::format(
        "{} is in group {}, and the file's <compiler inertiagrouprange=\"{} {}\"> counts "
        "other geoms only; give the mass to one of these",
        name, geom->group, range[0], range[1]);
  }
  geom->mass = mass;
  return std::nullopt;
}

}  // namespace robocell
