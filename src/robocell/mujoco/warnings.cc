#include "robocell/mujoco/warnings.h"

#include <mujoco/mujoco.h>

#include <numeric>

namespace robocell {
namespace {

struct Words {
  const char* name;
  const char* meaning;
};

constexpr std::array<Words, mjNWARNING> kWords = {{
    {"singular_inertia", "(near) singular inertia matrix"},
    {"contacts_full", "contact buffer full"},
    {"constraints_full", "constraint buffer full"},
    {"bad_qpos", "bad number in qpos"},
    {"bad_qvel", "bad number in qvel"},
    {"bad_qacc", "bad number in qacc"},
    {"bad_ctrl", "bad number in ctrl"},
}};

}  // namespace

int EngineWarnings::total() const { return std::accumulate(counts.begin(), counts.end(), 0); }

std::string EngineWarnings::Text() const {
  std::string text;
  for (int kind = 0; kind < mjNWARNING; ++kind) {
    if (counts[kind] == 0) continue;
    text +=
        (text.empty() ? "" : "; ") + std::to_string(counts[kind]) + " x " + kWords[kind].meaning;
  }
  return text;
}

EngineWarnings operator-(const EngineWarnings& after, const EngineWarnings& before) {
  EngineWarnings out;
  for (int kind = 0; kind < mjNWARNING; ++kind)
    out.counts[kind] = after.counts[kind] - before.counts[kind];
  return out;
}

EngineWarnings ReadWarnings(const mjData* data) {
  EngineWarnings out;
  for (int kind = 0; kind < mjNWARNING; ++kind) out.counts[kind] = data->warning[kind].number;
  return out;
}

const char* WarningName(mjtWarning kind) { return kWords[kind].name; }

const char* WarningMeaning(mjtWarning kind) { return kWords[kind].meaning; }

std::vector<std::string> SpecWarnings(const mjSpec* spec) {
  std::vector<std::string> out(mjs_numWarnings(spec));
  for (size_t i = 0; i < out.size(); ++i) out[i] = mjs_getWarning(spec, static_cast<int>(i));
  return out;
}

}  // namespace robocell
