// THE door to OpenSubdiv: cages to Bfr patches, made when they are asked for, in double precision.
#include "surfaces/limit_patches.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/version.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <compare>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "surfaces/memory_budget.h"
#include "surfaces/patch_mesh.h"
#include "surfaces/polynomial/few_points.h"
#include "surfaces/polynomial/sub_patches.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;

// --- Trees: what patches of equal topology share ---

/// Bytes of a face's tree of patches: above all a row of weights of the control points for each patch point.
std::size_t tree_bytes(const Bfr::Surface<double>& surface) {
    return static_cast<std::size_t>(surface.GetNumPatchPoints()) *
           static_cast<std::size_t>(surface.GetNumControlPoints()) * sizeof(double);
}

/// Faces whose neighbourhoods have the same topology share one tree, whatever surface they are of. The first
/// trees stay for good; once they fill the budget, later ones belong to the one face that they are made for.
class SharedTrees final : public Bfr::SurfaceFactoryCache {
  public:
    /// Makes the surface of a face. Returns the bytes that it alone holds in its tree; none where the face
    /// has no limit surface.
    std::optional<std::size_t> init(const Bfr::SurfaceFactory& factory, int face,
                                    Bfr::Surface<double>& surface) {
        tree_ = Tree::kShared;
        key_.reset();
        if (!factory.InitVertexSurface(face, &surface)) return std::nullopt;
        if (tree_ == Tree::kAdded) bytes_ += tree_bytes(surface);
        return tree_ == Tree::kOwn ? tree_bytes(surface) : 0;
    }
    std::size_t bytes() const { return bytes_; }
    /// Of the surface that this thread made last: what tells its tree from others; none where it has none.
    static std::optional<std::uint64_t> key() { return key_; }

  protected:
    DataType Find(const KeyType& key) const override {
        key_ = key;
        const std::shared_lock lock(mutex_);
        return find(key);
    }
    DataType Add(const KeyType& key, const DataType& made) override {
        const std::unique_lock lock(mutex_);
        if (DataType other = find(key)) return other;
        tree_ = bytes_ < kBudget ? Tree::kAdded : Tree::kOwn;
        return tree_ == Tree::kAdded ? add(key, made) : made;
    }

  private:
    static constexpr std::size_t kBudget = kMostPatchBytes / 9 * 2;

    /// Where the tree went that this thread made last.
    enum class Tree { kShared, kAdded, kOwn };
    static thread_local Tree tree_;
    static thread_local std::optional<std::uint64_t> key_;

    mutable std::shared_mutex mutex_;
    std::atomic<std::size_t> bytes_{0};
};

thread_local SharedTrees::Tree SharedTrees::tree_ = SharedTrees::Tree::kShared;
thread_local std::optional<std::uint64_t> SharedTrees::key_;

/// What trees of equal keys are equal in: how cages are refined, and how deep.
struct TreeRules {
    SubdivisionScheme scheme;
    InterpolateBoundary boundary;
    int depth;

    auto operator<=>(const TreeRules&) const = default;
};

/// One for all surfaces that are there at a time: one that is made of a moved cage has its trees at once.
std::shared_ptr<SharedTrees> trees_by(const TreeRules& rules) {
    static std::mutex mutex;
    static std::map<TreeRules, std::weak_ptr<SharedTrees>> by_rules;
    const std::lock_guard lock(mutex);
    std::weak_ptr<SharedTrees>& known = by_rules[rules];
    std::shared_ptr<SharedTrees> trees = known.lock();
    if (!trees) known = trees = std::make_shared<SharedTrees>();
    return trees;
}

// --- Patches ---

using PointDescriptor = Bfr::Surface<double>::PointDescriptor;

