// The viewer of a scene.
#include "robocell/viewer/viewer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "cameras.h"
#include "handles.h"
#include "kinematics.h"
#include "scene_cycles.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/env/env.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

int VisitViewer(const Viewer& viewer, visitproc visit, void* arg) {
  for (size_t i = 0; i < viewer.scenes_held(); ++i) {
    if (const int stop = VisitScene(viewer.scene(), visit, arg)) return stop;
  }
  return 0;
}

// The package glfw, which MuJoCo's needs, carries the library.
void AddGlfwOfPython() {
  const nb::object spec = nb::module_::import_("importlib.util").attr("find_spec")("glfw");
  if (spec.is_none()) return;
  for (nb::handle folder : spec.attr("submodule_search_locations"))
    AddGlfwLibrary(nb::cast<std::string>(folder) + "/x11/libglfw.so");
}

std::unique_ptr<Viewer> Open(nb::handle target, const std::string& title, int width, int height,
                             bool on_screen, bool stops_scene, bool draws_steps) {
  ViewerOptions options{.title = title,
                        .width = width,
                        .height = height,
                        .on_screen = on_screen,
                        .stops_scene = stops_scene,
                        .draws_steps = draws_steps};
  const Scene* scene = nullptr;
  const Robot* robot = nullptr;
  nb::object held;  // the scene of an environment
  if (on_screen) AddGlfwOfPython();
  if (nb::try_cast(target, robot) && robot) {
    const nb::gil_scoped_release release;
    return std::make_unique<Viewer>(Viewer::Open(*robot, options));
  }
  if (!nb::try_cast(target, scene) || !scene) {
    if (nb::hasattr(target, "unwrapped")) target = held = target.attr("unwrapped");
    if (nb::hasattr(target, "core")) target = held = target.attr("core");
    if (nb::hasattr(target, "scene")) target = held = target.attr("scene");
    if (!nb::try_cast(target, scene) || !scene) {
      throw nb::type_error(
          "viewer: expected a Scene, a Robot or an environment with a scene; for a SceneSpec: "
          "Scene.build(spec)");
    }
    options.stops_scene = false;  // an episode does not end by a window
  }
  const Scene shown = *scene;
  const nb::gil_scoped_release release;
  return std::make_unique<Viewer>(Viewer::Open(shown, options));
}

std::array<float, 4> ToColour(nb::handle rgba) {
  if (rgba.is_none()) return TraceLines::kColour;
  const Numbers given(rgba, FieldPath("rgba"), 4);
  return {static_cast<float>(given[0]), static_cast<float>(given[1]), static_cast<float>(given[2]),
          static_cast<float>(given[3])};
}

ViewElement ToElement(const std::string& kind, const std::string& name) {
  static constexpr std::array kKinds = {"body", "site", "tcp", "camera"};
  for (size_t i = 0; i < kKinds.size(); ++i) {
    if (kind == kKinds[i]) return {static_cast<ViewElement::Kind>(i), name};
  }
  throw ArgumentError(
      fmt::format("kind: expected 'body', 'site', 'tcp' or 'camera', got '{}'", kind));
}

nb::object Pixels(Viewer& viewer) {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;
  {
    const nb::gil_scoped_release release;
    pixels = viewer.Pixels(&width, &height);
  }
  return NewArray<uint8_t>(pixels, {static_cast<size_t>(height), static_cast<size_t>(width), 3});
}

