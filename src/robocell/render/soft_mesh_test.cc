#include "robocell/render/soft_mesh.h"

#include <gtest/gtest.h>

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
