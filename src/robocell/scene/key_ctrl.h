// Private to scene: the controls and activations of a keyframe. A part's own numbers are kept if
// they hold the positions or are not meant to. Otherwise holding ones replace them.
//
//   KeyCtrl ctrl(model, data, part_key, "home", robots);
//   ctrl.Set(actuator, true, key_ctrl, key_act);
//   ctrl.Warn(log);
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "robocell/scene/compile_log.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/part_keys.h"

namespace robocell::internal {

// A control holds a hinge (rad) or another joint (m) if it rests this close to the keyframe.
inline constexpr double kKeySlackTurn = 0.05;
inline constexpr double kKeySlackSlide = 0.005;

class KeyCtrl {
 public:
  // `data` is at the key's positions, at rest, with velocity stage (qfrc_bias, qfrc_passive).
  KeyCtrl(const mjModel* model, const mjData* data, const PartKey& part, std::string key,
          const std::vector<RobotRecord>& robots);

  // Returns true if the actuator belongs to the keyframe's part.
  bool IsOfPart(int actuator) const;
  // Writes the actuator's numbers into the key's controls (nu) and activations (na). With `own` the
  // part's keyframe decides; numbers that it leaves out are 0, as for the engine.
  void Set(int actuator, bool own, mjtNum* ctrl, mjtNum* act);
  // Adds a warning for each file whose controls were replaced or cannot reach the positions.
  void Warn(CompileLog& log) const;

 private:
  std::optional<HoldingInputs> OwnInputs(int actuator) const;
  bool Holds(int actuator, const HoldingInputs& inputs) const;
  bool CarriesWeight(int actuator, const HoldingInputs& inputs) const;
  void NoteReplaced(int actuator, const HoldingInputs& own, const HoldingInputs& holding);
  void NoteOutOfReach(int actuator, const HoldingInputs& holding);

  const mjModel* m_;
  const mjData* d_;
  const PartKey& part_;
  std::string key_;
  std::set<std::string> gripping_, arms_;  // actuators of grippers; joints of arms
  std::map<std::string, std::pair<PartKey::Source, std::vector<std::string>>> replaced_, short_;
};

}  // namespace robocell::internal
