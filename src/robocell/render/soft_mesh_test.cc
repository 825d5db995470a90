#include "robocell/render/soft_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/render/soft_kernel.h"
#include "robocell/render/soft_shapes.h"

namespace robocell::internal {
namespace {

SoftMesh Tetrahedron() {
  SoftMeshBuilder builder;
  const int o = builder.Vertex({0, 0, 0}), x = builder.Vertex({1, 0, 0}),
            y = builder.Vertex({0, 1, 0}), z = builder.Vertex({0, 0, 1});
  builder.Triangle(o, y, x);
  builder.Triangle(o, x, z);
  builder.Triangle(o, z, y);
  builder.Triangle(x, y, z);
  return builder.Build();
}

Eigen::Vector3f CornerOf(const SoftMesh& mesh, int triangle, int k) {
  const auto v = static_cast<size_t>(mesh.corners[k][static_cast<size_t>(triangle)]);
  return {mesh.x[v], mesh.y[v], mesh.z[v]};
}

TEST(SoftMesh, RowsArePadded) {
  const SoftMesh mesh = Tetrahedron();
  EXPECT_EQ(mesh.vertices, 4);
  EXPECT_EQ(mesh.triangles, 4);
  for (const auto* row : {&mesh.x, &mesh.y, &mesh.z}) {
    EXPECT_EQ(row->size() % kSoftPadding, 0);
    EXPECT_GE(row->size(), 4);
  }
  EXPECT_TRUE(mesh.texture.empty());
}

TEST(SoftMesh, HasTheBoxOfItsVertices) {
  const SoftMesh mesh = Tetrahedron();
  EXPECT_EQ(mesh.low, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(mesh.high, Eigen::Vector3f(1, 1, 1));
}

TEST(SoftMesh, IsClosedIfEachEdgeHasTwoSides) {
  EXPECT_TRUE(Tetrahedron().closed);
  SoftMeshBuilder builder;
  builder.Quad(builder.Vertex({0, 0, 0}), builder.Vertex({1, 0, 0}), builder.Vertex({1, 1, 0}),
               builder.Vertex({0, 1, 0}));
  const SoftMesh quad = builder.Build();
  EXPECT_FALSE(quad.closed);
  EXPECT_EQ(quad.triangles, 2);
}

// The weights of the second and of the third corner are 1 there and 0 at the others.
TEST(SoftMesh, SurfacesWeightTheirCorners) {
  const SoftMesh mesh = Tetrahedron();
  for (int t = 0; t < mesh.triangles; ++t) {
    const SoftSurface& s = mesh.surface[static_cast<size_t>(t)];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f p = CornerOf(mesh, t, k);
      const auto dot = [&](const float* row) {
        return row[0] * p.x() + row[1] * p.y() + row[2] * p.z();
      };
      EXPECT_NEAR(dot(s.to1) - s.at1, k == 1, 1e-6) << t << " " << k;
      EXPECT_NEAR(dot(s.to2) - s.at2, k == 2, 1e-6) << t << " " << k;
    }
    EXPECT_EQ(s.flat, 1);
  }
}

// The plane of a triangle is where a camera sees neither of its sides.
TEST(SoftMesh, PlanesPassThroughTheirCorners) {
  const SoftMesh mesh = Tetrahedron();
  for (int t = 0; t < mesh.triangles; ++t) {
    const auto at = static_cast<size_t>(t);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f p = CornerOf(mesh, t, k);
      EXPECT_NEAR(mesh.facing[0][at] * p.x() + mesh.facing[1][at] * p.y() +
                      mesh.facing[2][at] * p.z() + mesh.facing[3][at],
                  0, 1e-6);
    }
  }
}

TEST(SoftMesh, TrianglesWithoutAnAreaAreLeftOut) {
  SoftMeshBuilder builder;
  const int a = builder.Vertex({0, 0, 0}), b = builder.Vertex({1, 1, 1}),
            c = builder.Vertex({2, 2, 2});
  const Eigen::Vector3f up(0, 0, 1);
  builder.Triangle({a, up}, {b, up}, {c, up});
  builder.Triangle({a, up}, {a, up}, {b, up});
  EXPECT_EQ(builder.Build().triangles, 0);
}

// A file may have its triangles in any order.
TEST(SoftMesh, SortedTrianglesAreTheSameInSmallerClusters) {
  const SoftMesh sphere = SoftShapes(128, 64).sphere;
  const auto build = [&](bool sorted) {
    SoftMeshBuilder builder;
    for (int v = 0; v < sphere.vertices; ++v) {
      const auto at = static_cast<size_t>(v);
      builder.Vertex({sphere.x[at], sphere.y[at], sphere.z[at]});
    }
    for (int t = 0; t < sphere.triangles; ++t) {
      const auto at = static_cast<size_t>((int64_t{t} * 7919) % sphere.triangles);
      builder.Triangle(sphere.corners[0][at], sphere.corners[1][at], sphere.corners[2][at]);
    }
    if (sorted) builder.SortTriangles();
    return builder.Build();
  };
  const SoftMesh as_read = build(false), sorted = build(true);
  const auto centres = [](const SoftMesh& mesh) {
    std::vector<float> sums;
    for (int t = 0; t < mesh.triangles; ++t) {
      const Eigen::Vector3f sum =
          CornerOf(mesh, t, 0) + CornerOf(mesh, t, 1) + CornerOf(mesh, t, 2);
      sums.push_back(sum.dot(Eigen::Vector3f(1, 3, 7)));
    }
    std::ranges::sort(sums);
    return sums;
  };
  EXPECT_EQ(sorted.triangles, sphere.triangles);
  EXPECT_EQ(centres(sorted), centres(as_read));
  const auto mean_radius = [](const SoftMesh& mesh) {
    double sum = 0;
    for (int c = 0; c < mesh.clusters.count; ++c)
      sum += mesh.clusters.radius[static_cast<size_t>(c)];
    return sum / mesh.clusters.count;
  };
  EXPECT_GT(mean_radius(as_read), 0.9);
  EXPECT_LT(mean_radius(sorted), 0.3);
}

// Draws an instance from where it is seen, with and without clusters.
SoftBuffer Drawn(const SoftMesh& mesh, const Eigen::Affine3f& to_view, SoftSide side, bool turned,
                 bool orthographic) {
  SoftView view;
  view.width = view.bottom = 96;
  view.height = 96;
  view.orthographic = orthographic;
  view.fx = view.fy = orthographic ? 24 : 90;
  view.cx = view.cy = 47.5f;
  view.near = 0.01f;
  view.far = 50;
  view.per_fx = view.per_fy = 1 / view.fx;
  SoftInstance instance;
  instance.mesh = &mesh;
  instance.side = side;
  const Eigen::Affine3f to_mesh = to_view.inverse();
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 4; ++k) {
      instance.to_view[4 * row + k] = to_view.matrix()(row, k);
      instance.to_mesh[4 * row + k] = to_mesh.matrix()(row, k);
    }
    instance.eye[row] = to_mesh.matrix()(row, orthographic ? 2 : 3);
  }
  instance.eye[3] = orthographic ? 0 : 1;
  if (turned) {
    for (float& part : instance.eye) part = -part;
  }
  SoftBuffer buffer;
  SoftScratch scratch;
  FitBuffer(view, &buffer);
  ClearRows(view, BlockRows(view), &buffer);
  DrawInstance(view, instance, &scratch, &buffer);
  return buffer;
}

