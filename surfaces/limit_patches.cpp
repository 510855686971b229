// THE door to OpenSubdiv: cages to Bfr patches, one per quad or triangle, in double precision.
#include "surfaces/limit_patches.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <opensubdiv/version.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "surfaces/face_tree.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using RefinerPtr = std::unique_ptr<Far::TopologyRefiner>;

/// Uniform refinements before the patches plus adaptive ones inside them: the most that OpenSubdiv's patch
/// parameters can hold (ten bits).
constexpr int kDeepest = 10;
/// The sharpest that is not yet infinite after `kDeepest` refinements.
constexpr float kNearlyInfinite = 9.99f;

// --- Far: topology
// -------------------------------------------------------------------------------------------

thread_local std::string last_complaint;

/// OpenSubdiv prints to stdout unless told otherwise; here its words go into the exception, if there is one.
void redirect_complaints() {
    static std::once_flag once;
    std::call_once(once, [] {
        Far::SetErrorCallback([](Far::ErrorType, const char* message) { last_complaint = message; });
        Far::SetWarningCallback([](const char*) {});
    });
}

Sdc::SchemeType scheme_of(const CheckedCage& cage) {
    switch (cage.scheme) {
        case SubdivisionScheme::kLoop:
            return Sdc::SCHEME_LOOP;
        case SubdivisionScheme::kBilinear:
            return Sdc::SCHEME_BILINEAR;
        case SubdivisionScheme::kCatmullClark:
            break;
    }
    return Sdc::SCHEME_CATMARK;
}

Sdc::Options options_of(const CheckedCage& cage) {
    Sdc::Options options;
    switch (cage.interpolate_boundary) {
        case InterpolateBoundary::kNothing:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_NONE);
            break;
        case InterpolateBoundary::kEdgeOnly:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
            break;
        case InterpolateBoundary::kEdgeAndCorner:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
            break;
    }
    return options;
}

RefinerPtr make_refiner(const CheckedCage& cage, const std::string& name) {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::vector<int> counts;
    for (int f = 0; f < cage.face_count(); ++f) counts.push_back(cage.face_size(f));

    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(cage.points.size());
    descriptor.numFaces = cage.face_count();
    descriptor.numVertsPerFace = counts.data();
    descriptor.vertIndicesPerFace = cage.vertices.data();
    descriptor.numCreases = static_cast<int>(cage.crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = cage.crease_vertices.data();
    descriptor.creaseWeights = cage.crease_sharpness.data();
    descriptor.numCorners = static_cast<int>(cage.corner_sharpness.size());
    descriptor.cornerVertexIndices = cage.corner_vertices.data();
    descriptor.cornerWeights = cage.corner_sharpness.data();
    descriptor.numHoles = static_cast<int>(cage.holes.size());
    descriptor.holeIndices = cage.holes.data();

    redirect_complaints();
    last_complaint.clear();
    RefinerPtr refiner(Factory::Create(descriptor, Factory::Options(scheme_of(cage), options_of(cage))));
    if (!refiner) throw InputError(name, "", "no subdivision surface: " + last_complaint);
    return refiner;
}

/// An interior vertex of two faces: they share two edges, so neighbourhoods fold onto themselves.
bool is_folded(const Far::TopologyLevel& level, int vertex) {
    return level.GetVertexFaces(vertex).size() == 2 && level.GetVertexEdges(vertex).size() == 2;
}

/// OpenSubdiv up to 3.6.0 crashes at an interior vertex of two faces where a single infinitely sharp edge
/// ends. Such edges are made nearly infinite here. Returns whether there were any.
bool soften_folded_darts(const Far::TopologyLevel& level, CheckedCage& cage) {
    const auto ends_as_dart = [&level](int vertex) {
        if (!is_folded(level, vertex)) return false;
        int sharp = 0;
        for (int edge : level.GetVertexEdges(vertex))
            sharp += level.GetEdgeSharpness(edge) >= kInfiniteSharpness;
        return sharp == 1;
    };
    bool any = false;
    for (std::size_t i = 0; i < cage.crease_sharpness.size(); ++i) {
        if (cage.crease_sharpness[i] < kInfiniteSharpness) continue;
        if (!ends_as_dart(cage.crease_vertices[2 * i]) && !ends_as_dart(cage.crease_vertices[2 * i + 1]))
            continue;
        cage.crease_sharpness[i] = kNearlyInfinite;
        any = true;
    }
    return any;
}

/// How often the cage is refined uniformly first. Once makes all faces quads. Twice takes folded and
/// non-manifold neighbourhoods apart, which Bfr 3.5 gets wrong where several meet in one face.
int levels_before_patches(const Far::TopologyLevel& level, const CheckedCage& cage) {
    const bool linear = cage.scheme == SubdivisionScheme::kBilinear;
    for (int v = 0; v < level.GetNumVertices() && !linear; ++v)
        if (is_folded(level, v) || level.IsVertexNonManifold(v)) return 2;
    for (int e = 0; e < level.GetNumEdges() && !linear; ++e)
        if (level.IsEdgeNonManifold(e)) return 2;
    if (cage.scheme == SubdivisionScheme::kLoop) return 0;
    for (int f = 0; f < cage.face_count(); ++f)
        if (cage.face_size(f) != 4) return 1;
    return 0;
}

struct RefinedPoint {
    Vec3 p{0};
    void Clear(void* = nullptr) { p = Vec3(0); }
    void AddWithWeight(const RefinedPoint& other, double weight) { p += weight * other.p; }
};

std::vector<Vec3> refine_points(const Far::TopologyRefiner& refiner, const std::vector<Vec3>& points) {
    std::vector<RefinedPoint> coarse(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) coarse[i].p = points[i];
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<RefinedPoint> fine(static_cast<std::size_t>(refiner.GetLevel(level).GetNumVertices()));
        Far::PrimvarRefinerReal<double>(refiner).Interpolate(level, coarse, fine);
        coarse = std::move(fine);
    }
    std::vector<Vec3> result;
    for (const RefinedPoint& point : coarse) result.push_back(point.p);
    return result;
}

