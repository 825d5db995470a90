// What cameras see of objects, and words that mean one object.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "cameras.h"
#include "returned.h"
#include "robocell/base/error.h"
#include "robocell/robot/robot.h"
#include "robocell/scenes/object_view.h"
#include "robocell/scenes/referral.h"
#include "robocell/scenes/scene_annotations.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

nb::object PointArray(const std::vector<Pixel>& points) {
  std::vector<int32_t> flat;
  for (const Pixel& point : points) flat.insert(flat.end(), {point[0], point[1]});
  return NewArray<int32_t>(flat, {points.size(), 2});
}

ObjectView SeeObject(const Scene& scene, const std::string& object, nb::handle camera, int width,
                     int height, int points) {
  const std::string place = "scene '" + scene.name() + "'";
  const CameraView view = ViewOf(scene.model(), camera, place);
  const nb::gil_scoped_release unlocked;
  BodyImages images;
  return ViewOfObject(scene, BodiesOf(scene, object, place), view, width, height, points, images);
}

// Returns the bytes of a mask: booleans or uint8.
nb::object PointsOf(nb::handle mask, int most) {
  using Mask = nb::ndarray<nb::ro, nb::ndim<2>, nb::device::cpu>;
  Mask given;
  if (!nb::try_cast(mask, given, /*convert=*/false) ||
      (given.dtype() != nb::dtype<bool>() && given.dtype() != nb::dtype<uint8_t>())) {
    throw nb::type_error(
        ("points_in_mask: `mask` must be a bool array of shape (height, width), such as `ids == "
         "3`, got " +
         ShortRepr(mask))
            .c_str());
  }
  const int height = static_cast<int>(given.shape(0)), width = static_cast<int>(given.shape(1));
  std::vector<uint8_t> bytes;
  bytes.reserve(given.size());
  const auto* first = static_cast<const uint8_t*>(given.data());
  for (int64_t v = 0; v < height; ++v) {
    for (int64_t u = 0; u < width; ++u)
      bytes.push_back(first[v * given.stride(0) + u * given.stride(1)]);
  }
  std::vector<Pixel> points;
  {
    const nb::gil_scoped_release unlocked;
    points = PointsInMask(bytes, width, height, most);
  }
  return PointArray(points);
}

// Without a viewer the first robot looks.
Viewer ViewerOf(const Scene& scene, const std::optional<Pose>& viewer) {
  if (viewer) return Viewer::Of(*viewer);
  const std::vector<Robot> robots = RobotsOf(scene);
  return robots.empty() ? Viewer{} : Viewer::Of(robots.front().base_in_world());
}

}  // namespace

void BindObjectViews(nb::module_& m) {
  nb::class_<ObjectView>(m, "ObjectView", "What a camera shows of an object.")
      .def_ro("pixels", &ObjectView::pixels, "Number of pixels that show it.")
      .def_ro("share", &ObjectView::share,
              "Share of it, 0 to 1, that is in the image with nothing in front of it.")
      .def_prop_ro(
          "box",
          [](const ObjectView& view) {
            return nb::make_tuple(view.low[0], view.low[1], view.high[0], view.high[1]);
          },
          nb::sig("def box(self) -> tuple[int, int, int, int]"),
          "First column and row, last column and row of its pixels; (0, 0, -1, -1) without any.")
      .def_prop_ro(
          "points", [](const ObjectView& view) { return PointArray(view.points); },
          nb::sig("def points(self) -> numpy.typing.NDArray[numpy.int32]"),
          "Points on it, (n, 2): columns and rows. They are apart from each other and from its "
          "edge.");
  m.def("object_view", &SeeObject, "scene"_a, "object"_a, "camera"_a = "", nb::kw_only(),
        "width"_a = 320, "height"_a = 240, "points"_a = 10,
        "Returns what a camera shows of an object, a robot or a body in the scene's present state. "
        "`camera` is the name of one or a view; `points` is the largest number of points. The back "
        "end `soft` draws the image.\n\nExamples:\n"
        "    >>> view = rc.scenes.object_view(scene, \"cube\", rc.render.OrbitCamera(), width=64, "
        "height=48)\n"
        "    >>> 0 <= view.share <= 1\n"
        "    True");
  m.def("points_in_mask", &PointsOf, "mask"_a, "most"_a = 10,
        nb::sig("def points_in_mask(mask: numpy.typing.NDArray[numpy.bool_], most: int = 10) -> "
                "numpy.typing.NDArray[numpy.int32]"),
        "Returns at most that many points of a mask, (n, 2): columns and rows. The first is the "
        "nearest to its middle, each further one the farthest from those before, away from the "
        "edge of the mask.\n\nExamples:\n"
        "    >>> import numpy as np\n"
        "    >>> rc.scenes.points_in_mask(np.ones((9, 9), bool), 1).tolist()\n"
        "    [[4, 4]]");
  m.def(
      "referrals",
      [](const Scene& scene, const std::string& object, const std::optional<Pose>& viewer,
         const SceneAnnotations* annotations) {
        const SceneAnnotations known = annotations ? *annotations : SceneAnnotations{};
        const nb::gil_scoped_release unlocked;
        return ReferralsTo(ReferableObjects(scene, known.objects, known.containers), object,
                           ViewerOf(scene, viewer));
      },
      "scene"_a, "object"_a, nb::kw_only(), "viewer"_a = nb::none(), "annotations"_a = nb::none(),
      "Returns expressions that mean this object and no other, the simplest first, such as 'the "
      "red mug' or 'the mug left of the laptop'; empty if there are none. `viewer` is a pose that "
      "looks along its x axis, by default the base of the first robot. `annotations` add words of "
      "the surroundings. Raises NotFoundError for an object without words.\n\nExamples:\n"
      "    >>> rc.scenes.referrals(scene, \"cube\")[0]\n"
      "    'the box'");
}

}  // namespace robocell::python
