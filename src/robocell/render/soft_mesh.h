// Triangle meshes in the layout of the software renderer: values of all triangles that every frame
// needs are in rows of one number each, values of visible triangles are stored by triangle.
// Internal to render/.
#pragma once

#include <cstdint>
#include <vector>
#include <Eigen/Core>

namespace robocell::internal {

// Data that colours a visible triangle; one line of the cache.
struct alignas(64) SoftSurface {
  // The weight of the second corner at a point is to1 . p - at1, that of the third to2 . p - at2.
  float to1[3], at1, to2[3], at2;
  // The normals at the corners, 9 numbers in 16 bits each, two in a word.
  uint32_t normals[5];
  uint32_t flat;  // 1: all three are the same
  uint32_t unused[2];
};

// Triangles that follow each other, and a ball around each group of them. Those that cannot be
// seen are left out together.
struct SoftClusters {
  static constexpr int kTriangles = 64;
  // Vertices are placed in groups of this many.
  static constexpr int kVertices = 64;

  int count = 0;
  std::vector<float> x, y, z, radius;            // padded with balls of nothing
  std::vector<int32_t> first_group, last_group;  // first and last group of vertices
};

struct SoftMesh {
  // u and v at the first corner, then the differences to the second and to the third.
  static constexpr int kTexture = 6;

  int vertices = 0, triangles = 0;
  bool closed = false;         // it has an inside, which is never visible
  std::vector<float> x, y, z;  // padded with copies of the last vertex
  std::vector<int32_t>
      corners[3];  // vertices of each triangle, counter-clockwise from outside; padded with 0
  std::vector<float> facing[4];  // plane of each triangle; padded with 0
  std::vector<SoftSurface> surface;
  std::vector<float> texture;  // kTexture a triangle, or empty
  Eigen::Vector3f low = {0, 0, 0}, high = {0, 0, 0};
  SoftClusters clusters;  // none in small meshes
};

// Rows are padded to a multiple of this.
inline constexpr int kSoftPadding = 16;

struct SoftCorner {
  int vertex = 0;
  Eigen::Vector3f normal;
  Eigen::Vector2f texture = Eigen::Vector2f::Zero();
};

class SoftMeshBuilder {
 public:
  int Vertex(const Eigen::Vector3f& position);
  // Leaves out triangles without an area.
  void Triangle(const SoftCorner& a, const SoftCorner& b, const SoftCorner& c);
  // Adds a flat one.
  void Triangle(int a, int b, int c);
  void Quad(int a, int b, int c, int d);
  // Orders the triangles so that those that follow each other lie together, and clusters are small.
  // Does nothing where they do already, as in most files, nor to meshes too small for clusters.
  void SortTriangles();
  // Replaces the mesh and empties the builder. Building again at the same size does not allocate.
  void Build(SoftMesh* mesh, bool with_texture = false);
  SoftMesh Build(bool with_texture = false);

 private:
  void SortVertices();

  std::vector<Eigen::Vector3f> vertices_, sorted_;
  std::vector<int> place_;
  std::vector<SoftCorner> corners_;
};

}  // namespace robocell::internal
