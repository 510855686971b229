// The projector against Embree's packets over workloads, numbers of triangles and facets, films, threads and
// instruction sets: one line each, and all of them as CSV.
// Use: bench_race_workloads [KEY=VALUE,VALUE...]... with the keys of kKeys below (isa=all: every instruction
// set of this machine; plain=yes: every cell is drawn once more by the plain engine, and its hits compared to
// the last bit); bench/tables.py draws the CSV.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "bench/race/race.h"
#include "intersect/tracer.h"
#include "projector/projector.h"
#include "workloads.h"

namespace {

using namespace trilens;
using namespace trilens_bench;
using Values = std::vector<std::string>;

const std::map<std::string, Values> kKeys{
    {"workload", {"room"}}, {"triangles", {"12", "972", "10092", "99372", "1002252"}},
    {"n", {"16", "64"}},    {"film", {"1920x1080"}},
    {"threads", {"1"}},     {"isa", {""}},
    {"repeats", {"9"}},     {"csv", {""}},
    {"plain", {"no"}}};

Values split(const std::string& text, char at) {
    Values parts;
    std::stringstream in(text);
    for (std::string part; std::getline(in, part, at);) parts.push_back(part);
    if (parts.empty()) parts.push_back("");
    return parts;
}

std::map<std::string, Values> read(int count, char** words) {
    std::map<std::string, Values> chosen = kKeys;
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || !chosen.count(word.substr(0, equals)))
            throw std::invalid_argument("no key in '" + word + "'");
        chosen[word.substr(0, equals)] = split(word.substr(equals + 1), ',');
    }
    return chosen;
}

struct Cell {
    std::string workload, film, isa;
    int n = 0;
    RaceResult result;
};

void print(const Cell& c, std::FILE* csv) {
    const RaceResult& r = c.result;
    std::printf(
        "%-5s %8zu %3d %9s %2d %7s %7zu | %8.2f %8.2f %8.1f %8.1f | %8.2f %8.2f %8.1f %8.1f | %5.2f "
        "%5.2f %5.2f %5.2f | %zu = %zu + %zu + %zu\n",
        c.workload.c_str(), r.triangles, c.n, c.film.c_str(), r.threads, r.projector_isa.c_str(), r.pixels,
        r.visible_ms, r.written_ms, r.samples_ms, r.prepare_ms, r.trace_ms, r.trace_written_ms, r.rays_ms,
        r.build_ms, r.ratio.visible, r.ratio.written, r.ratio.with_build, r.ratio.whole, r.mismatches.pixels,
        r.mismatches.edge, r.mismatches.depth, r.mismatches.unexplained);
    std::fflush(stdout);
    if (!csv) return;
    std::fprintf(
        csv,
        "%s,%zu,%d,%s,%d,%s,%zu,%zu,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,"
        "%zu,%zu,%zu,%zu,%.6f,%.6f,%.6f,%.4f\n",
        c.workload.c_str(), r.triangles, c.n, c.film.c_str(), r.threads, r.projector_isa.c_str(), r.pixels,
        r.facets, r.visible_ms, r.written_ms, r.samples_ms, r.prepare_ms, r.trace_ms, r.trace_written_ms,
        r.rays_ms, r.build_ms, r.ratio.visible, r.ratio.written, r.ratio.with_build, r.ratio.whole,
        r.slowest_ratio, r.fastest_ratio, r.mismatches.pixels, r.mismatches.edge, r.mismatches.depth,
        r.mismatches.unexplained, r.shared, r.ambiguous, r.unbounded, r.depth_complexity);
    std::fflush(csv);
}

