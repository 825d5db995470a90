// What the last picture of a camera showed, and which blocks of pixels the next one changes: the
// others keep their surfaces and colours. A block's bytes are those of a picture that is drawn from
// the beginning. Internal to render/.
//
// A block has other surfaces only where something that moved was or is: within the rectangle around
// its box. It has other colours if it has other surfaces, shows something that moved, lies beside
// such a block, or reads a part of a shadow map that has changed.
//
//   SoftKept kept;
//   if (kept.Begin(scene, camera, true, true) == SoftKept::Way::kParts) {
//     ... draw what Touches() into the touched() blocks of a second buffer
//     kept.TakeSurfaces(scene.Picture(), second);
//   }
//   kept.FindColours(scene.Picture());
//   ... colour changed(), smooth smoothed()
//   kept.End();
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <Eigen/Core>

#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/render/soft_frame.h"
#include "robocell/render/soft_scene.h"

namespace robocell::internal {

// A rectangle of blocks: columns and rows.
struct SoftBlocks {
  int begin[2] = {0, 0}, end[2] = {0, 0};
};

// Sums of flags over rectangles.
class SoftSums {
 public:
  void Reserve(size_t columns, size_t rows) { sums_.reserve((columns + 1) * (rows + 1)); }
  // `flag(i)`: 0 or 1, row after row.
  template <class Flag>
  void Build(int columns, int rows, const Flag& flag) {
    stride_ = static_cast<size_t>(columns) + 1;
    sums_.resize(stride_ * (static_cast<size_t>(rows) + 1));
    for (size_t x = 0; x < stride_; ++x) sums_[x] = 0;
    size_t i = 0;
    for (int y = 0; y < rows; ++y) {
      int32_t* at = sums_.data() + stride_ * (static_cast<size_t>(y) + 1);
      const int32_t* above = at - stride_;
      int32_t in_row = at[0] = 0;
      for (int x = 0; x < columns; ++x) {
        in_row += flag(i++);
        at[x + 1] = above[x + 1] + in_row;
      }
    }
  }
  int32_t Of(int begin_x, int begin_y, int end_x, int end_y) const {
    const auto at = [&](int x, int y) {
      return sums_[static_cast<size_t>(y) * stride_ + static_cast<size_t>(x)];
    };
    if (begin_x >= end_x || begin_y >= end_y) return 0;
    return at(end_x, end_y) - at(begin_x, end_y) - at(end_x, begin_y) + at(begin_x, begin_y);
  }
  int32_t Of(const SoftBlocks& r) const { return Of(r.begin[0], r.begin[1], r.end[0], r.end[1]); }

 private:
  size_t stride_ = 0;
  std::vector<int32_t> sums_;
};

class SoftKept {
 public:
  // Forgets the last picture, but not its memory.
  void Forget() {
    has_view_ = is_whole_ = false;
    pause_ = 0;
  }

  // Returns true if the last picture was of this camera, at this place.
  bool IsOf(const CameraModel& camera) const;

  // How the next picture is drawn.
  enum class Way {
    kOnce,   // all of it; nothing is noted
    kWhole,  // all of it; notes what the next picture needs
    kParts,  // what has changed
  };
  // Compares the scene with the last picture. `may_keep`: false for scenes whose pictures are always
  // drawn once; `colours`: whether colours are drawn.
  Way Begin(const SoftScene& scene, const CameraModel& camera, bool may_keep, bool colours);

  Way way() const { return way_; }

  // Flags of the blocks in which surfaces may have changed, and the rows of blocks with such.
  std::span<const uint8_t> touched() const { return touched_; }
  SoftRows touched_rows() const { return rows_; }
  bool Touches(size_t instance) const { return sums_.Of(places_[instance]) > 0; }
  // Takes the touched blocks of another buffer.
  void TakeSurfaces(const SoftPicture& picture, const SoftBuffer& from);

  // Finds the blocks that have other colours than before; after the shadow maps were drawn.
  void FindColours(const SoftPicture& picture);
  // Flags of the blocks that are coloured, and of those whose edges are smoothed; null: all.
  const uint8_t* changed() const { return way_ != Way::kParts ? nullptr : changed_.data(); }
  const uint8_t* smoothed() const { return way_ != Way::kParts ? nullptr : smoothed_.data(); }
  // Where an instance can be seen.
  const SoftBlocks& PlaceOf(size_t instance) const { return places_[instance]; }
  // Begins the smooth colours with those of the pixels' centres.
  void BeginSmoothing();
  // Marks the slots of samples that were coloured by themselves.
  void BeginStrays(size_t slots) { stray_slots_.assign(slots, 0); }
  void MarkStrays(std::span<const SoftStray> strays);
  void EndStrays(const SoftSamples& samples);
  // The picture is complete: the next one may keep parts of it.
  void End() { is_whole_ = way_ != Way::kOnce; }

  // What is seen, and its colours: of the pixels' centres, and with smooth edges.
  SoftBuffer buffer;
  std::vector<SoftIds> colours, smooth;

 private:
  bool IsSameView(const SoftView& view, const CameraModel& camera) const;
  bool HasSameElements(const SoftScene& scene) const;
  bool HasSameLights(const SoftScene& scene) const;
  void Reserve(const SoftScene& scene, bool colours);
  void NoteAll(const SoftScene& scene, bool colours);
  void FindTouched(const SoftScene& scene);
  bool AreManyTouched() const;
  void Touch(const SoftBlocks& blocks);
  bool ShowsMoved(const SoftPicture& picture, const SoftIds& ids) const;
  void FindRuns();
  bool FindShadows(const SoftPicture& picture);
  void FindSmoothed(bool shadows_changed);
  size_t blocks() const { return buffer.nearness.size(); }

  bool has_view_ = false, is_whole_ = false;
  Way way_ = Way::kOnce;
  int pause_ = 0;  // pictures until parts are tried again
  SoftView view_;
  Eigen::Matrix<double, 3, 4> pose_;
  // Of the last picture.
  std::vector<SoftInstance> instances_;
  std::vector<SoftBlocks> places_;  // of the instances
  std::vector<int> opaque_;
  std::vector<SoftLight> lights_;
  std::vector<SoftShadow> shadows_;     // of the lights
  std::vector<uint32_t> map_drawings_;  // of the lights' maps
  SoftSky sky_;
  std::vector<uint8_t> moved_;  // flag of each instance
  SoftRows rows_;
  SoftSums sums_, tiles_;
  // Of the blocks.
  std::vector<uint8_t> touched_, changed_, smoothed_, spread_, in_run_, stray_, stray_slots_;
  std::vector<uint32_t> one_;     // the triangle that a whole block shows, or kSoftNothing
  std::vector<SoftReach> reach_;  // light after light
};

// The last pictures of a few cameras.
class SoftPictures {
 public:
  void Forget();
  // Returns the last picture of the request's camera; a camera of the model is known by its number,
  // others by their place. `colours`: whether it has colours.
  SoftKept& Of(const RenderRequest& request, const CameraModel& camera, bool colours);
  // Returns false for images of a size of which no parts are kept.
  static bool Keeps(const CameraModel& camera);

 private:
  struct Entry {
    int camera = -1;  // of the model
    bool colours = false;
    uint64_t used = 0;
    SoftKept kept;
  };
  static constexpr size_t kMost = 4;
  std::vector<std::unique_ptr<Entry>> entries_;
  uint64_t pictures_ = 0;
};

}  // namespace robocell::internal
