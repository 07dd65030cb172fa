// SPDX-License-Identifier: Apache-2.0
#include "server/scene/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "server/scene/alpha_mask.h"

namespace farfield {
namespace {

// Embree's handles, released in reverse order of being made.
struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;

// What the alpha test of one stored mesh needs.
struct MaskedMesh {
  const StoredMesh* mesh = nullptr;
  const AlphaMask* mask = nullptr;

  bool is_hole(std::uint32_t triangle, float u, float v) const {
    const std::uint32_t* index = &mesh->indices[3 * std::size_t{triangle}];
    const glm::vec2 a = mesh->uvs[index[0]];
    return mask->is_hole(a + u * (mesh->uvs[index[1]] - a) + v * (mesh->uvs[index[2]] - a));
  }
};

// Called for intersection and occlusion alike, with 1 to 16 lanes.
void reject_holes(const RTCFilterFunctionNArguments* args) {
  const MaskedMesh& masked = *static_cast<const MaskedMesh*>(args->geometryUserPtr);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] != -1) continue;
    if (masked.is_hole(RTCHitN_primID(args->hit, args->N, lane), RTCHitN_u(args->hit, args->N, lane),
                     RTCHitN_v(args->hit, args->N, lane)))
      args->valid[lane] = 0;
  }
}

// Embree reports errors through a callback, also from its worker threads.
struct ErrorLog {
  std::mutex mutex;
  std::string first;

  static void record(void* self, RTCError, const char* text) {
    ErrorLog& log = *static_cast<ErrorLog*>(self);
    const std::lock_guard lock(log.mutex);
    if (log.first.empty()) log.first = text ? text : "no reason given";
  }
};

RTCIntersectContext make_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

void copy_rays(const RayPacket& rays, RTCRay16& out, int valid[kPacketSize]) {
  std::memcpy(out.org_x, rays.origin_x, sizeof out.org_x);
  std::memcpy(out.org_y, rays.origin_y, sizeof out.org_y);
  std::memcpy(out.org_z, rays.origin_z, sizeof out.org_z);
  // Embree takes hits at `near` itself: an eye exactly on a surface would see nothing but that, at distance 0, in all directions.
  for (int lane = 0; lane < kPacketSize; ++lane) out.tnear[lane] = std::max(rays.near[lane], std::numeric_limits<float>::min());
  std::memcpy(out.dir_x, rays.direction_x, sizeof out.dir_x);
  std::memcpy(out.dir_y, rays.direction_y, sizeof out.dir_y);
  std::memcpy(out.dir_z, rays.direction_z, sizeof out.dir_z);
  std::memcpy(out.tfar, rays.far, sizeof out.tfar);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    out.time[lane] = 0.0f;
    out.mask[lane] = 0xffffffffu;
    out.id[lane] = static_cast<unsigned>(lane);
    out.flags[lane] = 0;
    valid[lane] = (rays.active >> lane & 1u) && rays.near[lane] <= rays.far[lane] ? -1 : 0;
  }
}

}  // namespace

struct RayScene::State {
  std::unique_ptr<ErrorLog> errors = std::make_unique<ErrorLog>();
  DeviceHandle device;
  std::map<std::pair<int, float>, AlphaMask> masks;  // by texture and cutoff
  std::vector<MaskedMesh> masked;        // one per stored mesh, never moved once Embree knows them
  std::vector<SceneHandle> mesh_scenes;  // of instanced meshes, empty otherwise
  SceneHandle top;
  std::vector<glm::mat3> scene_normal_from_mesh;  // per part: cofactor matrix, so normals keep twice the area as length
  std::uint32_t first_instance = 0;

  void attach(RTCScene scene, const StoredMesh& mesh, unsigned mesh_index, unsigned id);
  RTCScene mesh_scene(std::span<const StoredMesh> meshes, unsigned mesh_index);
  void closest_hits(const RayPacket& rays, bool coherent, RTCRayHit16& packet) const;
};

void RayScene::State::attach(RTCScene scene, const StoredMesh& mesh, unsigned mesh_index, unsigned id) {
  const RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(glm::vec3), mesh.vertex_count());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0,
                             3 * sizeof(std::uint32_t), mesh.triangle_count());
  if (mesh.surface.is_alpha_masked) {
    rtcSetGeometryUserData(geometry, &masked[mesh_index]);
    rtcSetGeometryIntersectFilterFunction(geometry, reject_holes);
    rtcSetGeometryOccludedFilterFunction(geometry, reject_holes);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);  // the scene holds it now
}

RTCScene RayScene::State::mesh_scene(std::span<const StoredMesh> meshes, unsigned mesh_index) {
  SceneHandle& handle = mesh_scenes[mesh_index];
  if (!handle) {
    handle.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(handle.get(), RTC_SCENE_FLAG_ROBUST);
    attach(handle.get(), meshes[mesh_index], mesh_index, 0);
    rtcJoinCommitScene(handle.get());
  }
  return handle.get();
}

RayScene::RayScene() = default;
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