/// Samples whose hits differ, in any bit, from those of the plain engine; `isa`: of the vector engine.
std::size_t unlike_plain(const TriangleScene& scene, const MirrorSphere& mirror, const FacetSamples& owned,
                         const std::string& isa) {
    const PreparedScene prepared(scene);
    std::vector<Hit> hits(mirror.grid.size()), plain(mirror.grid.size());
    if (!use_instruction_set(isa)) throw std::invalid_argument("no instruction set '" + isa + "'");
    draw(prepared, mirror.mesh, owned, mirror.grid, hits, DrawOptions{});
    use_instruction_set("");
    draw(prepared, mirror.mesh, owned, mirror.grid, plain, {.vectors = false});
    std::size_t unlike = 0;
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const Hit &a = hits[i], &b = plain[i];
        unlike += a.triangle != b.triangle || bits(a.t) != bits(b.t) ||
                  bits(a.barycentric.x) != bits(b.barycentric.x) ||
                  bits(a.barycentric.y) != bits(b.barycentric.y);
    }
    std::printf("%zu of %zu hits unlike the plain engine's\n", unlike, owned.sample.size());
    return unlike;
}

int run(const std::map<std::string, Values>& chosen) {
    const Values sets = chosen.at("isa").front() == "all" ? kernel_instruction_sets() : chosen.at("isa");
    const std::string file = chosen.at("csv").front();
    std::FILE* csv = file.empty() ? nullptr : std::fopen(file.c_str(), "w");
    if (!file.empty() && !csv) throw std::runtime_error("cannot write " + file);
    if (csv)
        std::fprintf(csv,
                     "workload,triangles,n,film,threads,isa,pixels,facets,visible_ms,written_ms,samples_ms,"
                     "prepare_ms,trace_ms,"
                     "trace_written_ms,rays_ms,build_ms,ratio_visible,ratio_written,ratio_with_build,ratio_"
                     "whole,lowest,highest,"
                     "mismatches,edge,depth,unexplained,shared,ambiguous,unbounded,depth_complexity\n");
    std::printf(
        "milliseconds, medians; projector: visible in order, hits by sample, samples, "
        "tree | Embree: hits in order, by sample, rays, tree | "
        "Embree / projector: visible, written, with build, whole | mismatches = at an edge + at one "
        "depth + "
        "others\n");
    std::size_t unexplained = 0, unlike = 0;
    const bool asks_plain = chosen.at("plain").front() == "yes";
    for (const std::string& threads : chosen.at("threads")) {
        set_thread_count(std::atoi(threads.c_str()));
        set_tracer_threads(std::atoi(threads.c_str()));
        for (const std::string& name : chosen.at("workload")) {
            for (const std::string& triangles : chosen.at("triangles")) {
                const TriangleScene scene = workload(name, std::atof(triangles.c_str()));
                for (const std::string& film : chosen.at("film")) {
                    const Values size = split(film, 'x');
                    for (const std::string& n : chosen.at("n")) {
                        const MirrorSphere mirror = mirror_sphere(
                            std::atoi(n.c_str()), std::atoi(size[0].c_str()), std::atoi(size.back().c_str()));
                        const FacetSamples owned = rasterize_facets(mirror.mesh, mirror.grid);
                        for (const std::string& isa : sets) {
                            const RaceParams params{std::atoi(chosen.at("repeats").front().c_str()), isa};
                            const Cell cell{name, film, isa, std::atoi(n.c_str()),
                                            race({scene, {{&mirror.mesh, &owned}}, mirror.grid}, params)};
                            print(cell, csv);
                            unexplained += cell.result.mismatches.unexplained;
                            if (asks_plain) unlike += unlike_plain(scene, mirror, owned, isa);
                        }
                    }
                }
            }
        }
    }
    if (csv) std::fclose(csv);
    if (unexplained > 0) std::printf("%zu mismatches that no edge or depth explains\n", unexplained);
    if (unlike > 0) std::printf("%zu hits unlike the plain engine's\n", unlike);
    return unexplained == 0 && unlike == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** words) {
    try {
        return run(read(count, words));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_race_workloads: %s\n", error.what());
        return 2;
    }
}
