// The second door to Embree: its own triangles, its own intersection, nothing of ours between.
#include "bench/race/packet_tracer.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "base/util/parallel.h"
#include "intersect/embree_device.h"

namespace trilens_bench {

using namespace trilens;
namespace {

constexpr std::size_t kPacketsPerTask = 64;

/// A sample, who owns it, and where it stands in the order of blocks.
struct PlacedSample {
    std::uint64_t place = 0;
    Id sample = kNone, facet = kNone;
};

// Blocks of 4 x 4 pixels in rows of blocks; inside a block pixel by pixel.
std::uint64_t place_of(const SampleGrid& grid, Id sample) {
    const std::size_t per_pixel = static_cast<std::size_t>(grid.samples_per_pixel());
    const std::size_t pixel = sample / per_pixel, columns = static_cast<std::size_t>(grid.width());
    const std::size_t x = pixel % columns, y = pixel / columns, blocks = (columns + 3) / 4;
    const std::size_t in_block = y % 4 * 4 + x % 4;
    return ((y / 4 * blocks + x / 4) * 16 + in_block) * per_pixel + sample % per_pixel;
}

std::vector<PlacedSample> place_samples(const RayMesh& mesh, const FacetSamples& owned,
                                        const SampleGrid& grid) {
    std::vector<PlacedSample> placed;
    placed.reserve(owned.sample.size());
    for (std::size_t facet = 0; facet < mesh.facets.size(); ++facet) {
        if (!mesh.has_rays(facet)) continue;
        for (const Id sample : owned.of(facet)) {
            placed.push_back({place_of(grid, sample), sample, static_cast<Id>(facet)});
        }
    }
    std::sort(placed.begin(), placed.end(),
              [](const PlacedSample& a, const PlacedSample& b) { return a.place < b.place; });
    return placed;
}

/// Traces rays [first, first + kWidth) of a packet.
template <typename Rays, int kWidth>
void trace_part(RTCScene scene, const RayPacket& packet, int first, PacketHits& hits) {
    constexpr std::size_t kBytes = kWidth * sizeof(float);
    Rays rays;
    std::memcpy(rays.ray.org_x, packet.origin[0] + first, kBytes);
    std::memcpy(rays.ray.org_y, packet.origin[1] + first, kBytes);
    std::memcpy(rays.ray.org_z, packet.origin[2] + first, kBytes);
    std::memcpy(rays.ray.dir_x, packet.direction[0] + first, kBytes);
    std::memcpy(rays.ray.dir_y, packet.direction[1] + first, kBytes);
    std::memcpy(rays.ray.dir_z, packet.direction[2] + first, kBytes);
    alignas(64) int valid[kWidth];
    for (int i = 0; i < kWidth; ++i) {
        rays.ray.tnear[i] = 0;
        rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
        rays.ray.time[i] = 0;
        rays.ray.mask[i] = ~0u;
        rays.ray.flags[i] = 0;
        rays.hit.geomID[i] = rays.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
        valid[i] = packet.sample[first + i] == kNone ? 0 : -1;
    }
    intersect_coherent(valid, scene, &rays);
    static_assert(RTC_INVALID_GEOMETRY_ID == kNone);
    std::memcpy(hits.triangle + first, rays.hit.primID, kBytes);
    std::memcpy(hits.t + first, rays.ray.tfar, kBytes);
    std::memcpy(hits.u + first, rays.hit.u, kBytes);
    std::memcpy(hits.v + first, rays.hit.v, kBytes);
}

void trace_packet(RTCScene scene, int width, const RayPacket& packet, PacketHits& hits) {
    if (width == 16) return trace_part<RTCRayHit16, 16>(scene, packet, 0, hits);
    trace_part<RTCRayHit8, 8>(scene, packet, 0, hits);
    trace_part<RTCRayHit8, 8>(scene, packet, 8, hits);
}

}  // namespace

std::vector<RayPacket> make_ray_packets(const RayMesh& mesh, const FacetSamples& owned,
                                        const SampleGrid& grid) {
    const std::vector<PlacedSample> placed = place_samples(mesh, owned, grid);
    std::vector<FacetWeights> weights(mesh.facets.size());
    for (std::size_t f = 0; f < weights.size(); ++f) {
        if (mesh.has_rays(f)) weights[f] = facet_weights(mesh, f);
    }

    std::vector<RayPacket> packets((placed.size() + RayPacket::kRays - 1) / RayPacket::kRays);
    for (std::size_t i = 0; i < packets.size() * RayPacket::kRays; ++i) {
        RayPacket& packet = packets[i / RayPacket::kRays];
        const std::size_t lane = i % RayPacket::kRays;
        packet.sample[lane] = kNone;
        if (i >= placed.size()) continue;
        const Id facet = placed[i].facet;
        const Ray ray = sample_ray(mesh, facet, weights[facet], grid.position(placed[i].sample));
        packet.sample[lane] = placed[i].sample;
        for (int k = 0; k < 3; ++k) {
            packet.origin[k][lane] = static_cast<float>(ray.origin[k]);
            packet.direction[k][lane] = static_cast<float>(ray.direction[k]);
        }
    }
    return packets;
}

struct PacketTracer::Data : EmbreeTree {
    using EmbreeTree::EmbreeTree;
    int width = 16;
    std::string configuration;
};

void PacketTracer::attach_triangles(const TriangleScene& scene, bool best_tree, Data* data) {
    RTCGeometry geometry = rtcNewGeometry(data->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    if (best_tree) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scene.points.size()));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), scene.size()));
    data->device.check("making room for triangles");
    for (const Vec3& p : scene.points) {
        for (int k = 0; k < 3; ++k) *points++ = static_cast<float>(p[k]);
    }
    for (const IdTriple& triangle : scene.triangles) {
        corners = std::copy(triangle.begin(), triangle.end(), corners);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(data->scene, geometry);
    rtcReleaseGeometry(geometry);
}

