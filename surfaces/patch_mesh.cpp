// From a cage to a mesh of faces that patches are made of: a few uniform refinements, in double precision.
#include "surfaces/patch_mesh.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <utility>

#include "base/util/error.h"
#include "surfaces/memory_budget.h"

namespace trilens {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

/// The sharpest that is not yet infinite after `kDeepest` refinements.
constexpr float kNearlyInfinite = 9.99f;

using RefinerPtr = std::unique_ptr<Far::TopologyRefiner>;

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
        case SubdivisionScheme::kUnsubdivided:
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
    for (int v = 0; v < level.GetNumVertices() && !linear; ++v) {
        const bool has_faces = level.GetVertexFaces(v).size() > 0;  // else it counts as non-manifold
        if (has_faces && (is_folded(level, v) || level.IsVertexNonManifold(v))) return 2;
    }
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

/// The most that is held at once per corner of the cage while its neighbours are found, and per face of the
/// last level while it is refined: measured, rounded up.
constexpr double kBytesPerCorner = 150, kBytesPerFineFace = 500;
/// What a face's patch takes at most where no vertex has many faces, with a tree that it shares with none;
/// until kMostPatchBytes are full.
constexpr double kBytesPerPatch = 1e5;

/// Faces around a vertex, at most.
int largest_valence(const CheckedCage& cage) {
    std::vector<int> faces(cage.points.size(), 0);
    int largest = 0;
    for (int vertex : cage.vertices) largest = std::max(largest, ++faces[static_cast<std::size_t>(vertex)]);
    return largest;
}

/// Bytes of the patches of one face at a vertex of n faces. They are refined kDeepest times around it, each
/// time with about 2 n more points, each of which OpenSubdiv keeps as a row of weights of the 2 n control
/// points.
double patch_bytes(double n) {
    const double points = 2 * kDeepest * n + 320, controls = 2 * n + 32;
    return points * controls * sizeof(double);
}

/// Faces after the refinement that makes them all quads, if it takes one.
double faces_once_whole(const CheckedCage& cage) {
    const int whole = cage.scheme == SubdivisionScheme::kLoop ? 3 : 4;
    for (int f = 0; f < cage.face_count(); ++f)
        if (cage.face_size(f) != whole) return static_cast<double>(cage.vertices.size());
    return cage.face_count();
}

/// `fine_faces`: of the last level; `topology`: the bytes that they and the cage take.
void check_fits(const CheckedCage& cage, double fine_faces, double topology, const MemoryLimit& limit) {
    const int largest = cage.scheme == SubdivisionScheme::kBilinear ? 0 : largest_valence(cage);
    const double patches = std::min(fine_faces * kBytesPerPatch, double{kMostPatchBytes});
    const double around_vertex = patch_bytes(largest);
    const bool is_fan = around_vertex > topology + patches;
    check_memory({topology + patches + around_vertex,
                  is_fan ? "the limit surface around a vertex of " + std::to_string(largest) + " faces"
                         : "the limit surface of " + std::to_string(cage.face_count()) + " faces",
                  is_fan ? "split that vertex" : "use a cage of fewer faces"},
                 limit);
}

}  // namespace

std::size_t PatchMesh::bytes() const {
    std::size_t sum = points.capacity() * sizeof(Vec3);
    for (const FaceChildren& level : tree.levels)
        sum += (level.first.capacity() + level.child.capacity()) * sizeof(int);

    // Far::TopologyLevel: indices of 4 bytes, places of 2 bytes in the lists of neighbours, sharpness and
    // tags.
    const auto level = static_cast<const Far::TopologyRefiner*>(refiner.get())->GetLevel(0);
    const auto times = [](int count, std::size_t bytes) { return static_cast<std::size_t>(count) * bytes; };
    return sum + times(level.GetNumFaces(), 9) + times(level.GetNumFaceVertices(), 20) +
           times(level.GetNumEdges(), 34) + times(level.GetNumVertices(), 22);
}