/// Of the kind that `surface`, which is irregular, belongs to.
std::unique_ptr<const KindPoints> make_kind_points(const Bfr::Surface<double>& surface, FaceDomain domain,
                                                   int depth) {
    const auto count = static_cast<std::size_t>(surface.GetNumPatchPoints()),
               controls = static_cast<std::size_t>(surface.GetNumControlPoints());
    const auto unit_vectors = [count](std::size_t size) {
        std::vector<double> points(count * size, 0.0);
        for (std::size_t k = 0; k < size; ++k) points[k * size + k] = 1;
        return points;
    };
    std::vector<double> rows = unit_vectors(controls);
    surface.ComputePatchPoints(rows.data(), PointDescriptor(static_cast<int>(controls)));
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(controls * controls));

    const std::vector<double> units = unit_vectors(count);
    const PointDescriptor all(static_cast<int>(count));
    std::vector<double> weights(count);
    const auto used = [&](const Vec2& uv) {
        surface.Evaluate(&uv.x, units.data(), all, weights.data());
        std::vector<int> points;
        for (std::size_t k = 0; k < count; ++k)
            if (weights[k] != 0) points.push_back(static_cast<int>(k));
        return points;
    };
    return std::make_unique<KindPoints>(KindPoints{std::move(rows), SubPatches(domain, depth, used)});
}

/// One face's limit surface with its patch points, relative to `origin` so that small faces far away stay
/// exact.
struct Patch {
    Bfr::Surface<double> surface;
    std::vector<double> points;           // empty: those that matter are made where they are asked for
    const KindPoints* by_kind = nullptr;  // of an irregular one without points
    Vec3 origin{0};
    double extent = 0;
    std::optional<std::uint64_t> kind;
    std::size_t own_tree = 0;  // bytes of a tree that no other face shares

    std::size_t bytes() const {
        return sizeof(Patch) + points.capacity() * sizeof(double) +
               static_cast<std::size_t>(surface.GetNumControlPoints()) * sizeof(int) + own_tree;
    }
};

/// Bytes of what the kinds of a dense mesh have in common.
constexpr std::size_t kKindBudget = kMostPatchBytes / 9;
/// Bytes of patches: the first ones asked for, and the latest of the others.
constexpr BoundedCache<Patch>::Budget kPatchBudget{kMostPatchBytes / 9 * 6, kMostPatchBytes / 9},
    kDensePatchBudget{kPatchBudget.kept - kKindBudget, kPatchBudget.recent};

/// The patch points of more faces of the mesh are not all kept, at some 12 kB; 20,000 faces' would not fit.
constexpr int kDense = 10'000;

}  // namespace

struct LimitPatches::Impl {
    PatchMesh mesh;
    std::shared_ptr<SharedTrees> trees;
    Bfr::RefinerSurfaceFactory<> factory;
    FaceDomain domain;
    bool is_dense;         // has so many faces that not all of their patch points are kept
    std::uint64_t number;  // of this surface, and of no other
    ManyKinds kinds{kKindBudget};
    BoundedCache<Patch> patches;  // per face of the mesh

    Impl(PatchMesh made, const CheckedCage& cage)
        : mesh(std::move(made)),
          trees(trees_by({cage.scheme, cage.interpolate_boundary, depth()})),
          factory(*static_cast<const Far::TopologyRefiner*>(mesh.refiner.get()), options()),
          domain(mesh.tree.triangles ? FaceDomain::kTriangle : FaceDomain::kSquare),
          is_dense(factory.GetNumFaces() > kDense),
          number(next_number()),
          patches(static_cast<std::size_t>(factory.GetNumFaces()),
                  is_dense ? kDensePatchBudget : kPatchBudget) {}

    static std::uint64_t next_number() {
        static std::atomic<std::uint64_t> last{0};
        return ++last;
    }
    int depth() const { return kDeepest - mesh.levels(); }
    Bfr::SurfaceFactory::Options options() const {
        Bfr::SurfaceFactory::Options options;
        options.SetApproxLevelSmooth(depth()).SetApproxLevelSharp(depth()).SetExternalCache(trees.get());
        return options;
    }

    bool has_limit(int face, std::size_t level) const {
        if (level == mesh.tree.levels.size()) return factory.FaceHasLimitSurface(face);
        const FaceChildren& children = mesh.tree.levels[level];
        for (int k = 0; k < children.count(face); ++k)
            if (!has_limit(children(face, k), level + 1)) return false;
        return true;
    }

