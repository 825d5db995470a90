// Colours that instructions name.
#pragma once

#include <array>

#include "robocell/spec/types.h"

namespace robocell::internal {

struct NamedColour {
  const char* word;
  Vec4 rgba;
};

inline constexpr std::array kNamedColours = {
    NamedColour{"red", {0.85, 0.2, 0.15, 1}},   NamedColour{"blue", {0.15, 0.35, 0.85, 1}},
    NamedColour{"green", {0.2, 0.6, 0.25, 1}},  NamedColour{"yellow", {0.95, 0.75, 0.15, 1}},
    NamedColour{"purple", {0.55, 0.3, 0.7, 1}}, NamedColour{"white", {0.9, 0.9, 0.88, 1}}};

}  // namespace robocell::internal
