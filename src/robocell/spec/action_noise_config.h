// ActionNoiseConfig: `noise:` of a run: bounded noise on the arms' actions, and displaced starts, so
// that episodes show how to come back (docs/augment.md, after M. Laskey et al., "DART: Noise
// Injection for Robust Imitation Learning", 2017).
//
//   noise: {translation: 0.005, rotation: 0.03, start_translation: 0.1}
#pragma once

#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

struct ActionNoiseConfig {
  double translation = 0;
  double rotation = 0;
  double correlation_seconds = 0.3;
  double start_translation = 0;
  double start_rotation = 0;

  static constexpr const char* kTypeName = "ActionNoiseConfig";
  template <class V>
  static void Fields(V&& v) {
    using T = ActionNoiseConfig;
    v("translation", &T::translation,
      "Largest displacement of the TCP's target by the noise, metres.", Bound::kNonNegative);
    v("rotation", &T::rotation, "Largest rotation of the TCP's target by the noise, radians.",
      Bound::kNonNegative);
    v("correlation_seconds", &T::correlation_seconds,
      "Time after which the noise has forgotten most of its value, seconds. 0: each action has its "
      "own.",
      Bound::kNonNegative);
    v("start_translation", &T::start_translation,
      "Largest displacement of the TCP at the start of an episode, metres.", Bound::kNonNegative);
    v("start_rotation", &T::start_rotation,
      "Largest rotation of the TCP at the start of an episode, radians.", Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