PatchMesh make_patch_mesh(const CheckedCage& cage, const std::string& name, double memory) {
    const MemoryLimit limit{memory, name};
    const double corners = static_cast<double>(cage.vertices.size());
    check_fits(cage, faces_once_whole(cage), kBytesPerCorner * corners, limit);

    CheckedCage work = cage;
    RefinerPtr refiner = make_refiner(work, name);
    while (soften_folded_darts(refiner->GetLevel(0), work)) refiner = make_refiner(work, name);

    PatchMesh mesh;
    mesh.tree.triangles = cage.scheme == SubdivisionScheme::kLoop;
    const int levels = levels_before_patches(refiner->GetLevel(0), work);
    if (levels > 0) {
        const double children = mesh.tree.triangles ? 4.0 * cage.face_count() : corners;
        const double fine_faces = children * std::pow(4, levels - 1);
        check_fits(cage, fine_faces, kBytesPerFineFace * fine_faces, limit);
        Far::TopologyRefiner::UniformOptions uniform(levels);
        uniform.fullTopologyInLastLevel = true;
        refiner->RefineUniform(uniform);
        for (int level = 0; level < levels; ++level)
            mesh.tree.levels.push_back(children_of(refiner->GetLevel(level)));
        work = cage_of_level(refiner->GetLevel(levels), refine_points(*refiner, work.points), work);
        refiner.reset();
        refiner = make_refiner(work, name);
    }
    mesh.refiner = std::move(refiner);
    mesh.points = std::move(work.points);
    return mesh;
}

std::vector<Box> face_hulls_of(const PatchMesh& mesh) {
    constexpr double kRoom = 1e-4;  // of the box's size: what approximations of patches and rounding take
    const auto level = static_cast<const Far::TopologyRefiner*>(mesh.refiner.get())->GetLevel(0);
    std::vector<Box> around(mesh.points.size()), hulls(static_cast<std::size_t>(level.GetNumFaces()));
    for (int face = 0; face < level.GetNumFaces(); ++face) {
        Box own;
        for (const int v : level.GetFaceVertices(face)) own.include(mesh.points[static_cast<std::size_t>(v)]);
        for (const int v : level.GetFaceVertices(face)) around[static_cast<std::size_t>(v)].include(own);
    }
    for (int face = 0; face < level.GetNumFaces(); ++face) {
        Box& hull = hulls[static_cast<std::size_t>(face)];
        for (const int v : level.GetFaceVertices(face)) hull.include(around[static_cast<std::size_t>(v)]);
        const Vec3 room(kRoom * length(hull.size()));
        hull = {hull.low - room, hull.high + room};
    }
    return hulls;
}

// Walks down the levels of uniform refinement.

namespace {

/// The child of a quad that holds (u, v), which becomes the child's own.
int enter_child_quad(Vec2& uv) {
    const bool right = uv.x >= 0.5, upper = uv.y >= 0.5;
    uv = 2.0 * uv - Vec2(right ? 1 : 0, upper ? 1 : 0);
    if (upper) return right ? 2 : 3;
    return right ? 1 : 0;
}

int enter_child_triangle(Vec2& uv, double& scale) {
    const double u = uv.x, v = uv.y;
    if (u >= 0.5) {
        uv = Vec2(2 * u - 1, 2 * v);
        return 1;
    }
    if (v >= 0.5) {
        uv = Vec2(2 * u, 2 * v - 1);
        return 2;
    }
    if (u + v <= 0.5) {
        uv = Vec2(2 * u, 2 * v);
        return 0;
    }
    uv = Vec2(1 - 2 * u, 1 - 2 * v);
    scale = -scale;
    return 3;
}

}  // namespace

FaceTree::Leaf FaceTree::leaf(int face, int sub_face, const Vec2& uv) const {
    Leaf leaf{face, uv, 1};
    std::size_t level = 0;
    if (sub_face >= 0) leaf.face = levels[level++](face, sub_face);
    for (; level < levels.size(); ++level) {
        const int child = triangles ? enter_child_triangle(leaf.uv, leaf.scale) : enter_child_quad(leaf.uv);
        leaf.face = levels[level](leaf.face, child);
        leaf.scale *= 2;
    }
    return leaf;
}

}  // namespace trilens
