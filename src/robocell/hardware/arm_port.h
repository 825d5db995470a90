// ArmPort: the interface below Robot that drivers of real arms implement: what was measured, what
// is commanded, the limits, and a clock. A simulated arm implements it too (simulated_arm.h).
//
// Nothing sends to a port directly: an ArmLink (arm_link.h) does, through its SafetyGate.
//
// Joint values are in the order of joint_names(): rad, rad/s, rad/s^2 and N m, or m, m/s, m/s^2
// and N. Read and Send never wait; a driver of a slow bus has a thread of its own. They may throw
// any exception: the link then stops the arm and reports it. Threads: that of the scene.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace robocell {

// One value per joint. What the arm is driven at stays within these.
struct ArmLimits {
  std::vector<double> lower = {}, upper = {};
  std::vector<double> velocity = {}, acceleration = {}, force = {};
  bool operator==(const ArmLimits&) const = default;
};

// Throws ArgumentError that begins with `place` unless there is one value per joint, no lower limit
// is above its upper one, and the others are above 0 and not NaN.
void RequireValid(const ArmLimits& limits, const std::vector<std::string>& joints,
                  const std::string& place);
// Returns the narrower of both, value by value; an empty list of `narrower` changes nothing. The
// same errors, for a list of another size.
ArmLimits Narrowed(const ArmLimits& limits, const ArmLimits& narrower,
                   const std::vector<std::string>& joints, const std::string& place);

inline constexpr double kNoOpening = std::numeric_limits<double>::quiet_NaN();

struct ArmMeasurement {
  double time = 0;  // of the arm's own clock, s
  std::vector<double> pos = {}, vel = {}, force = {};
  double opening = kNoOpening;  // of its gripper, 0 closed ... 1 open; NaN without one
};

struct ArmCommand {
  std::vector<double> pos = {}, vel = {};
  // All of the joints' forces, with those against gravity. Empty: the arm goes to `pos` by itself.
  std::vector<double> force = {};
  double opening = kNoOpening;  // NaN: leave the gripper as it is
};

class ArmPort {
 public:
  virtual ~ArmPort() = default;

  virtual std::string name() const = 0;  // for messages: "udp 127.0.0.1:7071"
  virtual std::vector<std::string> joint_names() const = 0;
  virtual ArmLimits limits() const = 0;
  // Copies the newest measurement. Returns false if there is none since the last call.
  virtual bool Read(ArmMeasurement& out) = 0;
  virtual void Send(const ArmCommand& command) = 0;
  // Returns true if Send obeys commands of forces.
  virtual bool takes_forces() const { return false; }
  // Makes the arm hold where it is. Called when a link stops or ends.
  virtual void Hold() = 0;
  // Seconds of a clock that never goes back; by default the computer's.
  virtual double now() const;
  // Returns when now() has reached `time`. A simulated arm moves meanwhile.
  virtual void WaitUntil(double time);
};

}  // namespace robocell
