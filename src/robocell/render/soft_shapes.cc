#include "robocell/render/soft_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <Eigen/Geometry>

namespace robocell::internal {
namespace {

// A point of an outline that is rotated around z, and the normal there.
struct Outline {
  float radius, z, normal_r, normal_z;
};

Outline OnSphere(double elevation, float centre) {
  const auto c = static_cast<float>(std::cos(elevation)),
             s = static_cast<float>(std::sin(elevation));
  const bool pole = std::abs(elevation) > 0.4999999 * std::numbers::pi;
  return {pole ? 0 : c, s + centre, pole ? 0 : c, s};
}

// Adds the surface of revolution of one piece of the outline, from below to above as seen from
// outside.
void Revolve(SoftMeshBuilder& mesh, int slices, const Outline& from, const Outline& to) {
  struct Ring {
    Outline at;
    std::vector<int> vertices;
  };
  const auto angle = [&](int j) { return 2 * std::numbers::pi * j / slices; };
  const auto ring = [&](const Outline& at) {
    Ring out{at, {}};
    for (int j = 0; j < (at.radius == 0 ? 1 : slices); ++j) {
      out.vertices.push_back(
          mesh.Vertex({static_cast<float>(std::cos(angle(j))) * at.radius,
                       static_cast<float>(std::sin(angle(j))) * at.radius, at.z}));
    }
    return out;
  };
  const auto corner = [&](const Ring& r, int j, double of_normal) -> SoftCorner {
    const double a = 2 * std::numbers::pi * of_normal / slices;
    return {r.vertices[r.vertices.size() == 1 ? 0 : j % slices],
            {static_cast<float>(std::cos(a)) * r.at.normal_r,
             static_cast<float>(std::sin(a)) * r.at.normal_r, r.at.normal_z}};
  };
  const Ring low = ring(from), high = ring(to);
  for (int j = 0; j < slices; ++j) {
    if (low.vertices.size() > 1) {
      const double at = high.vertices.size() == 1 ? j + 0.5 : j + 1;
      mesh.Triangle(corner(low, j, j), corner(low, j + 1, j + 1), corner(high, j + 1, at));
    }
    if (high.vertices.size() > 1) {
      const double at = low.vertices.size() == 1 ? j + 0.5 : j;
      mesh.Triangle(corner(low, j, at), corner(high, j + 1, j + 1), corner(high, j, j));
    }
  }
}

// Adds the part from elevation 90 degrees * first / stacks to 90 degrees * last / stacks.
void SpherePart(SoftMeshBuilder& mesh, int slices, int stacks, int first, int last, float centre) {
  const auto elevation = [&](int i) { return 0.5 * std::numbers::pi * i / stacks; };
  for (int i = first; i < last; ++i) {
    Revolve(mesh, slices, OnSphere(elevation(i), centre), OnSphere(elevation(i + 1), centre));
  }
}

void AddDisk(SoftMeshBuilder& mesh, int slices, float z, float facing) {
  const Outline centre{0, z, 0, facing}, edge{1, z, 0, facing};
  if (facing > 0) {
    Revolve(mesh, slices, edge, centre);
  } else {
    Revolve(mesh, slices, centre, edge);
  }
}

SoftMesh Box() {
  SoftMeshBuilder mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.Vertex({k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f});
  }
  mesh.Quad(4, 5, 7, 6);
  mesh.Quad(0, 2, 3, 1);
  mesh.Quad(1, 3, 7, 5);
  mesh.Quad(0, 4, 6, 2);
  mesh.Quad(0, 1, 5, 4);
  mesh.Quad(2, 6, 7, 3);
  return mesh.Build();
}

SoftMesh Rectangle(float x, float y) {
  SoftMeshBuilder mesh;
  for (const auto& [a, b] : {std::pair{-x, -y}, {x, -y}, {x, y}, {-x, y}}) mesh.Vertex({a, b, 0});
  mesh.Quad(0, 1, 2, 3);
  return mesh.Build();
}

}  // namespace

SoftShapes::SoftShapes(int slices, int stacks) {
  SoftMeshBuilder mesh;
  const int half = std::max(1, stacks / 2);
  SpherePart(mesh, slices, half, -half, half, 0);
  sphere = mesh.Build();
  SpherePart(mesh, slices, half, 0, half, 1);
  upper_half = mesh.Build();
  SpherePart(mesh, slices, half, -half, 0, -1);
  lower_half = mesh.Build();
  const Outline bottom{1, -1, 1, 0}, top{1, 1, 1, 0};
  Revolve(mesh, slices, bottom, top);
  open_cylinder = mesh.Build();
  AddDisk(mesh, slices, -1, -1);
  Revolve(mesh, slices, bottom, top);
  AddDisk(mesh, slices, 1, 1);
  cylinder = mesh.Build();
  const auto slope = static_cast<float>(std::numbers::sqrt2 / 2);
  Revolve(mesh, slices, {1, 0, slope, slope}, {0, 1, slope, slope});
  AddDisk(mesh, slices, 0, -1);
  cone = mesh.Build();
  box = Box();
  plane = Rectangle(1, 1);
  mesh.Triangle(mesh.Vertex({0, 0, 0}), mesh.Vertex({1, 0, 0}), mesh.Vertex({0, 1, 0}));
  triangle = mesh.Build();
}