TEST(SoftMesh, ClustersThatAreLeftOutChangeNoPixel) {
  const SoftShapes shapes(256, 128);
  Rng rng = Rng::Stream(3, "clusters");
  int shown = 0;
  for (const SoftMesh* mesh : {&shapes.sphere, &shapes.cylinder, &shapes.upper_half}) {
    SoftMesh whole = *mesh;
    whole.clusters = {};
    for (int i = 0; i < 24; ++i) {
      const auto side = std::array{SoftSide::kFront, SoftSide::kBack, SoftSide::kBoth}[i % 3];
      const bool orthographic = i % 4 == 3, turned = i % 5 == 4;
      Eigen::Affine3f to_view = Eigen::Affine3f::Identity();
      const auto draw = [&](double low, double high) {
        return static_cast<float>(rng.Uniform(low, high));
      };
      to_view.translate(Eigen::Vector3f(draw(-0.5, 0.5), draw(-0.5, 0.5), draw(-4, -0.5)));
      to_view.rotate(
          Eigen::Quaternionf(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)).normalized());
      to_view.scale(Eigen::Vector3f(draw(0.5, 1), draw(0.5, 1), draw(0.2, 1)));
      if (turned) to_view.scale(Eigen::Vector3f(1, 1, -1));
      const SoftBuffer a = Drawn(*mesh, to_view, side, turned, orthographic),
                       b = Drawn(whole, to_view, side, turned, orthographic);
      for (size_t block = 0; block < a.ids.size(); ++block) {
        ASSERT_TRUE(std::ranges::equal(a.ids[block].at, b.ids[block].at)) << "view " << i;
        ASSERT_TRUE(std::ranges::equal(a.nearness[block].at, b.nearness[block].at));
        shown += static_cast<int>(
            std::ranges::count_if(a.ids[block].at, [](uint32_t id) { return id != kSoftNothing; }));
      }
    }
  }
  EXPECT_GT(shown, 10000);
}

TEST(SoftMesh, ABuilderIsEmptyAfterwards) {
  SoftMeshBuilder builder;
  const int a = builder.Vertex({0, 0, 0}), b = builder.Vertex({1, 0, 0}),
            c = builder.Vertex({0, 1, 0});
  builder.Triangle(a, b, c);
  SoftMesh mesh;
  builder.Build(&mesh);
  EXPECT_EQ(mesh.triangles, 1);
  builder.Build(&mesh);
  EXPECT_EQ(mesh.triangles, 0);
  EXPECT_EQ(mesh.vertices, 0);
}

}  // namespace
}  // namespace robocell::internal
