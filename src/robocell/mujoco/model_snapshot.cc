#include "robocell/mujoco/model_snapshot.h"

#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace robocell::internal {
namespace {

// Returns true for fields of megabytes that a renderer reads once, and not for each image.
constexpr bool IsAsset(std::string_view field) {
  for (const std::string_view beginning : {"mesh_", "hfield_data", "tex_data", "bvh_", "oct_",
                                           "skin_", "name", "path", "text_", "key_", "plugin_"}) {
    if (field.starts_with(beginning)) return true;
  }
  return false;
}

// Calls visit(pointer, bytes) with each array of `model` that is no asset; `visit` may change the
// pointer.
template <class Visit>
void ForEachArray(mjModel* model, const Visit& visit) {
  const auto each = [&](auto*& array, int64_t count) {
    void* bytes = array;
    visit(bytes, static_cast<size_t>(count) * sizeof(*array));
    array = static_cast<std::remove_reference_t<decltype(array)>>(bytes);
  };
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"  // sizes that only assets need
  MJMODEL_POINTERS_PREAMBLE(model)
#pragma GCC diagnostic pop
#define X(type, name, rows, columns) \
  if constexpr (!IsAsset(#name)) each(model->name, static_cast<int64_t>(model->rows) * (columns));
#define XNV X
  MJMODEL_POINTERS
#undef X
#undef XNV
}

constexpr size_t kAlignment = 16;

size_t Aligned(size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

ModelSnapshot::ModelSnapshot(const mjModel* model)
    : model_(std::make_unique<mjModel>()), origin_(std::make_unique<mjModel>()) {
  // Byte by byte, with the gaps between fields, so that IsOf may compare so.
  std::memcpy(static_cast<void*>(origin_.get()), model, sizeof(mjModel));
  std::memcpy(static_cast<void*>(model_.get()), model, sizeof(mjModel));
  size_t total = 0;
  ForEachArray(model_.get(), [&](void*&, size_t bytes) { total += Aligned(bytes); });
  values_.resize(total);
  std::byte* next = values_.data();
  ForEachArray(model_.get(), [&](void*& array, size_t bytes) {
    if (bytes == 0) return;
    std::memcpy(next, array, bytes);
    array = next;
    next += Aligned(bytes);
  });
}

ModelSnapshot::~ModelSnapshot() = default;

bool ModelSnapshot::IsOf(const mjModel* model) const {
  // Padding counts too: at worst it costs a snapshot that equals the last one.
  const auto bytes_of = [](const mjModel& of) { return std::as_bytes(std::span(&of, 1)); };
  if (!std::ranges::equal(bytes_of(*origin_), bytes_of(*model))) return false;
  bool same = true;
  const std::byte* next = values_.data();
  ForEachArray(origin_.get(), [&](void*& array, size_t bytes) {
    same = same && (bytes == 0 || std::memcmp(next, array, bytes) == 0);
    next += Aligned(bytes);
  });
  return same;
}

std::shared_ptr<const ModelSnapshot> ModelSnapshots::Take() {
  if (!last_ || !last_->IsOf(model_)) last_ = std::make_shared<ModelSnapshot>(model_);
  return last_;
}

}  // namespace robocell::internal
