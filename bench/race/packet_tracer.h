// The opponent of the projector: Embree as a fast renderer uses it, float triangles and coherent packets of
// 16 rays.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens_bench {

using namespace trilens;

/// Sixteen rays that travel together, component by component as Embree wants them.
struct alignas(64) RayPacket {
    static constexpr int kRays = 16;
    float origin[3][kRays];
    float direction[3][kRays];
    Id sample[kRays];  // kNone: no ray here
};

/// The interpolated rays of every owned sample of a facet with rays, rounded to float; sorted so that the
/// samples of a packet stand close together on the film (blocks of 4 x 4), packets full but for the last.
std::vector<RayPacket> make_ray_packets(const RayMesh& mesh, const FacetSamples& owned,
                                        const SampleGrid& grid);

/// What a float ray sees.
struct FloatHit {
    Id triangle = kNone;  // index into TriangleScene::triangles
    float t = 0;
    float u = 0, v = 0;  // weights of the triangle's second and third corner
};

/// The hits of a packet, ray by ray.
struct alignas(64) PacketHits {
    Id triangle[RayPacket::kRays];  // kNone: nothing is seen, or there is no ray
    float t[RayPacket::kRays], u[RayPacket::kRays], v[RayPacket::kRays];
};

/// For `bench`, where speed is measured; the truth is Tracer's. Near edges and for thin triangles its hits
/// may differ from the truth by what float rounds. Thread-safe to read.
class PacketTracer {
  public:
    struct Options {
        std::string isa;  // as Tracer's
        bool best_tree =
            false;  // spend about three times the build time on a tree that traces somewhat faster
    };
    explicit PacketTracer(const TriangleScene& scene, const Options& options);
    explicit PacketTracer(const TriangleScene& scene) : PacketTracer(scene, Options()) {}
    ~PacketTracer();
    PacketTracer(PacketTracer&&) noexcept;
    PacketTracer& operator=(PacketTracer&&) noexcept;

    /// The first hit (t >= 0) of every ray, written to hits[sample]; other entries are left alone. Runs in
    /// parallel over packets (set_thread_count).
    void trace(std::span<const RayPacket> packets, std::span<FloatHit> hits) const;

    /// The same, left in the packets' order, one entry per packet: Embree's fastest use.
    void trace_in_order(std::span<const RayPacket> packets, std::span<PacketHits> hits) const;

    /// How many of a packet's rays go to Embree at once: 16, or 8 where the instruction set has no more.
    int rays_at_once() const;
    /// What Embree was asked for, in its own words.
    std::string configuration() const;

  private:
    struct Data;
    static void attach_triangles(const TriangleScene& scene, bool best_tree, Data* data);
    std::unique_ptr<Data> data_;
};

}  // namespace trilens_bench
