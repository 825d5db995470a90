#include "robocell/scene/decorations.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/clip_planes.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

constexpr double kNear = 0.01, kFar = 100.0;  // metres

void Fill(double (&out)[3], double a, double b, double c) { out[0] = a, out[1] = b, out[2] = c; }
void Fill(float (&out)[3], float a, float b, float c) { out[0] = a, out[1] = b, out[2] = c; }

void AddFloorMaterial(mjSpec* spec) {
  mjsTexture* texture = mjs_addTexture(spec, nullptr);
  SetSpecName(texture->element, "robocell_floor", "floor");
  texture->type = mjTEXTURE_2D;
  texture->builtin = mjBUILTIN_CHECKER;
  texture->mark = mjMARK_EDGE;
  Fill(texture->rgb1, 0.74, 0.75, 0.76);
  Fill(texture->rgb2, 0.69, 0.70, 0.72);
  Fill(texture->markrgb, 0.62, 0.63, 0.65);
  texture->width = texture->height = 128;
  mjsMaterial* material = mjs_addMaterial(spec, nullptr);
  SetSpecName(material->element, "robocell_floor", "floor");
  mjs_setInStringVec(material->textures, mjTEXROLE_RGB, "robocell_floor");
  material->texuniform = 1;
  material->texrepeat[0] = material->texrepeat[1] = 1;  // a square is half a metre
  material->specular = 0.1f;
  material->shininess = 0.1f;
}

void AddFloor(mjSpec* spec) {
  AddFloorMaterial(spec);
  mjsGeom* floor = mjs_addGeom(WorldBody(spec), nullptr);
  SetSpecName(floor->element, "floor", "floor");
  floor->type = mjGEOM_PLANE;
  floor->size[2] = 0.05;  // zero x and y: infinite
  mjs_setString(floor->material, "robocell_floor");
}

void AddSky(mjSpec* spec) {
  mjsTexture* sky = mjs_addTexture(spec, nullptr);
  SetSpecName(sky->element, "robocell_sky", "sky");
  sky->type = mjTEXTURE_SKYBOX;
  sky->builtin = mjBUILTIN_GRADIENT;
  Fill(sky->rgb1, 0.88, 0.91, 0.94);
  Fill(sky->rgb2, 0.52, 0.63, 0.76);
  sky->width = 32;
  sky->height = 192;
  // At the horizon the floor takes the sky's colour.
  std::copy_n(sky->rgb1, 3, spec->visual.rgba.haze);
}

mjsLight* AddLight(mjSpec* spec, const char* name) {
  mjsLight* light = mjs_addLight(WorldBody(spec), nullptr);
  SetSpecName(light->element, name, "light");
  light->type = mjLIGHT_DIRECTIONAL;
  return light;
}

void AddLights(mjSpec* spec) {
  mjsLight* key = AddLight(spec, "key_light");
  Fill(key->pos, 0.8, 0.9, 2.5);
  Fill(key->dir, -0.35, -0.4, -1);
  Fill(key->diffuse, 0.42f, 0.41f, 0.39f);
  Fill(key->specular, 0.2f, 0.2f, 0.2f);
  mjsLight* fill = AddLight(spec, "fill_light");
  Fill(fill->pos, -1.5, -0.8, 2);
  Fill(fill->dir, 0.6, 0.3, -1);
  Fill(fill->diffuse, 0.16f, 0.17f, 0.19f);
  Fill(fill->specular, 0, 0, 0);
  fill->castshadow = 0;
  auto& headlight = spec->visual.headlight;
  Fill(headlight.ambient, 0.32f, 0.32f, 0.33f);
  Fill(headlight.diffuse, 0.25f, 0.25f, 0.25f);
  Fill(headlight.specular, 0.1f, 0.1f, 0.1f);
}

}  // namespace

void AddDecorations(const SceneSpec& scene, mjSpec* spec) {
  if (scene.add_floor.value_or(false)) AddFloor(spec);
  if (!scene.add_skybox.value_or(false)) return;
  AddSky(spec);
  if (SpecElements(spec, mjOBJ_LIGHT).empty()) AddLights(spec);
}

void FixVisibleRange(mjSpec* spec, mjModel* model) {
  SetClipPlanes(spec, model->stat.extent, kNear, kFar);
  SetClipPlanes(model, kNear, kFar);
}

}  // namespace robocell::internal
