#include "cameras.h"

#include <mujoco/mujoco.h>

#include <string>

#include "returned.h"
#include "values.h"
#include "robocell/mujoco/names.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

// Refers to the body by its name: ids change when a scene is built anew.
struct NamedTracking {
  std::string body;
  TrackingCamera camera;
};

}  // namespace

Eigen::Vector3d ToPoint(nb::handle lookat) {
  const Numbers p(lookat, FieldPath("lookat"), 3);
  return {p[0], p[1], p[2]};
}

CameraView ViewOf(const mjModel* model, nb::handle camera, std::string_view place) {
  if (nb::isinstance<OrbitCamera>(camera)) return nb::cast<OrbitCamera>(camera);
  if (nb::isinstance<FreeCamera>(camera)) return nb::cast<FreeCamera>(camera);
  if (nb::isinstance<NamedTracking>(camera)) {
    const auto& named = nb::cast<const NamedTracking&>(camera);
    TrackingCamera tracking = named.camera;
    tracking.body = RequireId(model, mjOBJ_BODY, named.body, place);
    return tracking;
  }
  if (nb::isinstance<nb::str>(camera)) {
    const auto name = nb::cast<std::string>(camera);
    return name.empty() ? CameraView(InitialView(model)) : NamedCamera(model, name, place);
  }
  throw nb::type_error((std::string(place) +
                        ": `camera` must be the name of a camera, an OrbitCamera, a "
                        "FreeCamera or a TrackingCamera, got " +
                        ShortRepr(camera))
                           .c_str());
}

void BindCameras(nb::module_& m) {
  nb::class_<OrbitCamera>(
      m, "OrbitCamera",
      "A camera that looks at a point: degrees and metres; azimuth 90 looks "
      "along +y, negative elevation down."
      "\n\nExamples:\n"
      "    >>> view = rc.render.OrbitCamera(lookat=(0, 0, 0.3), distance=1.5, azimuth=140, "
      "elevation=-20)\n"
      "    >>> rc.render.Renderer(scene, backend=\"soft\").render(view, 160, 120)[\"rgb\"].shape\n"
      "    (120, 160, 3)")
      .def(
          "__init__",
          [](OrbitCamera* self, nb::handle lookat, double distance, double azimuth,
             double elevation, double fovy) {
            const OrbitCamera view{ToPoint(lookat), distance, azimuth, elevation, fovy};
            RequireView(view);
            new (self) OrbitCamera(view);
          },
          "lookat"_a = nb::make_tuple(0.0, 0.0, 0.0), "distance"_a = 2.0, "azimuth"_a = 90.0,
          "elevation"_a = -45.0, "fovy"_a = 45.0);
  nb::class_<FreeCamera>(m, "FreeCamera",
                         "A camera at any pose in the world, in MuJoCo's camera axes, with its "
                         "vertical field of view in degrees.")
      .def(
          "__init__",
          [](FreeCamera* self, const Pose& pose, double fovy) {
            const FreeCamera view{pose, fovy};
            RequireView(view);
            new (self) FreeCamera(view);
          },
          "camera_in_world"_a, "fovy"_a = 45.0);
  nb::class_<NamedTracking>(m, "TrackingCamera",
                            "An OrbitCamera around a moving body: around the centre of mass of the "
                            "body and everything attached to it.")
      .def(
          "__init__",
          [](NamedTracking* self, std::string body, double distance, double azimuth,
             double elevation, double fovy) {
            const TrackingCamera view{
                .distance = distance, .azimuth = azimuth, .elevation = elevation, .fovy = fovy};
            RequireView(view);
            new (self) NamedTracking{std::move(body), view};
          },
          "body"_a, "distance"_a = 2.0, "azimuth"_a = 90.0, "elevation"_a = -45.0, "fovy"_a = 45.0);
}

}  // namespace robocell::python