SoftMesh MeshOfModel(const mjModel* m, int mesh) {
  using Row3 = Eigen::Map<const Eigen::Vector3f>;
  using Row2 = Eigen::Map<const Eigen::Vector2f>;
  SoftMeshBuilder builder;
  const float* vertex = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
  for (int i = 0; i < m->mesh_vertnum[mesh]; ++i) builder.Vertex(Row3(vertex + 3 * i));
  const float* normals = m->mesh_normal + 3 * m->mesh_normaladr[mesh];
  const int texture = m->mesh_texcoordadr[mesh];
  for (int f = m->mesh_faceadr[mesh]; f < m->mesh_faceadr[mesh] + m->mesh_facenum[mesh]; ++f) {
    const int* face = m->mesh_face + 3 * f;
    const Eigen::Vector3f a = Row3(vertex + 3 * face[0]);
    const Eigen::Vector3f flat =
        (Row3(vertex + 3 * face[1]) - a).cross(Row3(vertex + 3 * face[2]) - a).stableNormalized();
    SoftCorner corners[3];
    for (int k = 0; k < 3; ++k) {
      corners[k] = {face[k], Row3(normals + 3 * m->mesh_facenormal[3 * f + k])};
      if (texture >= 0) {
        corners[k].texture =
            Row2(m->mesh_texcoord + 2 * (m->mesh_facetexcoord[3 * f + k] + texture));
      } else if (corners[k].normal.dot(flat) < 0.8f) {
        corners[k].normal = flat;  // a sharp edge, as MuJoCo draws it
      }
    }
    builder.Triangle(corners[0], corners[1], corners[2]);
  }
  builder.SortTriangles();
  return builder.Build(texture >= 0);
}

SoftMesh PlaneOfModel(const mjModel* m, int geom) {
  const double far = m->vis.map.zfar * m->stat.extent;
  float half[2];
  for (int k = 0; k < 2; ++k) {
    const double size = m->geom_size[3 * geom + k];
    if (size > 0) {
      half[k] = static_cast<float>(size);
      continue;
    }
    // An infinite plane extends beyond the view, and is moved in steps of its texture.
    const int material = m->geom_matid[geom];
    const double repeat = material >= 0 ? m->mat_texrepeat[2 * material + k] : 0;
    half[k] = static_cast<float>(1.05 * far + (repeat > 0 ? 2 / repeat : 0.02 * far));
  }
  return Rectangle(half[0], half[1]);
}

SoftMesh HeightFieldOfModel(const mjModel* m, int field) {
  const float* data = m->hfield_data + m->hfield_adr[field];
  const int rows = m->hfield_nrow[field], columns = m->hfield_ncol[field];
  float size[4];
  for (int k = 0; k < 4; ++k) size[k] = static_cast<float>(m->hfield_size[4 * field + k]);
  SoftMeshBuilder mesh;
  const auto x = [&](int c) {
    return size[0] * (static_cast<float>(c) / (0.5f * static_cast<float>(columns - 1)) - 1);
  };
  const auto y = [&](int r) {
    return size[1] * (static_cast<float>(r) / (0.5f * static_cast<float>(rows - 1)) - 1);
  };
  std::vector<int> top, bottom;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      top.push_back(mesh.Vertex({x(c), y(r), data[r * columns + c] * size[2]}));
      const bool rim = r == 0 || c == 0 || r == rows - 1 || c == columns - 1;
      bottom.push_back(rim ? mesh.Vertex({x(c), y(r), -size[3]}) : -1);
    }
  }
  const auto at = [&](int r, int c) { return r * columns + c; };
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      mesh.Triangle(top[at(r + 1, c)], top[at(r, c)], top[at(r + 1, c + 1)]);
      mesh.Triangle(top[at(r, c)], top[at(r, c + 1)], top[at(r + 1, c + 1)]);
    }
  }
  const auto side = [&](int from, int to) {
    mesh.Quad(bottom[from], bottom[to], top[to], top[from]);
  };
  for (int r = 0; r + 1 < rows; ++r) {
    side(at(r + 1, 0), at(r, 0));
    side(at(r, columns - 1), at(r + 1, columns - 1));
  }
  for (int c = 0; c + 1 < columns; ++c) {
    side(at(0, c), at(0, c + 1));
    side(at(rows - 1, c + 1), at(rows - 1, c));
  }
  mesh.Quad(bottom[at(0, 0)], bottom[at(rows - 1, 0)], bottom[at(rows - 1, columns - 1)],
            bottom[at(0, columns - 1)]);
  return mesh.Build();
}

}  // namespace robocell::internal
