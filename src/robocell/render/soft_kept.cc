#include "robocell/render/soft_kept.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>
#include <variant>

#include "robocell/render/soft_kernel.h"

namespace robocell::internal {
namespace {

// Runs of at least this many blocks are coloured together (soft_run-inl.h).
constexpr int kShortestRun = 4;
// Samples lie up to half a pixel beside the centres, and corners are rounded.
constexpr float kBeside = 2;

// Of larger images no parts are kept: their memory would be.
constexpr int64_t kMostPixels = 1 << 20;
// Numbers of cameras that are none of the model, and of all that draw large images.
constexpr int kFree = -1, kLarge = -2;

// If a larger share of the blocks is touched, parts cost more than the whole: that many pictures are
// then drawn without a try.
constexpr double kMostTouched = 1.0 / 3;
constexpr int kPause = 8;

// 0 and -0 are different: they may lead to different bytes.
bool HasSameBits(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
    return std::bit_cast<uint32_t>(x) == std::bit_cast<uint32_t>(y);
  });
}
bool HasSameBits(float a, float b) {
  return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b);
}

bool IsSame(const SoftView& a, const SoftView& b) {
  const float of_a[] = {a.fx, a.fy, a.cx, a.cy, a.near, a.far, a.per_fx, a.per_fy, a.steps},
              of_b[] = {b.fx, b.fy, b.cx, b.cy, b.near, b.far, b.per_fx, b.per_fy, b.steps};
  return a.width == b.width && a.height == b.height && a.orthographic == b.orthographic &&
         a.top == b.top && a.bottom == b.bottom && HasSameBits(of_a, of_b);
}

bool IsSame(const SoftMaterial& a, const SoftMaterial& b) {
  return a.shines == b.shines && a.texture == b.texture && a.mapping == b.mapping &&
         HasSameBits(a.rgba, b.rgba) && HasSameBits(a.emission, b.emission) &&
         HasSameBits(a.specular, b.specular) && HasSameBits(a.shininess, b.shininess) &&
         HasSameBits(a.least_shine, b.least_shine) && HasSameBits(a.scale, b.scale) &&
         HasSameBits(a.offset, b.offset);
}

bool IsSame(const SoftInstance& a, const SoftInstance& b) {
  return HasSameBits(a.to_view, b.to_view) && HasSameBits(a.to_mesh, b.to_mesh) &&
         HasSameBits(a.eye, b.eye) && HasSameBits(a.own, b.own) && a.side == b.side &&
         a.body == b.body && a.segment == b.segment && IsSame(a.material, b.material);
}

bool IsSame(const SoftLight& a, const SoftLight& b) {
  return a.directional == b.directional && a.shines == b.shines && a.shadow == b.shadow &&
         a.everywhere == b.everywhere && HasSameBits(a.direction, b.direction) &&
         HasSameBits(a.position, b.position) && HasSameBits(a.attenuation, b.attenuation) &&
         HasSameBits(a.cutoff_cosine, b.cutoff_cosine) && HasSameBits(a.exponent, b.exponent) &&
         HasSameBits(a.ambient, b.ambient) && HasSameBits(a.diffuse, b.diffuse) &&
         HasSameBits(a.specular, b.specular);
}

bool IsSame(const SoftShadow& a, const SoftShadow& b) {
  return a.map == b.map && IsSame(a.view, b.view) && HasSameBits(a.to_map, b.to_map);
}

bool IsSame(const SoftSky& a, const SoftSky& b) {
  return a.texture == b.texture && HasSameBits(a.from_view, b.from_view) &&
         HasSameBits(a.radius, b.radius) && HasSameBits(a.elevation, b.elevation) &&
         HasSameBits(a.to_plane, b.to_plane) && HasSameBits(a.haze, b.haze) &&
         HasSameBits(a.haze_rgb, b.haze_rgb) && HasSameBits(a.haze_height, b.haze_height);
}

Eigen::Matrix<double, 3, 4> PoseOf(const CameraModel& camera) {
  Eigen::Matrix<double, 3, 4> pose;
  pose << camera.camera_in_world.rotation(), camera.camera_in_world.translation();
  return pose;
}

