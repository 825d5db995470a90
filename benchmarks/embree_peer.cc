// Embree's side of row P11b: a ray caster with hard shadows on one core.
//
//   build/bench/embree_peer MODEL.mjb STATES NEAR FAR DISTANCE AZIMUTH ELEVATION X Y Z
//
// render.py compiles it against Debian's libembree-dev and the headers of MuJoCo. Each line of
// STATES is a qpos. Prints as JSON the milliseconds of each image of 640 x 480: poses, the update
// of Embree's scene, and for each pixel a ray and, towards the first light that casts shadows, a
// second one; colour, depth in metres and body ids. Rays are cast 16 at once. Meshes keep their
// trees; only their poses change. Colours are plain: diffuse light, no textures, no highlights, no
// samples, which is less than the side beside it draws.
#include <embree3/rtcore.h>
#include <mujoco/mujoco.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int kWidth = 640, kHeight = 480, kPacket = 16;
constexpr double kPi = 3.14159265358979323846;

struct Triangles {
  std::vector<float> vertices;
  std::vector<unsigned> faces;

  unsigned Vertex(double x, double y, double z) {
    for (const double v : {x, y, z}) vertices.push_back(static_cast<float>(v));
    return static_cast<unsigned>(vertices.size() / 3 - 1);
  }
};

// Returns a surface of revolution around z through points of radius and height.
Triangles Turned(const std::vector<std::pair<double, double>>& profile) {
  constexpr int kSides = 28;
  Triangles t;
  for (const auto& [radius, z] : profile) {
    for (int i = 0; i < kSides; ++i) {
      const double a = 2 * kPi * i / kSides;
      t.Vertex(radius * std::cos(a), radius * std::sin(a), z);
    }
  }
  for (unsigned r = 0; r + 1 < profile.size(); ++r) {
    for (unsigned i = 0; i < kSides; ++i) {
      const unsigned a = r * kSides + i, b = r * kSides + (i + 1) % kSides;
      for (const unsigned v : {a, b, b + kSides, a, b + kSides, a + kSides}) t.faces.push_back(v);
    }
  }
  return t;
}

Triangles ShapeOf(const mjModel* m, int g) {
  const mjtNum* s = m->geom_size + 3 * g;
  Triangles t;
  std::vector<std::pair<double, double>> profile;
  constexpr int kRings = 16;
  switch (m->geom_type[g]) {
    case mjGEOM_MESH: {
      const int mesh = m->geom_dataid[g];
      const float* v = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
      t.vertices.assign(v, v + 3 * m->mesh_vertnum[mesh]);
      const int* f = m->mesh_face + 3 * m->mesh_faceadr[mesh];
      t.faces.assign(f, f + 3 * m->mesh_facenum[mesh]);
      return t;
    }
    case mjGEOM_PLANE: {
      const double x = s[0] > 0 ? s[0] : 100, y = s[1] > 0 ? s[1] : 100;
      t.Vertex(-x, -y, 0), t.Vertex(x, -y, 0), t.Vertex(x, y, 0), t.Vertex(-x, y, 0);
      t.faces = {0, 1, 2, 0, 2, 3};
      return t;
    }
    case mjGEOM_BOX:
      for (int k = 0; k < 8; ++k) {
        t.Vertex(k & 1 ? s[0] : -s[0], k & 2 ? s[1] : -s[1], k & 4 ? s[2] : -s[2]);
      }
      t.faces = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
      return t;
    case mjGEOM_CYLINDER:
      return Turned({{0, -s[1]}, {s[0], -s[1]}, {s[0], s[1]}, {0, s[1]}});
    case mjGEOM_CAPSULE:
    case mjGEOM_SPHERE:
    case mjGEOM_ELLIPSOID: {
      const bool capsule = m->geom_type[g] == mjGEOM_CAPSULE;
      for (int i = 0; i <= kRings; ++i) {
        const double a = kPi * i / kRings - kPi / 2;
        const double up = capsule ? (i < kRings / 2 ? -s[1] : s[1]) : 0;
        profile.emplace_back(s[0] * std::cos(a), s[0] * std::sin(a) + up);
      }
      t = Turned(profile);
      if (m->geom_type[g] != mjGEOM_ELLIPSOID) return t;
      for (size_t i = 0; i < t.vertices.size(); ++i) {
        t.vertices[i] *= static_cast<float>(s[i % 3] / s[0]);
      }
      return t;
    }
    default:
      return t;
  }
}

