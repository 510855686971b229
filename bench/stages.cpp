// The stages of a picture by themselves, each over the sizes that it depends on, as Google Benchmark times
// them. Use: bench_stages --benchmark_filter=draw
#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "base/raymesh/rasterize.h"
#include "camera/linear/linear_cameras.h"
#include "image/exr_file.h"
#include "intersect/tracer.h"
#include "projector/projector.h"
#include "projector/scene/bvh.h"
#include "projector/tiles/sample_tiles.h"
#include "specular/specular_search.h"
#include "surfaces/surfaces.h"
#include "workloads.h"

namespace {

using namespace trilens;
using benchmark::State;

constexpr int kWidth = 1920, kHeight = 1080;

trilens_bench::MirrorSphere mirror(const State& state) {
    return trilens_bench::mirror_sphere(static_cast<int>(state.range(0)), kWidth, kHeight);
}

void count(State& state, std::size_t items) {
    state.SetItemsProcessed(static_cast<std::int64_t>(items) * state.iterations());
}

/// Which facet each sample of the film belongs to.
void rasterize(State& state) {
    const auto sphere = mirror(state);
    for (auto step : state) benchmark::DoNotOptimize(rasterize_facets(sphere.mesh, sphere.grid));
    count(state, sphere.grid.size());
}
BENCHMARK(rasterize)->Arg(4)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);

/// Samples of facets into vectors.
void make_vectors(State& state) {
    const auto sphere = mirror(state);
    const FacetSamples owned = rasterize_facets(sphere.mesh, sphere.grid);
    for (auto step : state) benchmark::DoNotOptimize(make_sample_tiles(sphere.mesh, owned, sphere.grid, {}));
    count(state, owned.sample.size());
}
BENCHMARK(make_vectors)->Arg(4)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);

/// The scene through all facets: n, triangles.
void draw_facets(State& state) {
    const auto sphere = mirror(state);
    const FacetSamples owned = rasterize_facets(sphere.mesh, sphere.grid);
    const PreparedScene scene(trilens_bench::workload("room", static_cast<double>(state.range(1))));
    std::vector<Hit> hits(sphere.grid.size());
    for (auto step : state) draw(scene, sphere.mesh, owned, sphere.grid, hits);
    count(state, owned.sample.size());
}
BENCHMARK(draw_facets)->ArgsProduct({{16, 64}, {12, 972, 10092, 99372}})->Unit(benchmark::kMillisecond);

/// The same rays one by one through Embree's tree, with hits in double.
void trace_same_rays(State& state) {
    const auto sphere = mirror(state);
    const FacetSamples owned = rasterize_facets(sphere.mesh, sphere.grid);
    const Tracer tracer(trilens_bench::workload("room", static_cast<double>(state.range(1))));
    std::vector<Hit> hits(sphere.grid.size());
    for (auto step : state) trace_facets(tracer, sphere.mesh, owned, sphere.grid, hits);
    count(state, owned.sample.size());
}
BENCHMARK(trace_same_rays)->ArgsProduct({{16}, {12, 10092}})->Unit(benchmark::kMillisecond);

/// The projector's tree over triangles.
void prepare_scene(State& state) {
    const TriangleScene scene = trilens_bench::workload("room", static_cast<double>(state.range(0)));
    for (auto step : state) benchmark::DoNotOptimize(PreparedScene(scene));
    count(state, scene.size());
}
BENCHMARK(prepare_scene)->Arg(972)->Arg(99372)->Arg(1002252)->Unit(benchmark::kMillisecond);

/// Embree's tree over the same triangles.
void prepare_rays(State& state) {
    const auto scene = std::make_shared<const TriangleScene>(
        trilens_bench::workload("room", static_cast<double>(state.range(0))));
    for (auto step : state) benchmark::DoNotOptimize(Tracer{scene});
    count(state, scene->size());
}
BENCHMARK(prepare_rays)->Arg(972)->Arg(99372)->Arg(1002252)->Unit(benchmark::kMillisecond);

/// All images of points in a sphere, proven.
void search_images(State& state) {
    const std::unique_ptr<Surface> sphere = make_primitive_surface({});
    const SpecularSearcher searcher(*sphere);
    PerspectiveParams params;
    params.look_at = {Vec3(0.3, 0.6, 4.4), Vec3(0), Vec3(0, 1, 0)};
    SpecularQuery query;
    query.camera = make_perspective(params);
    query.viewed = ViewedSide::kFront;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> place(1.5, 3);
    for (auto step : state) {
        query.point = {place(random), place(random), place(random)};
        benchmark::DoNotOptimize(searcher.find(query));
    }
    count(state, 1);
}
BENCHMARK(search_images)->Unit(benchmark::kMicrosecond);

/// A block of scan lines of five channels, as smooth as pictures are.
std::vector<std::vector<float>> picture_rows() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> noise(0, 1e-3f);
    std::vector<std::vector<float>> channels(5);
    for (std::vector<float>& channel : channels)
        for (int i = 0; i < kZipRows * kWidth; ++i)
            channel.push_back(static_cast<float>(i % kWidth) / kWidth + noise(random));
    return channels;
}

template <typename Byte, typename Rows>
std::vector<Byte*> bytes_of(Rows& rows) {
    std::vector<Byte*> bytes;
    for (auto& row : rows) bytes.push_back(reinterpret_cast<Byte*>(row.data()));
    return bytes;
}

void zip_rows(State& state) {
    const auto rows = picture_rows();
    const auto bytes = bytes_of<const unsigned char>(rows);
    BlockScratch scratch;
    for (auto step : state) benchmark::DoNotOptimize(zip_block(bytes, kZipRows, kWidth, scratch));
    state.SetBytesProcessed(state.iterations() * 5 * 4 * kZipRows * kWidth);
}
BENCHMARK(zip_rows)->Unit(benchmark::kMicrosecond);

void unzip_rows(State& state) {
    auto rows = picture_rows();
    BlockScratch scratch;
    std::vector<unsigned char> packed =
        zip_block(bytes_of<const unsigned char>(rows), kZipRows, kWidth, scratch);
    const auto bytes = bytes_of<unsigned char>(rows);
    for (auto step : state) benchmark::DoNotOptimize(unzip_block(packed, bytes, kZipRows, kWidth));
    state.SetBytesProcessed(state.iterations() * 5 * 4 * kZipRows * kWidth);
}
BENCHMARK(unzip_rows)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
