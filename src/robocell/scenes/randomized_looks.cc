// The looks of a RandomizedModel: lights, sky, materials.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/made_texture.h"
#include "robocell/scenes/randomized_look.h"
#include "robocell/scenes/randomized_model.h"
#include "robocell/scenes/randomized_numbers.h"

namespace robocell::internal {
namespace {

constexpr double kLightDistance = 2.5;  // metres from the robots
// The engine takes the colour of the material for a geom of this one.
constexpr std::array<float, 4> kUnsetColour = {0.5F, 0.5F, 0.5F, 1.0F};

// Returns the elements `studio_light_0`, `studio_light_1` ... of the model; another object's name may
// begin with the same word.
std::vector<int> OfStudio(const mjModel* m, mjtObj kind, std::string_view name) {
  std::vector<int> ids;
  for (int i = 0;; ++i) {
    const int id = FindId(m, kind, fmt::format("{}_{}_{}", kStudio, name, i));
    if (id < 0) return ids;
    ids.push_back(id);
  }
}

// Returns the colour that the engine gives a geom.
std::array<float, 4> ColourOf(const mjModel* m, int geom) {
  std::array<float, 4> rgba;
  std::copy_n(m->geom_rgba + 4 * geom, 4, rgba.begin());
  const int material = m->geom_matid[geom];
  if (material >= 0 && rgba == kUnsetColour)
    std::copy_n(m->mat_rgba + 4 * material, 4, rgba.begin());
  return rgba;
}

// Returns true for a geom whose surface has coordinates of its own, or that is a plane: textures of
// cubes do not fit it.
bool IsFlat(const mjModel* m, int geom) {
  if (m->geom_type[geom] == mjGEOM_PLANE) return true;
  const bool is_mesh = m->geom_type[geom] == mjGEOM_MESH || m->geom_type[geom] == mjGEOM_SDF;
  return is_mesh && m->geom_dataid[geom] >= 0 && m->mesh_texcoordadr[m->geom_dataid[geom]] >= 0;
}

int SkyOf(const mjModel* m) {
  for (int t = 0; t < m->ntex; ++t) {
    if (m->tex_type[t] == mjTEXTURE_SKYBOX) return t;
  }
  return -1;
}

int64_t BytesOfTexture(const mjModel* m, int texture) {
  return static_cast<int64_t>(m->tex_width[texture]) * m->tex_height[texture] *
         m->tex_nchannel[texture];
}

std::vector<int> OwnLights(const mjModel* m) {
  std::vector<int> lights;
  for (int i = 0; i < m->nlight; ++i) {
    if (m->light_bodyid[i] == 0) lights.push_back(i);
  }
  return lights;
}

uint8_t ByteOf(double part) {
  return static_cast<uint8_t>(std::floor(255 * std::clamp(part, 0.0, 1.0) + 0.5));
}

}  // namespace

StudioMaterials::StudioMaterials(const mjModel* m)
    : model_(m),
      solid_(OfStudio(m, mjOBJ_MATERIAL, "solid")),
      flat_(OfStudio(m, mjOBJ_MATERIAL, "flat")) {}

bool StudioMaterials::Take(size_t solid, size_t flat) {
  if (solid > solid_.size() || flat > flat_.size()) return false;
  solid_.erase(solid_.begin(), solid_.begin() + static_cast<std::ptrdiff_t>(solid));
  flat_.erase(flat_.begin(), flat_.begin() + static_cast<std::ptrdiff_t>(flat));
  return true;
}

int StudioMaterials::Of(const std::string& target, int own, bool is_flat, bool& is_new) {
  const auto [known, added] = given_.try_emplace({target, own, is_flat}, -1);
  is_new = added;
  if (!added) return known->second;
  std::vector<int>& free = is_flat ? flat_ : solid_;
  if (free.empty()) {
    throw ArgumentError(fmt::format(
        "target '{}': there are no more materials to randomise: they are enough for 14 materials "
        "of solid parts, and for 6 of planes and of meshes with texture coordinates. Give looks "
        "to fewer targets, or `colour` alone, which needs none",
        target));
  }
  known->second = free.front();
  free.erase(free.begin());
  return known->second;
}

int RandomizedModel::own_lights() const {
  return static_cast<int>(OwnLights(scene_.model()).size());
}

std::vector<std::string> RandomizedModel::WithoutMaterials(std::vector<std::string> targets) {
  const mjModel* m = scene_.model();
  StudioMaterials studio(m);
  std::ranges::sort(targets);
  std::vector<std::string> without;
  for (const std::string& name : targets) {
    std::set<std::pair<int, bool>> needed;  // as ApplyLook asks for them
    for (const int g : targets_.At(name, place()).shown) {
      if (ColourOf(m, g)[3] > 0) needed.emplace(m->geom_matid[g], IsFlat(m, g));
    }
    const auto flat = static_cast<size_t>(
        std::ranges::count_if(needed, [](const auto& each) { return each.second; }));
    if (!studio.Take(needed.size() - flat, flat)) without.push_back(name);
  }
  return without;
}

bool RandomizedModel::has_sky() const { return SkyOf(scene_.model()) >= 0; }

void RandomizedModel::ApplyLights(const RandomizedValues& values) {
  mjModel* m = scene_.mutable_model();
  std::set<std::string> known = {"light/number", "light/ambient"};
  const bool is_numbered = values.contains("light/number");
  const int number = static_cast<int>(NumberOf(values, "light/number", 0));
  std::vector<int> lights = is_numbered ? OfStudio(m, mjOBJ_LIGHT, "light") : OwnLights(m);
  if (is_numbered) {
    if (number < 0 || number > std::ssize(lights)) {
      throw ArgumentError(
          fmt::format("randomized value 'light/number' is {}; {} has lights for 0 "
                      "to {}",
                      number, place(), lights.size()));
    }
    lights.resize(static_cast<size_t>(number));
    for (const int own : OwnLights(m)) m->light_active[own] = 0;
    for (const int light : lights) m->light_active[light] = 1;
  }
  if (const RandomizedValue* ambient = values.find("light/ambient"))
    std::fill_n(m->vis.headlight.ambient, 3,
                static_cast<float>(NumberOf(*ambient, "light/ambient")));
  std::array<double, 3> middle = {m->stat.center[0], m->stat.center[1], m->stat.center[2]};
  if (const auto& robots = scene_.compiled()->robots(); !robots.empty()) {
    const Pose base = scene_.body_pose(robots.front().root_body);
    middle = {base.translation().x(), base.translation().y(), base.translation().z()};
  }
  for (size_t i = 0; i < lights.size(); ++i) {
    const int light = lights[i];
    const std::string name = fmt::format("light/{}/", i);
    for (const char* each : {"azimuth", "elevation", "intensity", "colour"})
      known.insert(name + each);
    mjtNum* dir = m->light_dir + 3 * light;
    const double length = std::max(std::sqrt(mju_dot3(dir, dir)), 1e-9);
    const bool is_turned = values.contains(name + "azimuth") || values.contains(name + "elevation");
    if (is_turned) {
      const double degrees = kPi / 180;
      const double azimuth =
          NumberOf(values, name + "azimuth", std::atan2(-dir[1], -dir[0]) / degrees) * degrees;
      const double elevation =
          NumberOf(values, name + "elevation",
                   std::asin(std::clamp(-dir[2] / length, -1.0, 1.0)) / degrees) *
          degrees;
      const std::array<double, 3> from = {std::cos(elevation) * std::cos(azimuth),
                                          std::cos(elevation) * std::sin(azimuth),
                                          std::sin(elevation)};
      for (size_t k = 0; k < 3; ++k) {
        dir[k] = -from[k];
        m->light_pos[3 * light + static_cast<int>(k)] = middle[k] + kLightDistance * from[k];
      }
    }
    float* diffuse = m->light_diffuse + 3 * light;
    float* specular = m->light_specular + 3 * light;
    if (values.contains(name + "intensity")) {
      const double wanted = NumberOf(values, name + "intensity", 0);
      const double own = *std::max_element(diffuse, diffuse + 3);
      for (int k = 0; k < 3; ++k) {
        diffuse[k] = static_cast<float>(own > 0 ? wanted * diffuse[k] / own : wanted);
        if (own > 0) specular[k] = static_cast<float>(std::min(1.0, wanted * specular[k] / own));
      }
    }
    if (const RandomizedValue* colour = values.find(name + "colour")) {
      const std::vector<double>& factors = NumbersOf(*colour, 3, name + "colour");
      for (size_t k = 0; k < 3; ++k) {
        diffuse[k] = static_cast<float>(factors[k] * diffuse[k]);
        specular[k] = static_cast<float>(factors[k] * specular[k]);
      }
    }
  }
  for (const std::string& name : values.keys()) {
    if (!name.starts_with("light/") || known.contains(name)) continue;
    throw NotFoundError(NoSuchName(place(), "light's value", name,
                                   std::vector<std::string>(known.begin(), known.end())));
  }
}

// Keeps the sky's own pattern between two colours.
void RandomizedModel::ApplySky(const RandomizedValues& values) {
  const RandomizedValue *horizon = values.find("sky/horizon"), *zenith = values.find("sky/zenith");
  for (const std::string& name : values.keys()) {
    if (name.starts_with("sky/") && name != "sky/horizon" && name != "sky/zenith")
      throw NotFoundError(NoSuchName(place(), "sky's value", name, {"sky/horizon", "sky/zenith"}));
  }
  if (!horizon && !zenith) return;
  mjModel* m = scene_.mutable_model();
  const int sky = SkyOf(m);
  if (sky < 0) {
    throw NotFoundError(place() +
                        ": there is no sky to randomise; add one with `add_skybox`, or leave `sky` "
                        "out");
  }
  const int channels = m->tex_nchannel[sky];
  mjtByte* texels = m->tex_data + m->tex_adr[sky];
  const int64_t bytes = BytesOfTexture(m, sky);
  Keep(texels, bytes);
  const auto brightness = [&](const mjtByte* texel) {
    int sum = 0;
    for (int k = 0; k < std::min(channels, 3); ++k) sum += texel[k];
    return sum;
  };
  int darkest = brightness(texels), brightest = darkest;
  for (int64_t i = 0; i < bytes; i += channels) {
    darkest = std::min(darkest, brightness(texels + i));
    brightest = std::max(brightest, brightness(texels + i));
  }
  const auto end = [&](const RandomizedValue* given, int wanted, const std::string& name) {
    std::array<double, 3> colour = {};
    if (given) {
      std::ranges::copy(NumbersOf(*given, 3, name), colour.begin());
      return colour;
    }
    for (int64_t i = 0; i < bytes; i += channels) {
      if (brightness(texels + i) != wanted) continue;
      for (int k = 0; k < 3; ++k) colour[k] = texels[i + std::min(k, channels - 1)] / 255.0;
      break;
    }
    return colour;
  };
  const std::array<double, 3> low = end(horizon, brightest, "sky/horizon");
  const std::array<double, 3> high = end(zenith, darkest, "sky/zenith");
  const double range = std::max(1, brightest - darkest);
  for (int64_t i = 0; i < bytes; i += channels) {
    const double share = (brightest - brightness(texels + i)) / range;
    for (int k = 0; k < std::min(channels, 3); ++k)
      texels[i + k] = ByteOf(low[k] + share * (high[k] - low[k]));
  }
  for (int k = 0; k < 3; ++k) m->vis.rgba.haze[k] = static_cast<float>(low[k]);
  textures_differ_ = true;
}

void RandomizedModel::ApplyLook(const RandomizedTarget& target, const RandomizedLook& look,
                                StudioMaterials& studio) {
  mjModel* m = scene_.mutable_model();
  for (const int g : target.shown) {
    std::array<float, 4> colour = ColourOf(m, g);
    if (colour[3] == 0) continue;
    const int own = m->geom_matid[g];
    if (look.has_material()) {
      bool is_new = false;
      const int material = studio.Of(target.name, own, IsFlat(m, g), is_new);
      const int texture = studio.TextureOf(material);
      if (is_new) {
        const auto copy = [&](auto* field, auto otherwise) {
          field[material] = own >= 0 ? field[own] : otherwise;
        };
        copy(m->mat_emission, 0.0F);
        copy(m->mat_specular, 0.5F);  // those of a geom without a material
        copy(m->mat_shininess, 0.5F);
        copy(m->mat_reflectance, 0.0F);
        copy(m->mat_metallic, -1.0F);
        copy(m->mat_roughness, -1.0F);
        if (look.specular) m->mat_specular[material] = look.specular->Of(m->mat_specular[material]);
        if (look.shininess)
          m->mat_shininess[material] = look.shininess->Of(m->mat_shininess[material]);
        if (look.reflectance)
          m->mat_reflectance[material] = look.reflectance->Of(m->mat_reflectance[material]);
        std::fill_n(m->mat_rgba + 4 * material, 4, 1.0F);
        textures_differ_ = true;
        int* roles = m->mat_texid + static_cast<ptrdiff_t>(mjNTEXROLE) * material;
        if (!look.has_texture()) {
          std::fill_n(roles, mjNTEXROLE, -1);
          if (own >= 0) {
            std::copy_n(m->mat_texid + static_cast<ptrdiff_t>(mjNTEXROLE) * own, mjNTEXROLE, roles);
            copy(m->mat_texuniform, mjtBool{0});
            std::copy_n(m->mat_texrepeat + 2 * own, 2, m->mat_texrepeat + 2 * material);
          }
        } else {
          const TextureSize size{.side = m->tex_width[texture],
                                 .faces = m->tex_type[texture] == mjTEXTURE_2D ? 1 : 6};
          mjtByte* texels = m->tex_data + m->tex_adr[texture];
          Keep(texels, BytesOfTexture(m, texture));
          const std::span<uint8_t> out(texels, size.bytes());
          if (look.texture.ends_with(".png")) {
            FillTextureFromPng(
                (std::filesystem::path(directory_) / look.texture).lexically_normal().string(),
                size, out);
          } else {
            FillTexture({.kind = look.texture, .seed = look.seed}, size, out,
                        place() + ": target '" + target.name + "'");
          }
        }
      }
      m->geom_matid[g] = material;
      if (look.has_texture()) std::fill_n(colour.begin(), 3, 1.0F);
    }
    if (look.colour) {
      for (size_t k = 0; k < 3; ++k) colour[k] = (*look.colour)[k].Of(colour[k]);
    }
    if (!look.colour && !look.has_material()) continue;
    if (colour == kUnsetColour) colour[0] += 1.0F / 512;  // else the material's colour counts
    std::ranges::copy(colour, m->geom_rgba + static_cast<ptrdiff_t>(4) * g);
  }
}

bool CopyLooks(const mjModel* from, mjModel* to) {
  to->vis = from->vis;
  std::copy_n(from->geom_rgba, 4 * from->ngeom, to->geom_rgba);
  std::copy_n(from->geom_matid, from->ngeom, to->geom_matid);
  std::copy_n(from->mat_texuniform, from->nmat, to->mat_texuniform);
  std::copy_n(from->mat_texrepeat, 2 * from->nmat, to->mat_texrepeat);
  std::copy_n(from->mat_emission, from->nmat, to->mat_emission);
  std::copy_n(from->mat_specular, from->nmat, to->mat_specular);
  std::copy_n(from->mat_shininess, from->nmat, to->mat_shininess);
  std::copy_n(from->mat_reflectance, from->nmat, to->mat_reflectance);
  std::copy_n(from->mat_metallic, from->nmat, to->mat_metallic);
  std::copy_n(from->mat_roughness, from->nmat, to->mat_roughness);
  std::copy_n(from->mat_rgba, 4 * from->nmat, to->mat_rgba);
  std::copy_n(from->light_active, from->nlight, to->light_active);
  std::copy_n(from->light_pos, 3 * from->nlight, to->light_pos);
  std::copy_n(from->light_dir, 3 * from->nlight, to->light_dir);
  std::copy_n(from->light_diffuse, 3 * from->nlight, to->light_diffuse);
  std::copy_n(from->light_specular, 3 * from->nlight, to->light_specular);
  const auto roles = static_cast<size_t>(mjNTEXROLE) * static_cast<size_t>(from->nmat);
  const auto texels = static_cast<size_t>(from->ntexdata);
  if (std::equal(from->mat_texid, from->mat_texid + roles, to->mat_texid) &&
      std::equal(from->tex_data, from->tex_data + texels, to->tex_data))
    return false;
  std::copy_n(from->mat_texid, roles, to->mat_texid);
  std::copy_n(from->tex_data, texels, to->tex_data);
  return true;
}

}  // namespace robocell::internal