PacketTracer::PacketTracer(const TriangleScene& scene, const Options& options)
    : data_(std::make_unique<Data>(options.isa)) {
    RTCDevice device = data_->device.get();
    data_->scene = rtcNewScene(device);
    data_->width = std::max(native_packet_width(data_->device), 8);
    data_->configuration = embree_configuration(options.isa);
    rtcSetSceneBuildQuality(data_->scene,
                            options.best_tree ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    if (scene.size() > 0) attach_triangles(scene, options.best_tree, data_.get());
    rtcCommitScene(data_->scene);
    data_->device.check("building the tree");
}

PacketTracer::~PacketTracer() = default;
PacketTracer::PacketTracer(PacketTracer&&) noexcept = default;
PacketTracer& PacketTracer::operator=(PacketTracer&&) noexcept = default;

void PacketTracer::trace(std::span<const RayPacket> packets, std::span<FloatHit> hits) const {
    parallel_for(packets.size(), kPacketsPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            PacketHits seen;
            trace_packet(data_->scene, data_->width, packets[p], seen);
            for (int i = 0; i < RayPacket::kRays; ++i) {
                const Id sample = packets[p].sample[i];
                if (sample == kNone) continue;
                hits[sample] = seen.triangle[i] == kNone
                                   ? FloatHit{}
                                   : FloatHit{seen.triangle[i], seen.t[i], seen.u[i], seen.v[i]};
            }
        }
    });
}

void PacketTracer::trace_in_order(std::span<const RayPacket> packets, std::span<PacketHits> hits) const {
    parallel_for(packets.size(), kPacketsPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p)
            trace_packet(data_->scene, data_->width, packets[p], hits[p]);
    });
}

int PacketTracer::rays_at_once() const {
    return data_->width;
}

std::string PacketTracer::configuration() const {
    return data_->configuration;
}

}  // namespace trilens_bench
