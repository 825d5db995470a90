// The engine's own warnings: counts of those of a simulation (contact buffer full, bad numbers
// ...), and texts of those of a build.
//
//   EngineWarnings before = ReadWarnings(data);
//   ... steps ...
//   EngineWarnings raised = ReadWarnings(data) - before;
//   if (raised.total() > 0) LogWarn(raised.Text());  // "2 x contact buffer full; 1 x ..."
//
// The engine logs only the first warning of each kind per data; these counters count all of them. A
// reset of the data clears them. Reading does not allocate; Text does.
#pragma once

#include <mujoco/mjtype.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

struct EngineWarnings {
  std::array<int, mjNWARNING> counts{};  // indexed by mjtWarning

  int count(mjtWarning kind) const { return counts[kind]; }
  int total() const;
  // Returns "" if there is none, else "2 x contact buffer full; 1 x bad number in ctrl".
  std::string Text() const;
  bool operator==(const EngineWarnings&) const = default;
};

EngineWarnings operator-(const EngineWarnings& after, const EngineWarnings& before);

EngineWarnings ReadWarnings(const mjData* data);

// Returns a stable short key for records: "contacts_full", "bad_qpos", ...
const char* WarningName(mjtWarning kind);
// Returns the meaning in words: "contact buffer full".
const char* WarningMeaning(mjtWarning kind);

// Returns the warnings that the spec collected while it was attached to and compiled, oldest first.
std::vector<std::string> SpecWarnings(const mjSpec* spec);

}  // namespace robocell
