#include "robocell/render/soft_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <Eigen/Geometry>

namespace robocell::internal {
namespace {

size_t Padded(size_t size) { return (size + kSoftPadding - 1) / kSoftPadding * kSoftPadding; }

uint32_t Word(float low, float high) {
  const auto half = [](float v) {
    return static_cast<uint32_t>(static_cast<uint16_t>(
        static_cast<int16_t>(std::lround(32767 * std::clamp(v, -1.0f, 1.0f)))));
  };
  return half(low) | half(high) << 16;
}

// The corners' normals are of unit length.
SoftSurface SurfaceOf(const Eigen::Vector3d& first, const Eigen::Vector3d& u,
                      const Eigen::Vector3d& v, const SoftCorner* corners) {
  const Eigen::Vector3d normal = u.cross(v);
  const Eigen::Vector3d to1 = v.cross(normal) / normal.squaredNorm(),
                        to2 = normal.cross(u) / normal.squaredNorm();
  SoftSurface s{};
  for (int k = 0; k < 3; ++k) {
    s.to1[k] = static_cast<float>(to1[k]);
    s.to2[k] = static_cast<float>(to2[k]);
  }
  s.at1 = static_cast<float>(to1.dot(first));
  s.at2 = static_cast<float>(to2.dot(first));
  float n[10] = {};
  for (int k = 0; k < 9; ++k) n[k] = corners[k / 3].normal[k % 3];
  for (int k = 0; k < 5; ++k) s.normals[k] = Word(n[2 * k], n[2 * k + 1]);
  s.flat = std::equal(n, n + 6, n + 3) ? 1 : 0;
  return s;
}

uint64_t Mixed(uint64_t x) {  // the finaliser of SplitMix64
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

// Returns equal keys for vertices at one place.
uint64_t KeyOf(const Eigen::Vector3f& p) {
  uint64_t key = 0;
  for (const float v : p) key = Mixed(key + std::bit_cast<uint32_t>(v + 0.0f) + 1);  // no -0
  return key;
}

// Returns the sum of an edge in one direction; the sum of both directions is 0.
uint64_t EdgeSum(uint64_t from, uint64_t to) {
  const uint64_t key = Mixed(std::min(from, to) + Mixed(std::max(from, to)));
  return from < to ? key : uint64_t{0} - key;
}

// Fewer triangles are not worth the look.
constexpr int kLeastClustered = 8 * SoftClusters::kTriangles;

void MakeClusters(SoftMesh* mesh) {
  SoftClusters& clusters = mesh->clusters;
  clusters.count =
      mesh->triangles < kLeastClustered
          ? 0
          : (mesh->triangles + SoftClusters::kTriangles - 1) / SoftClusters::kTriangles;
  const size_t size = Padded(static_cast<size_t>(clusters.count));
  for (auto* row : {&clusters.x, &clusters.y, &clusters.z, &clusters.radius})
    row->assign(size, 0.0f);
  for (auto* row : {&clusters.first_group, &clusters.last_group}) row->assign(size, 0);
  for (int c = 0; c < clusters.count; ++c) {
    const int begin = SoftClusters::kTriangles * c,
              end = std::min(begin + SoftClusters::kTriangles, mesh->triangles);
    const auto at = [&](int vertex) {
      return Eigen::Vector3f(mesh->x[static_cast<size_t>(vertex)],
                             mesh->y[static_cast<size_t>(vertex)],
                             mesh->z[static_cast<size_t>(vertex)]);
    };
    int first = mesh->vertices, last = 0;
    Eigen::Vector3f low = at(mesh->corners[0][static_cast<size_t>(begin)]), high = low;
    const auto each = [&](const auto& visit) {
      for (int t = begin; t < end; ++t) {
        for (const auto& corner : mesh->corners) visit(corner[static_cast<size_t>(t)]);
      }
    };
    each([&](int vertex) {
      first = std::min(first, vertex);
      last = std::max(last, vertex);
      low = low.cwiseMin(at(vertex));
      high = high.cwiseMax(at(vertex));
    });
    const Eigen::Vector3f centre = 0.5f * (low + high);
    float radius = 0;
    each([&](int vertex) { radius = std::max(radius, (at(vertex) - centre).norm()); });
    const auto i = static_cast<size_t>(c);
    clusters.x[i] = centre.x();
    clusters.y[i] = centre.y();
    clusters.z[i] = centre.z();
    clusters.radius[i] = 1.0001f * radius;
    clusters.first_group[i] = first / SoftClusters::kVertices;
    clusters.last_group[i] = last / SoftClusters::kVertices;
  }
}

}  // namespace

int SoftMeshBuilder::Vertex(const Eigen::Vector3f& position) {
  vertices_.push_back(position);
  return static_cast<int>(vertices_.size()) - 1;
}

void SoftMeshBuilder::Triangle(const SoftCorner& a, const SoftCorner& b, const SoftCorner& c) {
  const Eigen::Vector3d first = vertices_[a.vertex].cast<double>();
  const Eigen::Vector3d normal = (vertices_[b.vertex].cast<double>() - first)
                                     .cross(vertices_[c.vertex].cast<double>() - first);
  if (normal.squaredNorm() < 1e-60) return;
  corners_.insert(corners_.end(), {a, b, c});
}

void SoftMeshBuilder::Triangle(int a, int b, int c) {
  const Eigen::Vector3f normal =
      (vertices_[b] - vertices_[a]).cross(vertices_[c] - vertices_[a]).normalized();
  Triangle({a, normal}, {b, normal}, {c, normal});
}

void SoftMeshBuilder::Quad(int a, int b, int c, int d) {
  Triangle(a, b, c);
  Triangle(a, c, d);
}

SoftMesh SoftMeshBuilder::Build(bool with_texture) {
  SoftMesh mesh;
  Build(&mesh, with_texture);
  return mesh;
}

namespace {

// Spreads the lowest 10 bits to every third bit.
uint32_t EveryThird(uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ff;
  bits = (bits | bits << 8) & 0x0300f00f;
  bits = (bits | bits << 4) & 0x030c30c3;
  return (bits | bits << 2) & 0x09249249;
}

}  // namespace

void SoftMeshBuilder::SortTriangles() {
  const size_t count = corners_.size() / 3;
  if (count < static_cast<size_t>(kLeastClustered)) return;
  const auto corner = [&](size_t t, size_t k) -> const Eigen::Vector3f& {
    return vertices_[static_cast<size_t>(corners_[3 * t + k].vertex)];
  };
  const auto middle = [&](size_t t) -> Eigen::Vector3f {
    return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
  };
  // Triangles that follow each other are neighbours in most files. A few tell.
  constexpr size_t kEvery = 16;
  constexpr float kFar = 6;  // sizes of a triangle
  float step = 0, size = 0;
  for (size_t t = 0; t + 1 < count; t += kEvery) {
    step += (middle(t + 1) - middle(t)).norm();
    size += std::sqrt((corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm());
  }
  if (step <= kFar * size) return;
  Eigen::Vector3f low = middle(0), high = low;
  for (size_t t = 1; t < count; ++t) {
    low = low.cwiseMin(middle(t));
    high = high.cwiseMax(middle(t));
  }
  const float longest = std::max((high - low).maxCoeff(), 1e-9f);
  // Along a curve that passes through each part of space once (Morton's); equal ones in their order.
  std::vector<std::pair<uint32_t, uint32_t>> order(count);
  for (size_t t = 0; t < count; ++t) {
    const Eigen::Vector3f at = 1023 / longest * (middle(t) - low);
    order[t] = {EveryThird(static_cast<uint32_t>(at.x())) |
                    EveryThird(static_cast<uint32_t>(at.y())) << 1 |
                    EveryThird(static_cast<uint32_t>(at.z())) << 2,
                static_cast<uint32_t>(t)};
  }
  std::sort(order.begin(), order.end());
  std::vector<SoftCorner> sorted;
  sorted.reserve(corners_.size());
  for (const auto& [key, t] : order) {
    const auto first = corners_.begin() + 3 * static_cast<std::ptrdiff_t>(t);
    sorted.insert(sorted.end(), first, first + 3);
  }
  corners_.swap(sorted);
}

// Puts vertices into the order in which the triangles use them: those of triangles that follow each
// other lie together.
void SoftMeshBuilder::SortVertices() {
  place_.assign(vertices_.size(), -1);
  sorted_.clear();
  for (SoftCorner& corner : corners_) {
    int& place = place_[static_cast<size_t>(corner.vertex)];
    if (place < 0) {
      place = static_cast<int>(sorted_.size());
      sorted_.push_back(vertices_[static_cast<size_t>(corner.vertex)]);
    }
    corner.vertex = place;
  }
  vertices_.swap(sorted_);
}

void SoftMeshBuilder::Build(SoftMesh* out, bool with_texture) {
  SoftMesh& mesh = *out;
  SortVertices();
  const size_t vertices = vertices_.size(), triangles = corners_.size() / 3;
  mesh.vertices = static_cast<int>(vertices);
  mesh.triangles = static_cast<int>(triangles);
  for (auto* row : {&mesh.x, &mesh.y, &mesh.z}) row->resize(Padded(vertices));
  for (size_t i = 0; i < Padded(vertices); ++i) {
    const Eigen::Vector3f& p = vertices_[std::min(i, vertices - 1)];
    mesh.x[i] = p.x();
    mesh.y[i] = p.y();
    mesh.z[i] = p.z();
  }
  mesh.low = mesh.high = vertices > 0 ? vertices_[0] : Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : vertices_) {
    mesh.low = mesh.low.cwiseMin(p);
    mesh.high = mesh.high.cwiseMax(p);
  }
  for (auto& row : mesh.facing) row.assign(Padded(triangles), 0.0f);
  mesh.surface.resize(triangles);
  mesh.texture.resize(with_texture ? SoftMesh::kTexture * triangles : 0);
  for (auto& row : mesh.corners) row.assign(Padded(triangles), 0);
  // In a closed mesh each edge occurs as often in one direction as in the other.
  uint64_t edges = 0;
  for (size_t t = 0; t < triangles; ++t) {
    uint64_t key[3];
    for (size_t k = 0; k < 3; ++k) key[k] = KeyOf(vertices_[corners_[3 * t + k].vertex]);
    for (int k = 0; k < 3; ++k) edges += EdgeSum(key[k], key[(k + 1) % 3]);
    const SoftCorner* corner = &corners_[3 * t];
    for (int k = 0; k < 3; ++k) mesh.corners[k][t] = corner[k].vertex;
    const Eigen::Vector3d first = vertices_[corner[0].vertex].cast<double>();
    const Eigen::Vector3d u = vertices_[corner[1].vertex].cast<double>() - first;
    const Eigen::Vector3d v = vertices_[corner[2].vertex].cast<double>() - first;
    const Eigen::Vector3d normal = u.cross(v);
    const double square = normal.squaredNorm();
    const Eigen::Vector3d unit = normal / std::sqrt(square);
    for (int k = 0; k < 3; ++k) mesh.facing[k][t] = static_cast<float>(unit[k]);
    mesh.facing[3][t] = static_cast<float>(-unit.dot(first));
    mesh.surface[t] = SurfaceOf(first, u, v, corner);
    if (!with_texture) continue;
    float* to = &mesh.texture[SoftMesh::kTexture * t];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2f value =
          k == 0 ? corner[0].texture : Eigen::Vector2f(corner[k].texture - corner[0].texture);
      to[2 * k] = value.x();
      to[2 * k + 1] = value.y();
    }
  }
  mesh.closed = triangles > 0 && edges == 0;
  MakeClusters(&mesh);
  vertices_.clear();
  corners_.clear();
}

}  // namespace robocell::internal