    Patch make_patch(int face) {
        Patch patch;
        const std::optional<std::size_t> own_tree = trees->init(factory, face, patch.surface);
        TRILENS_CHECK(own_tree, "only faces with a limit surface are evaluated");
        patch.own_tree = *own_tree;
        if (!patch.surface.IsRegular() && !patch.surface.IsLinear()) patch.kind = SharedTrees::key();

        const auto count = 3 * static_cast<std::size_t>(patch.surface.GetNumPatchPoints()),
                   controls = 3 * static_cast<std::size_t>(patch.surface.GetNumControlPoints());
        thread_local std::vector<double> points;
        points.resize(count);
        patch.origin = mesh.points[first_control(patch.surface)];
        gather_controls(patch, points.data());
        for (std::size_t k = 0; k < controls; ++k) patch.extent = std::max(patch.extent, std::abs(points[k]));
        if (is_dense && patch.kind) patch.by_kind = kind_points(*patch.kind, patch.surface);
        if (patch.by_kind || (is_dense && count == controls)) return patch;
        patch.surface.ComputePatchPoints(points.data(), 3);
        patch.points = points;
        return patch;
    }

    /// None where few faces have been of the kind until now, or it has very many points.
    const KindPoints* kind_points(std::uint64_t kind, const Bfr::Surface<double>& surface) {
        constexpr int kMostPoints = 1200;  // while what they have in common is made it takes their square
        if (surface.GetNumPatchPoints() > kMostPoints) return nullptr;
        return kinds.of(kind, [&] { return make_kind_points(surface, domain, depth()); });
    }

    static int first_control(const Bfr::Surface<double>& surface) {
        std::vector<int> control(static_cast<std::size_t>(surface.GetNumControlPoints()));
        surface.GetControlPointIndices(control.data());
        return control[0];
    }

    /// Relative to the patch's origin.
    void gather_controls(const Patch& patch, double* points) const {
        thread_local std::vector<int> control;
        control.resize(static_cast<std::size_t>(patch.surface.GetNumControlPoints()));
        patch.surface.GetControlPointIndices(control.data());
        for (std::size_t i = 0; i < control.size(); ++i) {
            const Vec3 offset = mesh.points[control[i]] - patch.origin;
            for (int axis = 0; axis < 3; ++axis) points[3 * i + axis] = offset[axis];
        }
    }

    /// At (u, v) of a face of the mesh, relative to the patch's origin.
    template <bool kSecondOrder>
    void eval(const Patch& patch, int face, const Vec2& uv, SurfacePoint& point) const {
        if (!patch.points.empty()) return eval_points<kSecondOrder>(patch, patch.points.data(), uv, point);
        thread_local FewPoints few;
        const auto gather = [&](double* controls) { gather_controls(patch, controls); };
        const auto sum = [&](const double* weights, const double* controls, double* result) {
            patch.surface.ApplyStencil(weights, controls, 3, result);
        };
        const FewPoints::Face of{number, face, patch.by_kind,
                                 static_cast<std::size_t>(patch.surface.GetNumControlPoints())};
        eval_points<kSecondOrder>(patch, few.at(of, uv, gather, sum), uv, point);
        if (!std::isnan(point.position.x)) return;
        // On the border of parts that are no sub-patches, or of infinite points.
        std::vector<double> points(3 * static_cast<std::size_t>(patch.surface.GetNumPatchPoints()));
        gather(points.data());
        patch.surface.ComputePatchPoints(points.data(), 3);
        eval_points<kSecondOrder>(patch, points.data(), uv, point);
    }

    template <bool kSecondOrder>
    static void eval_points(const Patch& patch, const double* points, const Vec2& uv, SurfacePoint& at) {
        if constexpr (kSecondOrder)
            patch.surface.Evaluate(&uv.x, points, 3, &at.position.x, &at.du.x, &at.dv.x, &at.duu.x, &at.duv.x,
                                   &at.dvv.x);
        else
            patch.surface.Evaluate(&uv.x, points, 3, &at.position.x, &at.du.x, &at.dv.x);
    }

    template <class Use>
    auto with(int face, const Use& use) {
        const auto make = [this](std::size_t f) { return make_patch(static_cast<int>(f)); };
        return patches.with(static_cast<std::size_t>(face), make, use);
    }
};

LimitPatches::LimitPatches(const CheckedCage& cage, const std::string& name, double memory) {
    if (cage.face_count() > 0)  // OpenSubdiv refuses cages without faces
        impl_ = std::make_unique<Impl>(make_patch_mesh(cage, name, memory), cage);
}