// Returns the blocks in which an instance may be seen: those around its box.
SoftBlocks BlocksOf(const SoftView& view, const SoftInstance& instance, const SoftBuffer& buffer) {
  const SoftMesh& mesh = *instance.mesh;
  const float* m = instance.to_view;
  const float sides[2] = {static_cast<float>(view.width), static_cast<float>(view.height)};
  float low[2] = {sides[0], sides[1]}, high[2] = {0, 0};
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
      return {{0, 0}, {buffer.columns, buffer.rows}};
    }
    const float shrink = view.orthographic ? 1 : 1 / depth;
    const float at[2] = {row(0) * view.fx * shrink + view.cx, view.cy - row(1) * view.fy * shrink};
    for (int c = 0; c < 2; ++c) {
      low[c] = std::min(low[c], at[c] - kBeside);
      high[c] = std::max(high[c], at[c] + kBeside);
    }
  }
  SoftBlocks blocks;
  const int count[2] = {buffer.columns, buffer.rows};
  constexpr float kPerBlock = 1.0f / kSoftBlock;
  for (int c = 0; c < 2; ++c) {
    if (high[c] < 0 || low[c] > sides[c]) return {};
    blocks.begin[c] = static_cast<int>(std::clamp(low[c], 0.0f, sides[c]) * kPerBlock);
    blocks.end[c] =
        std::min(count[c], static_cast<int>(std::clamp(high[c], 0.0f, sides[c]) * kPerBlock) + 1);
  }
  return blocks;
}

template <class T>
bool Differ(const T& a, const T& b) {
  uint32_t different = 0;
  for (int k = 0; k < kSoftPixels; ++k) {
    different |= std::bit_cast<uint32_t>(a.at[k]) ^ std::bit_cast<uint32_t>(b.at[k]);
  }
  return different != 0;
}

}  // namespace

bool SoftKept::IsOf(const CameraModel& camera) const {
  return has_view_ && view_.width == camera.width && view_.height == camera.height &&
         PoseOf(camera) == pose_;
}

bool SoftKept::IsSameView(const SoftView& view, const CameraModel& camera) const {
  return IsSame(view, view_) && PoseOf(camera) == pose_;
}

bool SoftKept::HasSameElements(const SoftScene& scene) const {
  const auto now = scene.instances();
  return std::ranges::equal(now, instances_,
                            [](const SoftInstance& a, const SoftInstance& b) {
                              return a.mesh == b.mesh && a.first_id == b.first_id;
                            }) &&
         std::ranges::equal(scene.opaque(), opaque_);
}

bool SoftKept::HasSameLights(const SoftScene& scene) const {
  const auto now = scene.lights();
  if (now.size() != lights_.size() || !IsSame(scene.sky(), sky_)) return false;
  for (size_t i = 0; i < now.size(); ++i) {
    if (!IsSame(now[i], lights_[i])) return false;
    if (now[i].shadow && !IsSame(*now[i].shadow, shadows_[i])) return false;
  }
  return true;
}

SoftKept::Way SoftKept::Begin(const SoftScene& scene, const CameraModel& camera, bool may_keep,
                              bool colours) {
  const SoftView& view = scene.view();
  const bool is_same_view = std::exchange(has_view_, true) && IsSameView(view, camera);
  const bool was_whole = std::exchange(is_whole_, false);
  view_ = view;
  pose_ = PoseOf(camera);
  if (!is_same_view) pause_ = 0;
  if (!may_keep || !is_same_view || pause_ > 0) {
    way_ = Way::kOnce;
    pause_ = std::max(0, pause_ - 1);
    if (may_keep) Reserve(scene, colours);
  } else if (was_whole && HasSameElements(scene) && (!colours || HasSameLights(scene))) {
    way_ = Way::kParts;
    FindTouched(scene);
    if (AreManyTouched()) {
      way_ = Way::kOnce;
      pause_ = kPause;
    }
  } else {
    way_ = Way::kWhole;
    NoteAll(scene, colours);
  }
  return way_;
}

// Reserves what the next pictures need, so that they allocate nothing. Memory that is reserved and not
// used costs nothing: a camera that moves never uses it.
void SoftKept::Reserve(const SoftScene& scene, bool colours) {
  const auto columns = static_cast<size_t>((view_.width + kSoftBlock - 1) / kSoftBlock),
             rows = static_cast<size_t>((view_.height + kSoftBlock - 1) / kSoftBlock);
  const size_t all = columns * rows, elements = scene.instances().size();
  instances_.reserve(elements);
  places_.reserve(elements);
  opaque_.reserve(elements);
  moved_.reserve(elements);
  sums_.Reserve(columns, rows);
  for (auto* flags : {&touched_, &changed_, &smoothed_, &spread_, &in_run_, &stray_, &stray_slots_})
    flags->reserve(all);
  if (!colours) return;
  size_t maps = 0;
  for (const SoftLight& light : scene.lights()) {
    if (!light.shadow) continue;
    ++maps;
    const auto side = static_cast<size_t>(light.shadow->view.width) / (kSoftTile * kSoftBlock) + 1;
    tiles_.Reserve(side, side);
  }
  lights_.reserve(scene.lights().size());
  shadows_.reserve(scene.lights().size());
  map_drawings_.reserve(scene.lights().size());
  reach_.reserve(maps * all);
  one_.reserve(all);
  this->colours.reserve(all);
  smooth.reserve(all);
}