void DefLife(nb::class_<Viewer>& c) {
  c.def_static(
       "open", &Open, "target"_a, "title"_a = "", "width"_a = 1280, "height"_a = 720, nb::kw_only(),
       "on_screen"_a = true, "stops_scene"_a = true, "draws_steps"_a = true,
       nb::sig("def open(target: Scene | Robot | Env | typing.Any, title: str = '', width: int = "
               "1280, height: int = 720, *, on_screen: bool = True, stops_scene: bool = True, "
               "draws_steps: bool = True) -> Viewer"),
       "Opens the window. Raises Error without a display, with what to install.\n\n"
       "Args:\n"
       "    target: A scene, a robot (its scene), or an environment.\n"
       "    title: Title of the window; the scene's name unless given.\n"
       "    width: Width in pixels.\n"
       "    height: Height in pixels.\n"
       "    on_screen: False draws into memory, without a display.\n"
       "    stops_scene: False: steps go on when the user closes the window, and there is no pause "
       "and no reset, as for environments and their scenes.\n"
       "    draws_steps: False: only show() draws, and steps do not wait; the program itself goes "
       "by `paused` and `realtime_factor`.")
      .def("step", &Viewer::Step, Unlocked(),
           "Makes one step of the scene, draws when a picture is due, and waits for "
           "realtime_factor. Returns False once the window was closed.")
      .def("show", &Viewer::Show, Unlocked(),
           "Handles the user's input and draws, without a step. Returns False once the window was "
           "closed.")
      .def_prop_ro("is_running", &Viewer::is_running, "False once the window was closed.")
      .def("close", &Viewer::Close, Unlocked(),
           "Closes the window; the scene can be stepped as before. May be repeated.")
      .def_prop_ro("title", &Viewer::title, "Title of the window.")
      .def_prop_ro(
          "scene", [](const Viewer& v) { return v.scene(); }, "The scene that it shows.")
      .def_prop_rw("realtime_factor", &Viewer::realtime_factor, &Viewer::set_realtime_factor,
                   "Speed of the simulation: 1 is real time, 0 as fast as possible.")
      .def_prop_ro("measured_factor", &Viewer::measured_factor,
                   "Measured speed of about the last second.")
      .def_prop_rw("paused", &Viewer::paused, &Viewer::set_paused,
                   "True while the simulation is paused, as by Space. Setting it raises Error "
                   "where stops_scene is false.")
      .def(
          "__enter__", [](nb::object self) { return self; },
          nb::sig("def __enter__(self) -> Viewer"))
      .def("__exit__", [](Viewer& v, nb::args) { v.Close(); });
}

void DefView(nb::class_<Viewer>& c) {
  c.def(
       "camera_names", [](Viewer& v) { return v.view().camera_names(); },
       "Names that use_camera accepts: 'Free', 'Tracking', then the cameras of the scene.")
      .def_prop_ro(
          "camera", [](Viewer& v) { return v.view().camera(); }, "Name of the present camera.")
      .def(
          "use_camera", [](Viewer& v, const std::string& name) { v.view().UseCamera(name); },
          "name"_a = "", Unlocked(),
          "Selects one of camera_names(); '' is the free camera. Raises NotFoundError.")
      .def(
          "set_free_camera",
          [](Viewer& v, double distance, double azimuth, double elevation, nb::handle lookat) {
            v.view().SetFreeCamera(distance, azimuth, elevation, ToPoint(lookat));
          },
          "distance"_a, "azimuth"_a, "elevation"_a, "lookat"_a,
          "Uses the free camera, which looks at a point; metres and degrees.")
      .def(
          "set_tracking_camera",
          [](Viewer& v, const std::string& body, double distance, double azimuth,
             double elevation) { v.view().SetTrackingCamera(body, distance, azimuth, elevation); },
          "body"_a, "distance"_a = 2.0, "azimuth"_a = 90.0, "elevation"_a = -45.0,
          "Follows a body with everything attached to it, from a constant direction.")
      .def(
          "show_frame",
          [](Viewer& v, const std::string& kind, const std::string& name, bool shown) {
            v.view().ShowFrame(ToElement(kind, name), shown);
          },
          "kind"_a, "name"_a, "shown"_a = true,
          "Shows or hides the axes of a 'body', 'site' or 'camera', or the 'tcp' of a robot.")
      .def(
          "trace",
          [](Viewer& v, const std::string& kind, const std::string& name, bool traced) {
            v.view().TracePoint(ToElement(kind, name), traced);
          },
          "kind"_a, "name"_a, "traced"_a = true, "Draws the path of such an element, from now on.")
      .def_prop_rw(
          "trace_length", [](Viewer& v) { return v.view().traces.length(); },
          [](Viewer& v, double seconds) { v.view().traces.set_length(seconds); },
          "Seconds of simulation that a path covers; 0: all.")
      .def(
          "add_trace_segment",
          [](Viewer& v, nb::handle from, nb::handle to, nb::handle rgba) {
            v.view().traces.AddSegment(ToPoint(from), ToPoint(to), ToColour(rgba));
          },
          "a"_a, "b"_a, "rgba"_a = nb::none(),
          "Draws a line between two points in the world. At most 8192 are kept, the newest.")
      .def(
          "clear_trace", [](Viewer& v) { v.view().traces.Clear(); },
          "Removes all paths and segments.")
      .def(
          "select", [](Viewer& v, const std::string& body) { v.view().SelectBody(body); }, "body"_a,
          "Selects a body for the mouse, as a double click; '' for none.")
      .def_prop_ro(
          "selected", [](Viewer& v) { return v.view().selected(); },
          "Name of the selected body, '' for none.")
      .def_prop_rw(
          "contacts", [](Viewer& v) { return v.view().flags.contacts; },
          [](Viewer& v, bool on) { v.view().flags.contacts = on; },
          "True shows contact points and forces.")
      .def_prop_rw(
          "collision_geoms", [](Viewer& v) { return v.view().flags.collision_geoms; },
          [](Viewer& v, bool on) { v.view().flags.collision_geoms = on; },
          "True shows the geoms that collide in place of those that are seen.")
      .def_prop_rw("panels_shown", &Viewer::panels_shown, &Viewer::SetPanelsShown,
                   "True while the panels are shown; Tab changes it.")
      .def_prop_rw("text", &Viewer::text, &Viewer::set_text, "A text in the upper right corner.")
      .def("take_keys", &Viewer::TakeKeys,
           "Returns the keys that the user pressed since the last call, by GLFW's numbers.")
      .def("drag_tcp", &Viewer::DragTcp, "robot"_a, "commands"_a = true,
           "Shows a handle at the TCP that the mouse drags; inverse kinematics moves the robot's "
           "command, or without `commands` the arm itself.");
}

