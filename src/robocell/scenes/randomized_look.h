// Private to scenes: the looks given for one target, and the studio's materials that show them.
#pragma once

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "robocell/spec/randomize_config.h"

namespace robocell::internal {

struct RandomizedLook {
  struct Number {
    double value = 0;
    bool is_scale = false;
    float Of(float own) const {
      const double number = is_scale ? value * static_cast<double>(own) : value;
      return static_cast<float>(std::clamp(number, 0.0, 1.0));
    }
  };
  std::optional<std::array<Number, 3>> colour = {};
  std::optional<Number> specular = {}, shininess = {}, reflectance = {};
  std::string texture = {};
  uint32_t seed = 0;

  bool has_material() const { return specular || shininess || reflectance || has_texture(); }
  bool has_texture() const { return !texture.empty() && texture != kOwnTexture; }
};

// The materials of the studio, which are given out one by one.
class StudioMaterials {
 public:
  explicit StudioMaterials(const mjModel* model);
  // Returns the material for geoms of a target that have the same one now. `is_new` tells whether it
  // has to be filled. Throws ArgumentError if there are no more.
  int Of(const std::string& target, int own, bool is_flat, bool& is_new);
  // Takes `solid` and `flat` ones for another target. Returns false, and takes none, if there are
  // fewer.
  bool Take(size_t solid, size_t flat);
  // Returns the texture that belongs to the material.
  int TextureOf(int material) const {
    return model_->mat_texid[material * mjNTEXROLE + mjTEXROLE_RGB];
  }

 private:
  const mjModel* model_;
  std::vector<int> solid_, flat_;
  std::map<std::tuple<std::string, int, bool>, int> given_;
};

}  // namespace robocell::internal