void SoftKept::NoteAll(const SoftScene& scene, bool colours) {
  FitBuffer(view_, &buffer);
  instances_.assign(scene.instances().begin(), scene.instances().end());
  opaque_.assign(scene.opaque().begin(), scene.opaque().end());
  places_.resize(instances_.size());
  for (const int i : opaque_) {
    const auto at = static_cast<size_t>(i);
    places_[at] = BlocksOf(view_, instances_[at], buffer);
  }
  if (!colours) return;
  lights_.assign(scene.lights().begin(), scene.lights().end());
  shadows_.resize(lights_.size());
  map_drawings_.resize(lights_.size());
  size_t maps = 0;
  for (size_t i = 0; i < lights_.size(); ++i) {
    if (!lights_[i].shadow) continue;
    shadows_[i] = *lights_[i].shadow;
    ++maps;
  }
  sky_ = scene.sky();
  reach_.resize(maps * blocks());
  one_.resize(blocks());
  in_run_.resize(blocks());
  stray_.assign(blocks(), 0);
}

void SoftKept::Touch(const SoftBlocks& part) {
  if (part.begin[0] >= part.end[0]) return;
  for (int y = part.begin[1]; y < part.end[1]; ++y) {
    std::memset(touched_.data() + static_cast<size_t>(y) * static_cast<size_t>(buffer.columns) +
                    part.begin[0],
                1, static_cast<size_t>(part.end[0] - part.begin[0]));
  }
  rows_.begin = std::min(rows_.begin, part.begin[1]);
  rows_.end = std::max(rows_.end, part.end[1]);
}

void SoftKept::FindTouched(const SoftScene& scene) {
  const auto now = scene.instances();
  touched_.assign(blocks(), 0);
  changed_.assign(blocks(), 0);
  moved_.assign(now.size(), 0);
  rows_ = {buffer.rows, 0};
  for (const int i : opaque_) {
    const auto at = static_cast<size_t>(i);
    if (!scene.Bends(now[at].mesh) && IsSame(now[at], instances_[at])) continue;
    moved_[at] = 1;
    instances_[at] = now[at];
    Touch(places_[at]);
    places_[at] = BlocksOf(view_, now[at], buffer);
    Touch(places_[at]);
  }
  sums_.Build(buffer.columns, buffer.rows, [&](size_t i) { return touched_[i]; });
}

bool SoftKept::AreManyTouched() const {
  const int32_t touched = sums_.Of(0, 0, buffer.columns, buffer.rows);
  return kMostTouched * static_cast<double>(blocks()) < touched;
}

bool SoftKept::ShowsMoved(const SoftPicture& picture, const SoftIds& ids) const {
  uint32_t last = kSoftNothing;
  for (const uint32_t id : ids.at) {
    if (id == kSoftNothing || id == last) continue;
    last = id;
    if (moved_[static_cast<size_t>(picture.instance_of_run[id >> kSoftRunBits])]) return true;
  }
  return false;
}

void SoftKept::TakeSurfaces(const SoftPicture& picture, const SoftBuffer& from) {
  const auto columns = static_cast<size_t>(buffer.columns);
  for (size_t b = columns * static_cast<size_t>(rows_.begin),
              end = columns * static_cast<size_t>(std::max(rows_.begin, rows_.end));
       b < end; ++b) {
    if (!touched_[b]) continue;
    const bool other =
        Differ(buffer.ids[b], from.ids[b]) || Differ(buffer.nearness[b], from.nearness[b]);
    changed_[b] = other || ShowsMoved(picture, from.ids[b]);
    if (!other) continue;
    buffer.nearness[b] = from.nearness[b];
    buffer.ids[b] = from.ids[b];
  }
}

void SoftKept::FindColours(const SoftPicture& picture) {
  if (way_ == Way::kOnce) return;
  const bool shadows_changed = FindShadows(picture);
  FindRuns();
  if (way_ == Way::kParts) FindSmoothed(shadows_changed);
}

// Marks the blocks that read a part of a shadow map that was drawn again. Returns whether a map was.
bool SoftKept::FindShadows(const SoftPicture& picture) {
  bool any = false;
  size_t maps = 0;
  for (size_t l = 0; l < lights_.size(); ++l) {
    if (!lights_[l].shadow) continue;
    const std::span<SoftReach> reach(reach_.data() + maps++ * blocks(), blocks());
    FindReach(picture, buffer, {0, buffer.rows}, changed(), shadows_[l], reach);
  }
  maps = 0;
  for (size_t l = 0; l < lights_.size(); ++l) {
    if (!lights_[l].shadow) continue;
    const SoftReach* reach = reach_.data() + maps++ * blocks();
    const SoftShadowMap& map = *shadows_[l].map;
    const uint32_t before = std::exchange(map_drawings_[l], map.drawings);
    if (way_ != Way::kParts || before == map.drawings) continue;
    any = true;
    tiles_.Build(map.tile_columns, map.tile_rows,
                 [&](size_t i) { return map.changed[i] > before ? 1 : 0; });
    for (size_t b = 0; b < blocks(); ++b) {
      const SoftReach& r = reach[b];
      changed_[b] |= tiles_.Of(r.begin[0], r.begin[1], r.end[0], r.end[1]) > 0;
    }
  }
  return any;
}