void DefRecords(nb::class_<Viewer>& c) {
  c.def(
       "start_recording",
       [](Viewer& v, const std::string& path, int fps, int width, int height,
          const std::string& camera) {
         v.StartRecording(path, fps, {width, height}, camera);
       },
       "path"_a, "fps"_a = 30, "width"_a = 1280, "height"_a = 720, "camera"_a = "Current",
       Unlocked(),
       "Begins an mp4 with `fps` pictures for each simulated second; even sizes in pixels. "
       "'Current' is the viewer's camera, also when it moves.")
      .def("stop_recording", &Viewer::StopRecording, Unlocked(),
           "Completes the video and returns its path; '' if there is none.")
      .def_prop_ro("recording", &Viewer::recording, "True while a video is being recorded.")
      .def("save_screenshot", &Viewer::SaveScreenshot, "path"_a, Unlocked(),
           "Writes the whole window as a PNG.")
      .def("pixels", &Pixels, nb::sig("def pixels(self) -> numpy.typing.NDArray[numpy.uint8]"),
           "The window's picture, (height, width, 3).")
      .def("show_panels", &Viewer::ShowPanels, "left"_a = "", "right"_a = "", Unlocked(),
           "Opens one section of the panels on each side and closes the others: 'Run', 'RTF', "
           "'Frames', 'Trace', 'Perturb', 'Recorder'; 'View', 'Joints', 'Controls'.")
      .def(
          "place_of",
          [](Viewer& v, const std::string& section, const std::string& item) {
            return v.PlaceOf(section, item);
          },
          "section"_a, "item"_a,
          "Opens a section and returns the place of one of its items, in pixels from the lower "
          "left corner.")
      .def(
          "post",
          [](Viewer& v, const std::string& type, double x, double y, int button, int key,
             bool control, bool shift) {
            static constexpr std::array<std::string_view, 7> kTypes = {
                "move", "press", "release", "scroll", "key", "resize", "close"};
            for (size_t i = 0; i < kTypes.size(); ++i) {
              if (type != kTypes[i]) continue;
              v.Post({.type = static_cast<InputEvent::Type>(i),
                      .x = x,
                      .y = y,
                      .button = button,
                      .key = key,
                      .control = control,
                      .shift = shift});
              return;
            }
            throw ArgumentError(
                fmt::format("type: expected move, press, release, scroll, key, resize or close, "
                            "got '{}'",
                            type));
          },
          "type"_a, "x"_a = 0.0, "y"_a = 0.0, "button"_a = 0, "key"_a = 0, "control"_a = false,
          "shift"_a = false,
          "Acts as the user would, with the next picture: places in pixels from the lower left "
          "corner, buttons 1 left, 2 right, 3 middle, keys by GLFW's numbers.");
}

}  // namespace

void BindViewer(nb::module_& m) {
  nb::class_<Viewer> c(
      m, "Viewer",
      "A window that shows a scene and lets the user act on it: drag bodies, move joints and "
      "robots, show frames and paths, record videos, change the speed. Keys: F1.\n\nWhile it is "
      "open, steps of the scene and of its robots draw and wait for real time, too. After the user "
      "closed the window, step() returns False and the steps of the scene are not made (their "
      "result is false), until close().",
      nb::type_slots(kHandleSlots<Viewer, &VisitViewer>));
  GuardHandle<Viewer>(
      c, [](const Viewer& v, SceneClaims& claims) { claims.Add(v.scene()); },
      [](const Viewer& v) { RequireOpen(v.scene(), "viewer"); },
      {.always = {"__enter__", "title"},
       .closed = {"step", "show", "close", "is_running", "scene", "recording", "stop_recording",
                  "paused", "realtime_factor", "measured_factor", "__exit__"}});
  DefLife(c);
  DefView(c);
  DefRecords(c);
}

}  // namespace robocell::python