RTCScene TreeOf(RTCDevice device, const Triangles& t) {
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           3 * sizeof(float), t.vertices.size() / 3);
  std::copy(t.vertices.begin(), t.vertices.end(), static_cast<float*>(vertices));
  void* faces = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                        3 * sizeof(unsigned), t.faces.size() / 3);
  std::copy(t.faces.begin(), t.faces.end(), static_cast<unsigned*>(faces));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

struct Drawn {
  int geom;
  RTCGeometry instance;
};

struct Images {
  std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * kWidth * kHeight);
  std::vector<float> depth = std::vector<float>(kWidth * kHeight);
  std::vector<int> ids = std::vector<int>(kWidth * kHeight);
};

void Place(const mjData* d, const Drawn& drawn) {
  const mjtNum *r = d->geom_xmat + 9 * drawn.geom, *p = d->geom_xpos + 3 * drawn.geom;
  float m[12];
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) m[4 * row + c] = static_cast<float>(r[3 * row + c]);
    m[4 * row + 3] = static_cast<float>(p[row]);
  }
  rtcSetGeometryTransform(drawn.instance, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, m);
  rtcCommitGeometry(drawn.instance);
}

struct View {
  double eye[3], right[3], up[3], forward[3], scale;  // scale: metres per pixel at depth 1
  float near, far;
};

