#include "robocell/render/soft_shadows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

#include "robocell/render/soft_kernel.h"

namespace robocell::internal {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

constexpr float kWidestSpot = 160;  // degrees, as in the engine

void Store(const Affine3d& m, float* rows) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) rows[4 * r + c] = static_cast<float>(m(r, c));
  }
}

Affine3d Loaded(const float* rows) {
  Affine3d m = Affine3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) m(r, c) = rows[4 * r + c];
  }
  return m;
}

// Returns the transform from the world to the axes of a camera at the light that looks along its
// beam.
Affine3d ToLight(const mjvLight& light) {
  const Vector3d z = -Eigen::Map<const Eigen::Vector3f>(light.dir).cast<double>().normalized();
  const Vector3d other = std::abs(z.x()) < 0.5 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d x = other.cross(z).normalized();
  Affine3d in_world = Affine3d::Identity();
  in_world.linear() << x, z.cross(x), z;
  in_world.translation() = Eigen::Map<const Eigen::Vector3f>(light.pos).cast<double>();
  return in_world.inverse(Eigen::Isometry);
}

SoftView LightView(const mjModel* m, const mjvLight& light, const CameraModel& camera, int size) {
  SoftView view;
  view.width = view.height = view.bottom = size;
  view.cx = view.cy = 0.5f * static_cast<float>(size - 1);
  view.near = static_cast<float>(camera.near_m);
  view.far = static_cast<float>(camera.far_m);
  while (view.steps * static_cast<float>(size) > 0.5f * (1 << 20)) view.steps /= 2;
  view.orthographic = light.type == mjLIGHT_DIRECTIONAL;
  if (view.orthographic) {
    const double reach = m->vis.map.shadowclip * m->stat.extent;
    view.fx = static_cast<float>(0.5 * size / reach);
  } else {
    const float angle = std::min(2 * light.cutoff * m->vis.map.shadowscale, kWidestSpot);
    view.fx =
        0.5f * static_cast<float>(size) / std::tan(0.5f * angle * std::numbers::pi_v<float> / 180);
  }
  view.fy = view.fx;
  view.per_fx = view.per_fy = 1 / view.fx;
  return view;
}

void MakeToMap(const Affine3d& from_view, SoftShadow* shadow) {
  const SoftView& view = shadow->view;
  const double half = 0.5, range = 1.0 / (static_cast<double>(view.far) - view.near);
  Eigen::Matrix<double, 3, 4> rows = from_view.affine();
  rows.row(0) *= view.fx;
  rows.row(1) *= -view.fy;
  rows.row(2) *= -1;
  if (view.orthographic) {
    rows(0, 3) += view.cx - half;
    rows(1, 3) += view.cy - half;
    rows.row(2) *= -range;
    rows(2, 3) += view.far * range;
  }
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) shadow->to_map[4 * r + c] = static_cast<float>(rows(r, c));
  }
}

float Background(const SoftView& view) { return view.orthographic ? 0.0f : 1 / view.far; }

// Makes room for the map. A new one is marked as drawn, so that it is emptied.
void FitMap(const SoftView& view, SoftShadowMap* map) {
  SoftBuffer& buffer = map->buffer;
  if (buffer.width == view.width && map->background == Background(view) &&
      !buffer.nearness.empty()) {
    return;
  }
  FitNearness(view, &buffer);
  map->background = Background(view);
  map->tile_columns = (buffer.columns + kSoftTile - 1) / kSoftTile;
  map->tile_rows = (buffer.rows + kSoftTile - 1) / kSoftTile;
  const auto tiles = static_cast<size_t>(map->tile_columns) * static_cast<size_t>(map->tile_rows);
  map->drawn.assign(tiles, 1);
  map->changed.assign(tiles, 0);
  int32_t size = 0;
  for (int level = 0, columns = map->tile_columns, rows = map->tile_rows; level < kSoftTileLevels;
       ++level, columns = (columns + 1) / 2, rows = (rows + 1) / 2) {
    map->level_start[level] = size;
    map->level_columns[level] = columns;
    map->level_rows[level] = rows;
    size += columns * rows;
  }
  map->nearest.resize(static_cast<size_t>(size));
  map->farthest.resize(static_cast<size_t>(size));
}

