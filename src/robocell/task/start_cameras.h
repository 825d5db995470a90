// StartCameras: the cameras of `start.cameras` (spec/start_camera.h) in the scenes of a run: adds
// them to a scene's spec, draws their places for each start, and checks what they see.
//
//   const StartCameras cameras(run, probe, Robot::Of(probe, "rc7"));  // probe: without them
//   cameras.AddTo(spec);                                              // of a scene like it
//   if (auto refusal = cameras.Place(scene, robot, {}, rng)) ...
//
// Pixels are counted in images of body ids, which the back end `soft` draws in the size of the
// camera's stream. One thread at a time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/object_view.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/start_camera.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

// Returns which bodies of the scene a name means: `gripper` (what the TCP's body carries), `robot`,
// or those of BodiesOf (scenes/object_view.h), with its errors.
std::vector<bool> BodiesNamed(const Scene& scene, const Robot& robot, const std::string& name,
                              const std::string& place);

class StartCameras {
 public:
  // Returns the object for which a name of the run stands; unset: the names are those of objects.
  using ObjectOf = std::function<std::string(const std::string&)>;

  // `scene` has the robot and the models of the starts, but not these cameras. `images` may be
  // shared. Throws NotFoundError and ArgumentError, with the camera's field, for cameras, bodies and
  // sites that the scene does not have, and for lenses that cannot be taken over.
  StartCameras(const RunConfig& run, const Scene& scene, const Robot& robot,
               std::shared_ptr<BodyImages> images);

  // Adds the cameras without noise; those around objects look at the origin.
  void AddTo(SceneSpec& spec) const;
  // Draws a place for each camera until it sees what it has to, and leaves it there. Returns a
  // refusal if one finds no such place. The scene's poses are up to date.
  std::optional<Refusal> Place(Scene& scene, const Robot& robot, const ObjectOf& object_of,
                               const Rng& rng);
  // Checks the cameras where they are.
  std::optional<Refusal> Check(const Scene& scene, const Robot& robot, const ObjectOf& object_of);
  // Checks those that do not depend on where the robot is, while it is far away: without it, they
  // see at least as much.
  std::optional<Refusal> CheckWithoutRobot(const Scene& scene, const Robot& robot,
                                           const ObjectOf& object_of);
  // Throws NotFoundError for a name in `around` or `sees` that is neither in the scene of a start nor
  // one of `others`.
  void RequireNames(const Scene& scene, const Robot& robot, const ObjectOf& object_of,
                    std::span<const std::string> others = {}) const;

 private:
  // A camera on its body.
  struct Mounted {
    std::string name;
    StartCamera camera;
    std::string body;  // "" for the world
    Pose mount, pose;  // of the mount in the body, of the camera in the mount
    double fovy = StartCamera::kFovy;
    int width = 0, height = 0;
  };
  Mounted Mount(const RunConfig& run, const std::string& name, const StartCamera& camera,
                const Scene& scene, const Robot& robot) const;
  void Draw(const Mounted& mounted, Scene& scene, const Robot& robot, const ObjectOf& object_of,
            Rng& rng) const;
  std::optional<Refusal> CheckSight(const Mounted& mounted, const Scene& scene, const Robot& robot,
                                    const ObjectOf& object_of);

  std::vector<Mounted> mounted_;
  std::shared_ptr<BodyImages> images_;
};

}  // namespace robocell::internal
