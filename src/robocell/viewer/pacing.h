// Pacing: how fast a simulation runs beside the clock on the wall, and when to draw it. No clock of
// its own: the caller gives both times, in seconds, so that tests need not wait.
// Internal to viewer/.
//
//   Pacing pacing;                                    // real time
//   pacing.set_factor(0.5);                           // half as fast; 0: as fast as it can
//   sleep(pacing.Wait(scene.time(), Now()));          // after each step
//   if (pacing.ShouldDraw(Now())) Draw();
//
// It never catches up: where the simulation is slower than asked for, or was stopped, pacing starts
// again from the present. The measured factor is that of about the last second.
#pragma once

#include <array>
#include <cstddef>

namespace robocell::internal {

class Pacing {
 public:
  double factor() const { return factor_; }
  // Throws ArgumentError for a negative or infinite factor and NaN.
  void set_factor(double factor);

  // Returns how long to wait so that the simulation does not run ahead; 0 without waiting. Notes
  // the times for measured().
  double Wait(double simulated, double wall);
  // Starts again from the present at the next call of Wait: after a pause or a reset.
  void Restart() { started_ = false; }

  // Returns the measured factor; 0 before anything was measured.
  double measured() const;

  // Returns true if the next picture is due. Pictures take at most half of the time, however long
  // one takes.
  bool ShouldDraw(double wall) const { return wall >= next_picture_; }
  double next_picture() const { return next_picture_; }
  void Drew(double begin, double end, double pictures_per_s);

 private:
  struct Moment {
    double simulated = 0, wall = 0;
  };

  void Note(double simulated, double wall);

  double factor_ = 1;
  bool started_ = false;
  Moment origin_;            // pacing keeps to this moment
  double last_ = 0;          // simulated time of the last call
  double next_picture_ = 0;  // wall time
  std::array<Moment, 32> moments_;
  size_t count_ = 0;  // moments noted since the start
};

}  // namespace robocell::internal