// Takes the limits of a rectangle of tiles over to the further levels.
void SummariseLevels(SoftTiles part, SoftShadowMap* map) {
  for (int level = 1; level < kSoftTileLevels; ++level) {
    const int limit[2] = {map->level_columns[level - 1], map->level_rows[level - 1]};
    for (int c = 0; c < 2; ++c) {
      part.begin[c] /= 2;
      part.end[c] = (part.end[c] + 1) / 2;
    }
    for (int y = part.begin[1]; y < part.end[1]; ++y) {
      for (int x = part.begin[0]; x < part.end[0]; ++x) {
        const int x1 = std::min(2 * x + 1, limit[0] - 1), y1 = std::min(2 * y + 1, limit[1] - 1);
        const int to = map->level_start[level] + y * map->level_columns[level] + x;
        const auto choose = [&](std::vector<float>& limits, const auto& better) {
          const float* from = limits.data() + map->level_start[level - 1];
          const auto at = [&](int column, int row) { return from[row * limit[0] + column]; };
          limits[to] =
              better(better(at(2 * x, 2 * y), at(x1, 2 * y)), better(at(2 * x, y1), at(x1, y1)));
        };
        choose(map->nearest, [](float a, float b) { return std::max(a, b); });
        choose(map->farthest, [](float a, float b) { return std::min(a, b); });
      }
    }
  }
}

// Empties what was drawn in some rows of tiles, within the columns of `part`; the rest is empty
// already.
void ClearTiles(SoftRows rows, const SoftTiles& part, SoftShadowMap* map) {
  SoftBuffer& buffer = map->buffer;
  SoftNumbers empty;
  std::fill_n(empty.at, kSoftPixels, map->background);
  for (int y = rows.begin; y < rows.end; ++y) {
    const size_t first_tile = static_cast<size_t>(y) * static_cast<size_t>(map->tile_columns);
    for (int x = part.begin[0]; x < part.end[0]; ++x) {
      if (!map->drawn[first_tile + static_cast<size_t>(x)]) continue;
      const int begin = kSoftTile * x, end = std::min(buffer.columns, begin + kSoftTile);
      for (int row = kSoftTile * y; row < std::min(buffer.rows, kSoftTile * (y + 1)); ++row) {
        const auto first = buffer.nearness.begin() + static_cast<ptrdiff_t>(row) * buffer.columns;
        std::fill(first + begin, first + end, empty);
      }
    }
  }
}

// Returns the tiles in which the instance may be drawn: those around its box.
SoftTiles TilesOf(const SoftView& view, const SoftInstance& instance, const SoftShadowMap& map) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_view;
  const auto side = static_cast<float>(view.width);
  float low[2] = {side, side}, high[2] = {0, 0};
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3f corner(k & 1 ? mesh.low.x() : mesh.high.x(),
                                 k & 2 ? mesh.low.y() : mesh.high.y(),
                                 k & 4 ? mesh.low.z() : mesh.high.z());
    const auto row = [&](int r) {
      return m[4 * r] * corner.x() + m[4 * r + 1] * corner.y() + m[4 * r + 2] * corner.z() +
             m[4 * r + 3];
    };
    const float depth = -row(2);
    if (!view.orthographic && depth < view.near) {  // anywhere
      low[0] = low[1] = 0;
      high[0] = high[1] = side;
      break;
    }
    const float shrink = view.orthographic ? 1 : 1 / depth;
    const float at[2] = {row(0) * view.fx * shrink + view.cx, view.cy - row(1) * view.fy * shrink};
    for (int c = 0; c < 2; ++c) {
      low[c] = std::min(low[c], at[c] - 2);
      high[c] = std::max(high[c], at[c] + 2);
    }
  }
  SoftTiles tiles;
  const int count[2] = {map.tile_columns, map.tile_rows};
  constexpr float kPerTile = 1.0f / (kSoftTile * kSoftBlock);
  for (int c = 0; c < 2; ++c) {
    if (high[c] < 0 || low[c] > side) return {};
    tiles.begin[c] = static_cast<int>(std::clamp(low[c], 0.0f, side) * kPerTile);
    tiles.end[c] =
        std::min(count[c], static_cast<int>(std::clamp(high[c], 0.0f, side) * kPerTile) + 1);
  }
  return tiles;
}