Result<RayScene> RayScene::build(std::span<const StoredMesh> meshes, std::span<const ScenePart> parts,
                                 std::size_t flattened_parts, const TextureSet& textures) {
  RayScene result;
  result.state_ = std::make_unique<State>();
  State& state = *result.state_;
  state.device.reset(rtcNewDevice(nullptr));
  if (!state.device)
    return fail(ErrorCode::kInternal, "Embree: cannot make a device (error {})",
                static_cast<int>(rtcGetDeviceError(nullptr)));
  rtcSetDeviceErrorFunction(state.device.get(), ErrorLog::record, state.errors.get());
  for (const StoredMesh& mesh : meshes) {
    const SurfaceState& surface = mesh.surface;
    const AlphaMask* mask = nullptr;
    if (surface.is_alpha_masked) {
      mask = &state.masks.try_emplace({surface.texture, surface.alpha_cutoff}, textures, static_cast<std::uint32_t>(surface.texture), surface.alpha_cutoff)
                  .first->second;
    }
    state.masked.push_back({&mesh, mask});
  }
  state.mesh_scenes.resize(meshes.size());
  state.first_instance = static_cast<std::uint32_t>(flattened_parts);
  state.top.reset(rtcNewScene(state.device.get()));
  // Without this flag rays through shared edges may slip between two triangles.
  rtcSetSceneFlags(state.top.get(), RTC_SCENE_FLAG_ROBUST);

  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ScenePart& part = parts[i];
    const auto id = static_cast<unsigned>(i);
    const glm::mat3 m(part.scene_from_mesh);
    state.scene_normal_from_mesh.emplace_back(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    if (meshes[part.mesh].triangle_count() == 0) continue;
    if (i < flattened_parts) {
      state.attach(state.top.get(), meshes[part.mesh], part.mesh, id);
      continue;
    }
    const RTCGeometry instance = rtcNewGeometry(state.device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, state.mesh_scene(meshes, part.mesh));
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &part.scene_from_mesh);
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(state.top.get(), instance, id);
    rtcReleaseGeometry(instance);
  }
  rtcJoinCommitScene(state.top.get());
  if (!state.errors->first.empty())
    return fail(ErrorCode::kInternal, "Embree: {} (out of memory? a smaller scene or more memory helps)",
                state.errors->first);
  return result;
}

void RayScene::State::closest_hits(const RayPacket& rays, bool coherent, RTCRayHit16& packet) const {
  alignas(64) int valid[kPacketSize];
  copy_rays(rays, packet.ray, valid);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context =
      make_context(coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect16(valid, top.get(), &context, &packet);
}

void RayScene::intersect(const RayPacket& rays, HitPacket& hits, bool coherent) const {
  alignas(64) RTCRayHit16 packet;
  state_->closest_hits(rays, coherent, packet);
  std::memcpy(hits.distance, packet.ray.tfar, sizeof hits.distance);
  std::memcpy(hits.normal_x, packet.hit.Ng_x, sizeof hits.normal_x);
  std::memcpy(hits.normal_y, packet.hit.Ng_y, sizeof hits.normal_y);
  std::memcpy(hits.normal_z, packet.hit.Ng_z, sizeof hits.normal_z);
  std::memcpy(hits.u, packet.hit.u, sizeof hits.u);
  std::memcpy(hits.v, packet.hit.v, sizeof hits.v);
  std::memcpy(hits.primitive, packet.hit.primID, sizeof hits.primitive);
  std::uint32_t in_instance = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const bool is_hit = packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
    const bool is_instance = is_hit && packet.hit.instID[0][lane] != RTC_INVALID_GEOMETRY_ID;
    hits.part[lane] = is_instance ? packet.hit.instID[0][lane] : packet.hit.geomID[lane];
    in_instance |= static_cast<std::uint32_t>(is_instance) << lane;
  }
  static_assert(kNoHit == RTC_INVALID_GEOMETRY_ID);
  for (; in_instance != 0; in_instance &= in_instance - 1) {
    // Embree gives an instance's normal in the axes of its mesh.
    const int lane = std::countr_zero(in_instance);
    const glm::vec3 normal = state_->scene_normal_from_mesh[hits.part[lane]] *
                             glm::vec3(hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]);
    hits.normal_x[lane] = normal.x;
    hits.normal_y[lane] = normal.y;
    hits.normal_z[lane] = normal.z;
  }
}

std::uint32_t RayScene::occluded_coherent(const RayPacket& rays) const {
  // Embree 3.13.5 asked for any hit of coherent rays does not return among instances.
  alignas(64) RTCRayHit16 packet;
  state_->closest_hits(rays, true, packet);
  std::uint32_t result = 0;
  for (int lane = 0; lane < kPacketSize; ++lane)
    result |= static_cast<std::uint32_t>(packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID) << lane;
  return result;
}

std::uint32_t RayScene::occluded(const RayPacket& rays) const {
  alignas(64) RTCRay16 packet;
  alignas(64) int valid[kPacketSize];
  copy_rays(rays, packet, valid);
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded16(valid, state_->top.get(), &context, &packet);
  std::uint32_t result = 0;
  for (int lane = 0; lane < kPacketSize; ++lane)
    // Embree marks an occluded ray with tfar = -infinity.
    result |=
        static_cast<std::uint32_t>(valid[lane] != 0 && packet.tfar[lane] < 0.0f && rays.far[lane] != packet.tfar[lane])
        << lane;
  return result;
}

}  // namespace farfield