/// A level of uniform refinement as a cage of its own, with what is left of the sharpness of each edge and
/// vertex.
CheckedCage cage_of_level(const Far::TopologyLevel& level, std::vector<Vec3> points,
                          const CheckedCage& base) {
    CheckedCage cage;
    cage.points = std::move(points);
    cage.scheme = base.scheme;
    cage.interpolate_boundary = base.interpolate_boundary;
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        for (int vertex : level.GetFaceVertices(f)) cage.vertices.push_back(vertex);
        cage.first.push_back(static_cast<int>(cage.vertices.size()));
        if (level.IsFaceHole(f)) cage.holes.push_back(f);
    }
    for (int e = 0; e < level.GetNumEdges(); ++e) {
        // A boundary is sharp by the boundary rule, which the new cage has too.
        if (level.GetEdgeSharpness(e) <= 0 || level.IsEdgeBoundary(e)) continue;
        for (int vertex : level.GetEdgeVertices(e)) cage.crease_vertices.push_back(vertex);
        cage.crease_sharpness.push_back(level.GetEdgeSharpness(e));
    }
    for (int v = 0; v < level.GetNumVertices(); ++v) {
        if (level.GetVertexSharpness(v) <= 0) continue;
        cage.corner_vertices.push_back(v);
        cage.corner_sharpness.push_back(level.GetVertexSharpness(v));
    }
    return cage;
}

FaceChildren children_of(const Far::TopologyLevel& level) {
    FaceChildren children;
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        children.first.push_back(static_cast<int>(children.child.size()));
        for (int child : level.GetFaceChildFaces(f)) children.child.push_back(child);
    }
    children.first.push_back(static_cast<int>(children.child.size()));
    return children;
}

// --- Bfr: patches
// --------------------------------------------------------------------------------------------

/// One face's limit surface with its patch points, relative to `origin` so that small faces far away stay
/// exact.
struct Patch {
    Bfr::Surface<double> surface;
    std::vector<double> points;
    Vec3 origin{0};
    double extent = 0;
};

using SharedCache = Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                                     std::unique_lock<std::shared_mutex>>;