// Sets the value of some tiles.
template <class T>
void MarkTiles(const SoftTiles& tiles, const SoftShadowMap& map, T value, std::vector<T>* values) {
  for (int y = tiles.begin[1]; y < tiles.end[1]; ++y) {
    for (int x = tiles.begin[0]; x < tiles.end[0]; ++x) {
      (*values)[static_cast<size_t>(y) * static_cast<size_t>(map.tile_columns) +
                static_cast<size_t>(x)] = value;
    }
  }
}

bool Same(const SoftView& a, const SoftView& b) {
  return a.width == b.width && a.orthographic == b.orthographic && a.fx == b.fx &&
         a.near == b.near && a.far == b.far;
}

}  // namespace

bool SoftTiles::Meets(const SoftTiles& other) const {
  for (int c = 0; c < 2; ++c) {
    if (std::max(begin[c], other.begin[c]) >= std::min(end[c], other.end[c])) return false;
  }
  return true;
}

void SoftTiles::Extend(const SoftTiles& other) {
  if (other.empty()) return;
  if (empty()) return void(*this = other);
  for (int c = 0; c < 2; ++c) {
    begin[c] = std::min(begin[c], other.begin[c]);
    end[c] = std::max(end[c], other.end[c]);
  }
}

bool SoftShadows::Caster::operator==(const Caster& other) const {
  return mesh == other.mesh && !bends && !other.bends &&
         std::equal(in_world, in_world + 12, other.in_world);
}

void SoftShadows::Clear() {
  // Their memory stays: a model comes with every episode, and repeatedly freed megabytes leave
  // holes in the heap.
  for (Map& map : maps_) map.drawn = false;
  used_ = 0;
}

void SoftShadows::Begin(const mjModel* model, const mjvScene& list, const CameraModel& camera,
                        int size) {
  maps_.resize(std::max<size_t>(maps_.size(), 1));
  maps_.reserve(mjMAXLIGHT);
  used_ = 0;
  casters_.clear();
  for (int i = 0; i < list.nlight; ++i) {
    const mjvLight& light = list.lights[i];
    if (!light.castshadow || light.headlight || light.type == mjLIGHT_IMAGE) continue;
    if (static_cast<size_t>(used_) == maps_.size()) maps_.emplace_back();
    Map& map = maps_[static_cast<size_t>(used_++)];
    map.light = i;
    map.to_light = ToLight(light);
    map.shadow.view = LightView(model, light, camera, size);
    const Affine3d to_camera(Affine3d(Eigen::Translation3d(camera.camera_in_world.translation()) *
                                      camera.camera_in_world.rotation())
                                 .inverse(Eigen::Isometry));
    MakeToMap(map.to_light * to_camera.inverse(Eigen::Isometry), &map.shadow);
    map.shadow.map = &map.map;
  }
}

void SoftShadows::AddCaster(const SoftMesh* mesh, const Affine3d& in_world, bool bends) {
  Caster& caster = casters_.emplace_back();
  caster.mesh = mesh;
  caster.bends = bends;
  Store(in_world, caster.in_world);
}

SoftInstance SoftShadows::InLight(const Caster& caster, const Map& map) {
  SoftInstance instance;
  instance.mesh = caster.mesh;
  const Affine3d to_view = map.to_light * Loaded(caster.in_world);
  Store(to_view, instance.to_view);
  // All faces cast; for a closed mesh those towards the light are the nearest.
  instance.side = caster.mesh->closed ? SoftSide::kFront : SoftSide::kBoth;
  const bool far_away = map.shadow.view.orthographic;
  const Affine3d to_mesh = to_view.inverse(Eigen::Affine);
  const Vector3d eye =
      far_away ? Vector3d(to_mesh.linear().col(2)) : Vector3d(to_mesh.translation());
  for (int k = 0; k < 3; ++k) instance.eye[k] = static_cast<float>(eye[k]);
  instance.eye[3] = far_away ? 0 : 1;
  return instance;
}

