#include "robocell/render/soft_shapes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

// Returns the volume that the triangles enclose, by the divergence theorem: positive if they face
// outwards.
double VolumeOf(const SoftMesh& mesh) {
  double volume = 0;
  for (int t = 0; t < mesh.triangles; ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.corners[k][t];
      corners.row(k) << mesh.x[v], mesh.y[v], mesh.z[v];
    }
    volume += corners.determinant() / 6;
  }
  return volume;
}

TEST(SoftShapes, AreClosedAndFaceOutwards) {
  const SoftShapes shapes(64, 32);
  EXPECT_TRUE(shapes.sphere.closed);
  EXPECT_NEAR(VolumeOf(shapes.sphere), 4.18879, 0.05);
  EXPECT_TRUE(shapes.cylinder.closed);
  EXPECT_NEAR(VolumeOf(shapes.cylinder), 6.28319, 0.05);
  EXPECT_TRUE(shapes.cone.closed);
  EXPECT_NEAR(VolumeOf(shapes.cone), 1.0472, 0.02);
  EXPECT_TRUE(shapes.box.closed);
  EXPECT_DOUBLE_EQ(VolumeOf(shapes.box), 8);
}

TEST(SoftShapes, OpenShapesAreOpen) {
  const SoftShapes shapes(16, 8);
  EXPECT_FALSE(shapes.open_cylinder.closed);
  EXPECT_FALSE(shapes.upper_half.closed);
  EXPECT_FALSE(shapes.plane.closed);
}

TEST(SoftShapes, ClustersContainTheirTrianglesAndVertices) {
  const SoftShapes shapes(64, 32);
  const SoftMesh& mesh = shapes.sphere;
  const SoftClusters& clusters = mesh.clusters;
  ASSERT_EQ(clusters.count, (mesh.triangles + 63) / 64);
  for (int t = 0; t < mesh.triangles; ++t) {
    const int c = t / SoftClusters::kTriangles;
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.corners[k][t];
      const Eigen::Vector3f from(mesh.x[v] - clusters.x[c], mesh.y[v] - clusters.y[c],
                                 mesh.z[v] - clusters.z[c]);
      EXPECT_LE(from.norm(), clusters.radius[c]) << "triangle " << t;
      EXPECT_GE(v / SoftClusters::kVertices, clusters.first_group[c]);
      EXPECT_LE(v / SoftClusters::kVertices, clusters.last_group[c]);
    }
  }
  EXPECT_EQ(shapes.box.clusters.count, 0);
}

TEST(SoftShapes, MeshesAndHeightFieldsOfAModel) {
  const ModelPtr model = Compile(ParseXmlString(R"(<mujoco><asset>
      <mesh name="tetra" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
      <hfield name="hills" nrow="3" ncol="4" size="1 2 .5 .25" elevation="0 0 0 0  0 1 1 0  0 0 0 0"/>
    </asset></mujoco>)")
                                     .get());
  const SoftMesh tetra = MeshOfModel(model.get(), 0), hills = HeightFieldOfModel(model.get(), 0);
  EXPECT_EQ(tetra.triangles, 4);
  EXPECT_TRUE(tetra.closed);
  EXPECT_NEAR(VolumeOf(tetra), 1.0 / 6, 1e-6);
  EXPECT_GT(VolumeOf(hills), 2 * 4 * 0.25);  // more than its base
  EXPECT_FLOAT_EQ(hills.high.z(), 0.5F);
  EXPECT_FLOAT_EQ(hills.low.z(), -0.25F);
}

}  // namespace
}  // namespace robocell::internal
