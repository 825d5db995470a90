// Known defects of the present engine, and the guard against the one that silently makes
// simulations wrong.
//
// MuJoCo 4.0.0 factorises a sparse Hessian wrongly when the branches of several kinematic trees
// touch (hands, for example), and its Newton solver then returns wrong accelerations. A dense
// Jacobian is correct. `Compile` (compile.h) therefore makes the Jacobian of such models dense:
//
//   ModelPtr model = Compile(spec);  // opt.jacobian is mjJAC_DENSE where that is needed
//   ModelPtr same = Compile(spec, nullptr, "my scene", nullptr, JacobianGuard::kOff);
//
// The engine itself chooses a sparse Jacobian from 60 degrees of freedom on. Islands stay on: they
// keep the dense solver cheap, because each island is factorised by itself.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

// The guard against the engine's wrong solver for sparse Jacobians: kOn lets compiling replace one.
enum class JacobianGuard { kOn, kOff };

struct EngineDefect {
  std::string name;      // "sparse_newton"
  std::string what;      // the error and its condition
  std::string guard;     // robocell's workaround; "" if there is none
  std::string fixed_in;  // version of MuJoCo
};

// The name of the guard, also in records of episodes.
inline constexpr std::string_view kSparseNewton = "sparse_newton";

// Returns those of the loaded engine, worst first; empty if none are known.
std::vector<EngineDefect> KnownEngineDefects();

// Returns true if steps of the model use a solver that is known to be wrong.
bool NeedsJacobianGuard(const mjModel* model);

// Makes the Jacobian of such a model dense; returns true if it did.
bool GuardJacobian(mjModel* model);

// Logs that a model is guarded: once per process, because one message is enough for a thousand
// models. `context` begins the message.
void LogJacobianGuard(const mjModel* model, std::string_view context);

namespace defects_internal {
std::vector<EngineDefect> DefectsOf(int version);
}  // namespace defects_internal

}  // namespace robocell