LimitPatches::~LimitPatches() = default;

bool LimitPatches::has_limit(int face) const {
    return impl_->has_limit(face, 0);
}

std::vector<Box> LimitPatches::hulls(std::span<const Face> faces) const {
    if (!impl_) return {};
    const std::vector<Box> of_mesh = face_hulls_of(impl_->mesh);
    const auto& levels = impl_->mesh.tree.levels;
    const auto include = [&](const auto& self, int face, std::size_t level, Box& hull) -> void {
        if (level == levels.size()) return hull.include(of_mesh[static_cast<std::size_t>(face)]);
        for (int k = 0; k < levels[level].count(face); ++k)
            self(self, levels[level](face, k), level + 1, hull);
    };
    std::vector<Box> hulls(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const bool is_part = faces[f].sub_face >= 0;
        include(include, is_part ? levels[0](faces[f].face, faces[f].sub_face) : faces[f].face,
                is_part ? 1 : 0, hulls[f]);
    }
    return hulls;
}

std::size_t LimitPatches::bytes() const {
    return impl_ ? impl_->mesh.bytes() + impl_->trees->bytes() + impl_->kinds.bytes() + impl_->patches.bytes()
                 : 0;
}

template <bool kSecondOrder>
LimitPatches::Point LimitPatches::eval_to_order(int face, int sub_face, const Vec2& uv) const {
    const FaceTree::Leaf leaf = impl_->mesh.tree.leaf(face, sub_face, uv);
    return impl_->with(leaf.face, [&](const Patch& patch) {
        Point result;
        result.extent = patch.extent;
        SurfacePoint& point = result.point;
        impl_->eval<kSecondOrder>(patch, leaf.face, leaf.uv, point);
        point.position += patch.origin;
        for (Vec3* first : {&point.du, &point.dv}) *first *= leaf.scale;
        for (Vec3* second : {&point.duu, &point.duv, &point.dvv}) *second *= leaf.scale * leaf.scale;
        return result;
    });
}

LimitPatches::Point LimitPatches::eval(int face, int sub_face, const Vec2& uv) const {
    return eval_to_order<true>(face, sub_face, uv);
}

LimitPatches::Point LimitPatches::eval_first_order(int face, int sub_face, const Vec2& uv) const {
    return eval_to_order<false>(face, sub_face, uv);
}

std::optional<std::uint64_t> LimitPatches::kind(int face, int sub_face) const {
    if (impl_->mesh.tree.levels.size() > (sub_face >= 0 ? 1u : 0u)) return std::nullopt;
    const FaceTree::Leaf leaf = impl_->mesh.tree.leaf(face, sub_face, Vec2(0));
    return impl_->with(leaf.face, [](const Patch& patch) { return patch.kind; });
}

FaceControls LimitPatches::controls(int face, int sub_face) const {
    const FaceTree::Leaf leaf = impl_->mesh.tree.leaf(face, sub_face, Vec2(0));
    return impl_->with(leaf.face, [this](const Patch& patch) {
        FaceControls controls{patch.origin, {}};
        controls.offsets.resize(static_cast<std::size_t>(patch.surface.GetNumControlPoints()));
        impl_->gather_controls(patch, &controls.offsets[0].x);
        return controls;
    });
}

FaceStencils LimitPatches::stencils(int face, int sub_face, const Vec2& uv) const {
    const FaceTree::Leaf leaf = impl_->mesh.tree.leaf(face, sub_face, uv);
    return impl_->with(leaf.face, [&](const Patch& patch) {
        FaceStencils weights;
        for (std::vector<double>& of_one : weights)
            of_one.resize(static_cast<std::size_t>(patch.surface.GetNumControlPoints()));
        patch.surface.EvaluateStencil(&leaf.uv.x, weights[0].data(), weights[1].data(), weights[2].data(),
                                      weights[3].data(), weights[4].data(), weights[5].data());
        return weights;
    });
}

std::string surface_library_version() {
    return "OpenSubdiv " + std::to_string(OPENSUBDIV_VERSION_MAJOR) + "." +
           std::to_string(OPENSUBDIV_VERSION_MINOR) + "." + std::to_string(OPENSUBDIV_VERSION_PATCH);
}

}  // namespace trilens