Patch make_patch(const Bfr::SurfaceFactory& factory, int face, const std::vector<Vec3>& points) {
    Patch patch;
    if (!factory.InitVertexSurface(face, &patch.surface)) return patch;

    std::vector<int> control(static_cast<std::size_t>(patch.surface.GetNumControlPoints()));
    patch.surface.GetControlPointIndices(control.data());
    patch.origin = points[control[0]];
    patch.points.resize(3 * static_cast<std::size_t>(patch.surface.GetNumPatchPoints()));
    for (std::size_t i = 0; i < control.size(); ++i) {
        const Vec3 offset = points[control[i]] - patch.origin;
        for (int axis = 0; axis < 3; ++axis) {
            patch.points[3 * i + axis] = offset[axis];
            patch.extent = std::max(patch.extent, std::abs(offset[axis]));
        }
    }
    patch.surface.ComputePatchPoints(patch.points.data(), 3);
    return patch;
}

std::vector<Patch> make_patches(const Far::TopologyRefiner& refiner, const std::vector<Vec3>& points,
                                int depth) {
    Bfr::SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(depth).SetApproxLevelSharp(depth);
    const Bfr::RefinerSurfaceFactory<SharedCache> factory(refiner, options);
    std::vector<Patch> patches(static_cast<std::size_t>(factory.GetNumFaces()));
    parallel_for(patches.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f)
            patches[f] = make_patch(factory, static_cast<int>(f), points);
    });
    return patches;
}

}  // namespace

struct LimitPatches::Impl {
    FaceTree tree;               // the uniform refinements before the patches
    std::vector<Patch> patches;  // per face of the last level

    bool has_limit(int face, std::size_t level) const {
        if (level == tree.levels.size()) return patches[face].surface.IsValid();
        const FaceChildren& children = tree.levels[level];
        for (int k = 0; k < children.count(face); ++k)
            if (!has_limit(children(face, k), level + 1)) return false;
        return true;
    }
};

LimitPatches::LimitPatches(const CheckedCage& cage, const std::string& name) {
    auto impl = std::make_unique<Impl>();
    if (cage.face_count() == 0) {  // OpenSubdiv refuses these
        impl_ = std::move(impl);
        return;
    }
    impl->tree.triangles = cage.scheme == SubdivisionScheme::kLoop;

    CheckedCage work = cage;
    RefinerPtr refiner = make_refiner(work, name);
    while (soften_folded_darts(refiner->GetLevel(0), work)) refiner = make_refiner(work, name);

    const int levels = levels_before_patches(refiner->GetLevel(0), work);
    if (levels > 0) {
        Far::TopologyRefiner::UniformOptions uniform(levels);
        uniform.fullTopologyInLastLevel = true;
        refiner->RefineUniform(uniform);
        for (int level = 0; level < levels; ++level)
            impl->tree.levels.push_back(children_of(refiner->GetLevel(level)));
        work = cage_of_level(refiner->GetLevel(levels), refine_points(*refiner, work.points), work);
        refiner = make_refiner(work, name);
    }
    impl->patches = make_patches(*refiner, work.points, kDeepest - levels);
    impl_ = std::move(impl);
}

LimitPatches::~LimitPatches() = default;

bool LimitPatches::has_limit(int face) const {
    return impl_->has_limit(face, 0);
}

LimitPatches::Point LimitPatches::eval(int face, int sub_face, const Vec2& uv) const {
    const FaceTree::Leaf leaf = impl_->tree.leaf(face, sub_face, uv);
    const Patch& patch = impl_->patches[leaf.face];
    Point result;
    result.extent = patch.extent;
    SurfacePoint& point = result.point;
    patch.surface.Evaluate(&leaf.uv.x, patch.points.data(), 3, &point.position.x, &point.du.x, &point.dv.x,
                           &point.duu.x, &point.duv.x, &point.dvv.x);
    point.position += patch.origin;
    for (Vec3* first : {&point.du, &point.dv}) *first *= leaf.scale;
    for (Vec3* second : {&point.duu, &point.duv, &point.dvv}) *second *= leaf.scale * leaf.scale;
    return result;
}

std::string surface_library_version() {
    return "OpenSubdiv " + std::to_string(OPENSUBDIV_VERSION_MAJOR) + "." +
           std::to_string(OPENSUBDIV_VERSION_MINOR) + "." + std::to_string(OPENSUBDIV_VERSION_PATCH);
}

}  // namespace trilens
