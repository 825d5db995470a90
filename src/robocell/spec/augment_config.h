// AugmentConfig: `augment:` of a run: episodes are made from those of another dataset, moved to new
// starts, instead of by the task's expert (docs/augment.md).
//
//   augment: {dataset: out/teleop, translation_noise: 0.001}
#pragma once

#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

struct AugmentConfig {
  std::string dataset = {};
  NameList episodes = {};
  double translation_noise = 0.002;
  double rotation_noise = 0.01;

  static constexpr const char* kTypeName = "AugmentConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = AugmentConfig;
    v("dataset", &T::dataset,
      "Dataset with the source episodes, relative to the working folder. Its content identifies "
      "the run, not its path.");
    v("episodes", &T::episodes, "Ids of the source episodes. Unset: all successful ones.");
    v("translation_noise", &T::translation_noise,
      "Largest displacement of a replayed part from its place at the object, metres, drawn anew "
      "for each part.",
      Bound::kNonNegative);
    v("rotation_noise", &T::rotation_noise, "Largest rotation of a replayed part, radians.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
