// What moves as one (LinkInertia), in other frames and put together.
#pragma once

#include "robocell/kinematics/chain_model.h"

namespace robocell {

// What is known in a frame, in another one that stands in it like this.
LinkInertia InFrame(const Transform& frame, const LinkInertia& link);

// Both known in the same frame.
LinkInertia& operator+=(LinkInertia& link, const LinkInertia& more);
LinkInertia& operator-=(LinkInertia& link, const LinkInertia& less);

}  // namespace robocell
