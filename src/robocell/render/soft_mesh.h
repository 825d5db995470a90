// Triangle meshes as the software renderer reads them: what every frame needs of all triangles is
// in rows of one number each, and what only visible triangles need is kept by triangle. Internal to
// render/.
#pragma once

#include <cstdint>
#include <vector>
#include <Eigen/Core>

namespace robocell::internal {

struct SoftMesh {
  // Numbers a triangle has in `surface`: first corner; the two vectors whose products with an
  // offset from it are the weights of the second and the third corner; normal at the first corner
  // and the differences to the normals at the other two.
  static constexpr int kSurface = 18;
  // u and v at the first corner, then the differences to the second and to the third.
  static constexpr int kTexture = 6;

  int vertices = 0, triangles = 0;
  std::vector<float> x, y, z;    // padded with copies of the last vertex
  std::vector<int32_t> corners;  // 3 a triangle, counter-clockwise from outside
  std::vector<float> facing[4];  // plane of each triangle; padded with 0
  std::vector<float> surface;    // kSurface a triangle
  std::vector<float> texture;    // kTexture a triangle, or empty
  Eigen::Vector3f low = {0, 0, 0}, high = {0, 0, 0};
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
  // Triangles without an area are left out.
  void Triangle(const SoftCorner& a, const SoftCorner& b, const SoftCorner& c);
  // A flat one.
  void Triangle(int a, int b, int c);
  void Quad(int a, int b, int c, int d);
  // Replaces the mesh and empties the builder. What is built again at the same size allocates
  // nothing.
  void Build(SoftMesh* mesh, bool with_texture = false);
  SoftMesh Build(bool with_texture = false);

 private:
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<SoftCorner> corners_;
};

}  // namespace robocell::internal
