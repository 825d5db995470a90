// SceneView: what a viewer shows of a scene, and from where: the camera, frames, paths, contacts,
// collision geoms, and the body that the mouse holds. It has no window and needs no OpenGL: its
// result is the engine's list of visible elements, mjvScene.
//
//   SceneView view(scene);
//   view.UseCamera("overview");                 // "": the free camera again
//   view.ShowFrame({ViewElement::kTcp, "left"}, true);
//   view.Update();                              // draw view.list() now
//
// It follows the scene: after objects were added or removed, everything is found again by name, and
// what is missing is not drawn until it exists again. Throws NotFoundError with the available
// names, ArgumentError for numbers that are not finite, ClosedError after the scene was closed.
// Threads: those of the scene.
#pragma once

#include <compare>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/markers.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/viewer/trace_lines.h"

struct mjvScene_;
typedef struct mjvScene_ mjvScene;  // the engine's

namespace robocell {

// A part of a scene that has a pose. The name of a TCP is that of its robot.
struct ViewElement {
  enum Kind { kBody, kSite, kTcp, kCamera };
  Kind kind = kBody;
  std::string name;
  auto operator<=>(const ViewElement&) const = default;  // NOLINT(modernize-use-nullptr)
};
// Throws ArgumentError unless the robot belongs to the scene.
void RequireRobotOf(const Scene& scene, const Robot& robot);
// Returns "body 'cube'", for messages and labels.
std::string Describe(const ViewElement& element);

// What is drawn beside the scene itself.
struct ViewFlags {
  bool contacts = false;         // points and forces
  bool collision_geoms = false;  // the geoms that collide, in place of those that are seen
  bool joints = false;           // axes
  bool transparent = false;
  bool shadows = true;
  bool labels = true;  // names of frames
};

class SceneView {
 public:
  // `robots` are shown beside those that the scene has by configuration. Throws ArgumentError for
  // robots of another scene.
  explicit SceneView(const Scene& scene, std::vector<Robot> robots = {});
  ~SceneView();
  SceneView(const SceneView&) = delete;
  SceneView& operator=(const SceneView&) = delete;

  const Scene& scene() const { return scene_; }
  const std::vector<Robot>& robots() const { return robots_; }

  // --- camera ---
  // Returns "Free", "Tracking", then the cameras of robots, objects and the scene.
  std::vector<std::string> camera_names() const;
  // Returns one of these: the present one.
  const std::string& camera() const { return camera_name_; }
  // Selects one of camera_names(); "" is the free camera. "Tracking" follows the selected body, or
  // else the first robot or body of the scene.
  void UseCamera(std::string_view name);
  void SetFreeCamera(double distance, double azimuth, double elevation,
                     const Eigen::Vector3d& lookat);
  void SetTrackingCamera(std::string_view body, double distance, double azimuth, double elevation);
  // Moves the camera by the mouse, in fractions of the window's height; `action` is a mjtMouse. A
  // fixed camera first becomes the free one where it is.
  void MoveCamera(int action, double dx, double dy);
  // Returns the present camera, for renderers and recorders.
  CameraView view() const;

  // --- overlays ---
  ViewFlags flags;
  TraceLines traces;
  // Returns the names of all elements of a kind.
  std::vector<std::string> elements(ViewElement::Kind kind) const;
  // Returns its pose in the world; empty if there is none of that name at present.
  std::optional<Pose> pose(const ViewElement& element) const;
  void ShowFrame(const ViewElement& element, bool shown);
  bool ShowsFrame(const ViewElement& element) const { return frames_.contains(element); }
  const std::set<ViewElement>& frames() const { return frames_; }
  void TracePoint(const ViewElement& element, bool traced);
  bool Traces(const ViewElement& element) const { return traced_.contains(element); }
  // Extends the paths of traced points to the present; call it after each step.
  void ExtendTraces();
  double frame_length() const { return frame_length_; }
  void set_frame_length(double metres);
  // Draws them until the next call, e.g. handles for the mouse.
  void SetMarkers(std::vector<Marker> markers) { markers_ = std::move(markers); }

  // --- selection and mouse forces ---
  // Selects the body in a place of the picture, in fractions from the lower left corner of the last
  // Update(); "" for none.
  std::string Select(double x, double y, double aspect);
  void SelectBody(std::string_view name);  // "": none
  const std::string& selected() const { return selected_; }
  // Begins to hold the selected body at the selected point: with `rotate` by its orientation.
  // Returns false without a body that can be moved.
  bool Hold(bool rotate);
  void MoveHeld(int action, double dx, double dy);
  void Release();
  bool holds() const;
  // Apply what the mouse does to the held body, for the next step. A dynamic body is pulled by a
  // spring, a mocap body is moved; `paused`: a free body is moved too. EndForce() restores the
  // forces of the program.
  void ApplyForce(bool paused);
  void EndForce();

  // --- drawing ---
  // Follows a rebuild of the scene. Returns true if the model is another one than at the last call.
  bool Follow();
  // Renews the list for a picture of this width / height.
  void Update(double aspect);
  mjvScene* list();
  // Returns the place of a point of the world in the picture of the last Update(), in fractions
  // from the lower left corner; empty if it is behind the camera.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point) const;
  // Returns the point on the plane through `point`, parallel to the picture, that is seen there.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& place, const Eigen::Vector3d& point) const;

 private:
  struct Drawing;
  void UseModelCamera(const std::string& name, int id);
  void KeepFreeCamera();
  // Finds the camera or the tracked body in a new model; without it, uses the free camera.
  void FindCamera();
  void AddOverlays();
  void AddPaths();
  void KeepColliding();
  const Robot* FindRobot(const std::string& name) const;

  Scene scene_;
  std::vector<Robot> robots_;
  std::unique_ptr<Drawing> drawing_;
  uint64_t generation_ = 0;
  std::string camera_name_ = "Free";
  OrbitCamera free_;
  std::string tracked_;  // name of the body that "Tracking" follows
  std::set<ViewElement> frames_, traced_;
  double frame_length_ = 0.1;
  std::vector<Marker> markers_;
  std::string selected_;
  double aspect_ = 1;
};

}  // namespace robocell