void Draw(const mjModel* m, const mjData* d, RTCScene scene, const std::vector<Drawn>& drawn,
          const View& view, int light, Images* out) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  float to_light[3] = {0, 0, 1};
  for (int k = 0; k < 3 && light >= 0; ++k) {
    to_light[k] = static_cast<float>(-d->light_xdir[3 * light + k]);
  }
  alignas(64) int valid[kPacket];
  std::fill_n(valid, kPacket, -1);
  for (int by = 0; by < kHeight; by += 4) {
    for (int bx = 0; bx < kWidth; bx += 4) {
      RTCRayHit16 rays;
      RTCRay16 shadow;
      for (int k = 0; k < kPacket; ++k) {
        const double x = (bx + k % 4 - 0.5 * (kWidth - 1)) * view.scale,
                     y = (0.5 * (kHeight - 1) - by - k / 4) * view.scale;
        float along[3];
        for (int c = 0; c < 3; ++c) {
          along[c] = static_cast<float>(view.forward[c] + x * view.right[c] + y * view.up[c]);
        }
        rays.ray.org_x[k] = static_cast<float>(view.eye[0]);
        rays.ray.org_y[k] = static_cast<float>(view.eye[1]);
        rays.ray.org_z[k] = static_cast<float>(view.eye[2]);
        rays.ray.dir_x[k] = along[0];
        rays.ray.dir_y[k] = along[1];
        rays.ray.dir_z[k] = along[2];
        rays.ray.tnear[k] = view.near;  // directions have depth 1, so these are depths
        rays.ray.tfar[k] = view.far;
        rays.ray.time[k] = 0;
        rays.ray.mask[k] = ~0u;
        rays.ray.flags[k] = 0;
        rays.hit.geomID[k] = rays.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, scene, &context, &rays);
      alignas(64) int hit[kPacket];
      float facing[kPacket];
      for (int k = 0; k < kPacket; ++k) {
        hit[k] = rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? 0 : -1;
        facing[k] = 0;
        if (!hit[k]) continue;
        const int geom = drawn[rays.hit.instID[0][k]].geom;
        const mjtNum* r = d->geom_xmat + 9 * geom;
        const float n[3] = {rays.hit.Ng_x[k], rays.hit.Ng_y[k], rays.hit.Ng_z[k]};
        float world[3], length = 0, eye = 0;
        for (int c = 0; c < 3; ++c) {
          world[c] =
              static_cast<float>(r[3 * c] * n[0] + r[3 * c + 1] * n[1] + r[3 * c + 2] * n[2]);
          length += world[c] * world[c];
        }
        eye = world[0] * rays.ray.dir_x[k] + world[1] * rays.ray.dir_y[k] +
              world[2] * rays.ray.dir_z[k];
        const float scale = (eye > 0 ? -1 : 1) / std::sqrt(length);
        for (int c = 0; c < 3; ++c) facing[k] += scale * world[c] * to_light[c];
        const float t = rays.ray.tfar[k];
        shadow.org_x[k] = rays.ray.org_x[k] + t * rays.ray.dir_x[k];
        shadow.org_y[k] = rays.ray.org_y[k] + t * rays.ray.dir_y[k];
        shadow.org_z[k] = rays.ray.org_z[k] + t * rays.ray.dir_z[k];
        shadow.dir_x[k] = to_light[0];
        shadow.dir_y[k] = to_light[1];
        shadow.dir_z[k] = to_light[2];
        shadow.tnear[k] = 1e-3f;
        shadow.tfar[k] = view.far;
        shadow.time[k] = 0;
        shadow.mask[k] = ~0u;
        shadow.flags[k] = 0;
      }
      alignas(64) int lit[kPacket];
      for (int k = 0; k < kPacket; ++k) lit[k] = hit[k] && facing[k] > 0 ? -1 : 0;
      rtcOccluded16(lit, scene, &context, &shadow);
      for (int k = 0; k < kPacket; ++k) {
        const int pixel = (by + k / 4) * kWidth + bx + k % 4;
        const int geom = hit[k] ? drawn[rays.hit.instID[0][k]].geom : -1;
        out->depth[pixel] = hit[k] ? rays.ray.tfar[k] : 0;
        out->ids[pixel] = hit[k] ? m->geom_bodyid[geom] : -1;
        const float light_here = lit[k] && shadow.tfar[k] > 0 ? facing[k] : 0;
        for (int c = 0; c < 3; ++c) {
          const int material = hit[k] ? m->geom_matid[geom] : -1;
          const float base = !hit[k]         ? 0
                             : material >= 0 ? m->mat_rgba[4 * material + c]
                                             : m->geom_rgba[4 * geom + c];
          out->rgb[3 * pixel + c] =
              static_cast<uint8_t>(255 * std::min(1.0f, base * (0.4f + 0.6f * light_here)));
        }
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 11) return std::fprintf(stderr, "usage: see the first lines of the source\n"), 2;
  mjModel* m = mj_loadModel(argv[1], nullptr);
  mjData* d = mj_makeData(m);
  const auto number = [&](int i) { return std::atof(argv[i]); };
  RTCDevice device = rtcNewDevice("threads=1,isa=default");
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  std::map<int, RTCScene> meshes;
  std::vector<Drawn> drawn;
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->geom_group[g] > 2 || m->geom_rgba[4 * g + 3] == 0) continue;
    const int mesh = m->geom_type[g] == mjGEOM_MESH ? m->geom_dataid[g] : -1;
    RTCScene tree = mesh >= 0 && meshes.count(mesh) ? meshes[mesh] : nullptr;
    if (!tree) {
      const Triangles shape = ShapeOf(m, g);
      if (shape.faces.empty()) continue;
      tree = TreeOf(device, shape);
      if (mesh >= 0) meshes[mesh] = tree;
    }
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, tree);
    rtcAttachGeometryByID(scene, instance, static_cast<unsigned>(drawn.size()));
    drawn.push_back({g, instance});
  }
  int light = -1;
  for (int l = m->nlight - 1; l >= 0; --l) {
    if (m->light_castshadow[l]) light = l;
  }
  View view;
  const double distance = number(5), azimuth = number(6) * kPi / 180, up = number(7) * kPi / 180;
  const double forward[3] = {std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth),
                             std::sin(up)};
  const double right[3] = {std::sin(azimuth), -std::cos(azimuth), 0};
  mju_cross(view.up, right, forward);
  for (int c = 0; c < 3; ++c) {
    view.forward[c] = forward[c];
    view.right[c] = right[c];
    view.eye[c] = number(8 + c) - distance * forward[c];
  }
  view.scale = 2 * std::tan(0.5 * 45 * kPi / 180) / kHeight;
  view.near = static_cast<float>(number(3));
  view.far = static_cast<float>(number(4));
  Images images;
  std::ifstream states(argv[2]);
  std::string line, said;
  while (std::getline(states, line)) {
    std::istringstream numbers(line);
    for (int i = 0; i < m->nq; ++i) numbers >> d->qpos[i];
    const auto begin = std::chrono::steady_clock::now();
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_camlight(m, d);
    for (const Drawn& one : drawn) Place(d, one);
    rtcCommitScene(scene);
    Draw(m, d, scene, drawn, view, light, &images);
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - begin;
    said += (said.empty() ? "" : ", ") + std::to_string(taken.count());
  }
  if (const char* picture = std::getenv("EMBREE_PICTURE")) {
    std::ofstream file(picture, std::ios::binary);
    file << "P6\n" << kWidth << " " << kHeight << "\n255\n";
    file.write(reinterpret_cast<const char*>(images.rgb.data()),
               static_cast<std::streamsize>(images.rgb.size()));
  }
  std::printf("[%s]\n", said.c_str());
}