void SoftShadows::Draw(SoftThreads* threads) {
  for (int i = 0; i < used_; ++i) {
    Map& map = maps_[static_cast<size_t>(i)];
    // Single precision would miss motions that a new map shows.
    const bool is_same_light = map.drawn && Same(map.shadow.view, map.drawn_view) &&
                               map.to_light.matrix() == map.drawn_to_light.matrix();
    if (is_same_light && casters_ == map.drawn_casters) continue;
    DrawMap(threads, is_same_light, &map);
    map.drawn = true;
    map.drawn_to_light = map.to_light;
    map.drawn_view = map.shadow.view;
    map.drawn_casters = casters_;
  }
}

// The nearness of a map is that of the nearest caster, in whatever order they are drawn. So where
// nothing has moved, the map may stay; casters that reach into the other part are drawn once more.
void SoftShadows::DrawMap(SoftThreads* threads, bool is_same_light, Map* map) const {
  const SoftView& whole = map->shadow.view;
  SoftShadowMap& pixels = map->map;
  FitMap(whole, &pixels);
  const bool is_partial = is_same_light && casters_.size() == map->drawn_casters.size();
  SoftTiles part;  // what is drawn again
  ++pixels.drawings;
  const auto changes = [&](const SoftTiles& tiles) {
    part.Extend(tiles);
    MarkTiles(tiles, pixels, pixels.drawings, &pixels.changed);
  };
  map->instances.resize(casters_.size());
  map->tiles.resize(casters_.size());
  for (size_t i = 0; i < casters_.size(); ++i) {
    if (is_partial && casters_[i] == map->drawn_casters[i]) continue;
    if (is_partial) changes(map->tiles[i]);
    map->instances[i] = InLight(casters_[i], *map);
    map->tiles[i] = TilesOf(whole, map->instances[i], pixels);
    changes(map->tiles[i]);
  }
  if (!is_partial) changes({{0, 0}, {pixels.tile_columns, pixels.tile_rows}});
  if (part.empty()) return;
  // Bands count from 0.
  const int tile_rows = part.end[1] - part.begin[1];
  const auto from = [](SoftRows rows, int first) {
    return SoftRows{first + rows.begin, first + rows.end};
  };
  threads->InBands(
      tile_rows, [&](SoftRows rows, int) { ClearTiles(from(rows, part.begin[1]), part, &pixels); });
  if (!is_partial) std::ranges::fill(pixels.drawn, uint8_t{0});
  for (const SoftTiles& tiles : map->tiles) MarkTiles(tiles, pixels, uint8_t{1}, &pixels.drawn);
  const int first_row = kSoftTile * part.begin[1];
  const int end_row = std::min(pixels.buffer.rows, kSoftTile * part.end[1]);
  threads->InBands(end_row - first_row, [&](SoftRows rows, int band) {
    const SoftView view = RowsOf(whole, from(rows, first_row));
    for (size_t i = 0; i < map->instances.size(); ++i) {
      if (map->tiles[i].Meets(part))
        DrawInstance(view, map->instances[i], threads->scratch(band), &pixels.buffer);
    }
  });
  // The limits of a tile cover its neighbours.
  const int first_tile = std::max(0, part.begin[1] - 1);
  threads->InBands(part.end[1] - first_tile,
                   [&](SoftRows rows, int) { SummariseMap(&pixels, from(rows, first_tile)); });
  SummariseLevels({{0, first_tile}, {pixels.tile_columns, part.end[1]}}, &pixels);
}

const SoftShadow* SoftShadows::Of(int light) const {
  for (int i = 0; i < used_; ++i) {
    const Map& map = maps_[static_cast<size_t>(i)];
    if (map.light == light) return &map.shadow;
  }
  return nullptr;
}

}  // namespace robocell::internal