// A block that comes to lie in a run, or no longer does, has other colours.
void SoftKept::FindRuns() {
  const int columns = buffer.columns;
  for (int y = 0; y < buffer.rows; ++y) {
    const size_t start = static_cast<size_t>(y) * static_cast<size_t>(columns);
    uint8_t* of_row = way_ == Way::kParts ? changed_.data() + start : nullptr;
    if (of_row && !std::memchr(of_row, 1, static_cast<size_t>(columns))) continue;
    uint32_t* one = one_.data() + start;
    for (int x = 0; x < columns; ++x) {
      if (of_row && !of_row[x]) continue;
      const SoftIds& ids = buffer.ids[start + static_cast<size_t>(x)];
      uint32_t different = 0;
      for (const uint32_t id : ids.at) different |= id ^ ids.at[0];
      one[x] = different == 0 ? ids.at[0] : kSoftNothing;
    }
    for (int x = 0; x < columns;) {
      int end = x + 1;
      while (end < columns && one[end] == one[x]) ++end;
      const uint8_t is_run = one[x] != kSoftNothing && end - x >= kShortestRun;
      for (; x < end; ++x) {
        uint8_t& was_run = in_run_[start + static_cast<size_t>(x)];
        if (std::exchange(was_run, is_run) != is_run && of_row) of_row[x] = 1;
      }
    }
  }
}

// Samples take colours from the pixels beside theirs.
void SoftKept::FindSmoothed(bool shadows_changed) {
  const auto columns = static_cast<size_t>(buffer.columns), rows = static_cast<size_t>(buffer.rows);
  spread_.resize(blocks());
  smoothed_.resize(blocks());
  for (size_t y = 0; y < rows; ++y) {
    const uint8_t* from = changed_.data() + columns * y;
    uint8_t* to = spread_.data() + columns * y;
    for (size_t x = 0; x < columns; ++x) {
      to[x] = from[x] | (x > 0 ? from[x - 1] : 0) | (x + 1 < columns ? from[x + 1] : 0);
    }
  }
  for (size_t b = 0; b < blocks(); ++b) {
    uint8_t all = spread_[b] | touched_[b];
    if (b >= columns) all |= spread_[b - columns];
    if (b + columns < blocks()) all |= spread_[b + columns];
    if (shadows_changed) all |= stray_[b];
    smoothed_[b] = all;
  }
}

void SoftKept::BeginSmoothing() {
  if (way_ != Way::kParts) {
    smooth = colours;
    return;
  }
  for (size_t b = 0; b < blocks(); ++b) {
    if (smoothed_[b]) smooth[b] = colours[b];
  }
}

void SoftKept::MarkStrays(std::span<const SoftStray> strays) {
  for (const SoftStray& stray : strays) stray_slots_[static_cast<size_t>(stray.slot)] = 1;
}

void SoftKept::EndStrays(const SoftSamples& samples) {
  for (size_t b = 0; b < blocks(); ++b) {
    if (way_ == Way::kParts && !smoothed_[b]) continue;
    const int32_t slot = samples.slots[b];
    stray_[b] = slot >= 0 ? stray_slots_[static_cast<size_t>(slot)] : 0;
  }
}

void SoftPictures::Forget() {
  for (const auto& entry : entries_) entry->kept.Forget();
}

bool SoftPictures::Keeps(const CameraModel& camera) {
  return static_cast<int64_t>(camera.width) * camera.height <= kMostPixels;
}

SoftKept& SoftPictures::Of(const RenderRequest& request, const CameraModel& camera, bool colours) {
  const auto* of_model = std::get_if<ModelCamera>(&request.camera);
  const int number = !Keeps(camera) ? kLarge : of_model ? of_model->id : kFree;
  Entry* found = nullptr;
  for (const auto& entry : entries_) {
    if (entry->camera == number && entry->colours == colours &&
        (number != kFree || entry->kept.IsOf(camera))) {
      found = entry.get();
    }
  }
  if (!found && entries_.size() < kMost) {
    found = entries_.emplace_back(std::make_unique<Entry>()).get();
  } else if (!found) {
    found = std::ranges::min_element(entries_, {}, [](const auto& entry) {
              return entry->used;
            })->get();
    found->kept.Forget();
  }
  found->camera = number;
  found->colours = colours;
  found->used = ++pictures_;
  return found->kept;
}

}  // namespace robocell::internal
