// The relations of tasks for two arms. What they remember of an episode is in their memory.
//
//   | sentence               | holds if                                                            |
//   | A handed_over          | one arm alone holds A, and another one held it alone before, since  |
//   |                        | when nothing but arms has touched it                                |
//   | A carried B [angle]    | A lies in region B, and two arms at least have lifted it and brought |
//   |                        | it there, never tilted by more than `angle` (0.3 rad)                |
//
// Both are goals only, and need a scene with two arms that have grippers: else binding them throws
// ArgumentError.
#pragma once

#include "robocell/scenes/relations.h"

namespace robocell::internal {

RelationKind HandedOverRelation();
RelationKind CarriedRelation();

}  // namespace robocell::internal
