// Visibility among overlapping facets on the film: the nearest facet over a position.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "paths/facets/optic_paths.h"
#include "paths/nested/mirror_chain.h"
#include "shade/optic_weights.h"

namespace trilens {

/// A facet at a place of the film.
struct CoveringFacet {
    Id facet = kNone;
    Vec3 weights{0};   // of its corners, sum 1
    double depth = 0;  // w of the screen positions, interpolated
};

/// Facets on the film, sorted into squares of it. Facets with a corner of w <= 0 cover nothing. Thread-safe
/// to read.
class NestedCover {
  public:
    NestedCover() = default;
    /// `outline`: screen positions and facets are asked, no rays. Must live longer. `covers`: per facet.
    NestedCover(const RayMesh& outline, std::vector<char> covers);

    /// The facet of least depth over a place; places on a facet's border belong to it, and of two equal ones
    /// the one of the lower number counts.
    std::optional<CoveringFacet> at(const Vec2& pixel) const;

    /// Whether facets that cover anything have bounds near this part of the film's plane: false only where
    /// none covers a place of it.
    bool may_cover(const Vec2& low, const Vec2& high) const;

    /// Pixels of the film's plane that its bounds take; 0: it covers nothing.
    double area() const;
    /// The root of the mean area of the facets that cover anything, in pixels.
    double facet_size() const { return facet_size_; }

  private:
    Vec2 low_{0}, high_{0};
    double square_ = 1, facet_size_ = 0;  // pixels
    std::size_t across_ = 0, down_ = 0;
    std::vector<std::size_t> first_;  // per square, and one more: into facet_
    std::vector<Id> facet_;
    std::vector<FacetWeights> weights_;  // per facet
    const RayMesh* outline_ = nullptr;
};

// Nested optics: optics seen in mirrors, each with its own grid imaged over the chain of mirrors before it.

/// The surface of an optic that may be nested; what is pointed to must live longer.
struct NestedSurface {
    const Surface* surface = nullptr;
    const SurfaceGrid* grid = nullptr;
    bool fit = false;         // its corner rays are fitted
    bool own_normals = true;  // see ChainMirror
};

/// What all nested optics of one camera have in common.
struct NestedStage {
    PathWorld world;                    // whole
    std::vector<NestedSurface> optics;  // as PathWorld::optics
    PathCamera camera;                  // perspective, in air
    Vec3 eye{0};                        // its centre, world
    DivideParams divide;                // of facets that a nested optic's corners do not tell the truth about
};

class NestedOptic;

/// A nested optic at a place of the film.
struct NestedPlace {
    std::size_t optic = 0;  // of NestedOptics::all
    CoveringFacet facet;
};

/// The optics that are seen in the last mirror of a chain. A place of the film shows the one that covers it
/// nearest, by the way over the chain.
class NestedOptics {
  public:
    /// `chain`: the optics met, mirrors all. `towards`: directions of the eye that lead over it, to begin the
    /// search for images from.
    NestedOptics(const NestedStage& stage, std::vector<Id> chain, std::vector<Vec3> towards);
    ~NestedOptics();

    /// Works out which optics are nested optics; once. An optic is none where it has no image over the chain,
    /// or a very small one.
    void build();
    /// How many pixels there are for them, before they are worked out: an optic whose grid has more points is
    /// no nested optic, since to follow the pixels' own rays is less work.
    void set_room(double pixels) { room_ = pixels; }

    std::optional<NestedPlace> at(const Vec2& pixel) const;

    /// Whether a place where the exact path goes on to `next` (kNone: to no optic) shows that optic's nested
    /// optic, but for how far the outlines of facets lie from the exact ones.
    bool agree(const Vec2& pixel, Id next) const;

    /// Whether an optic is a nested optic that covers something near this part of the film, in pixels.
    bool may_cover(Id optic, const Vec2& low, const Vec2& high) const;

    const std::vector<std::unique_ptr<NestedOptic>>& all() const { return nested_; }

  private:
    const NestedStage& stage_;
    std::vector<Id> chain_;
    std::vector<Vec3> towards_;
    double room_ = std::numeric_limits<double>::infinity();
    bool built_ = false;
    std::vector<std::unique_ptr<NestedOptic>> nested_;
};

/// One optic seen over a chain of mirrors: the RayMeshes that leave it, as OpticPaths has them for an optic
/// that the camera sees itself.
class NestedOptic {
  public:
    /// `images`: per point of the optic's grid the eye's ray over the chain to it, where there is one.
    NestedOptic(const NestedStage& stage, std::vector<Id> chain, Id optic,
                std::vector<std::optional<ChainRay>> images);
    ~NestedOptic();
    NestedOptic(const NestedOptic&) = delete;
    NestedOptic& operator=(const NestedOptic&) = delete;

    Id optic() const { return optic_; }
    const std::vector<Id>& chain() const { return chain_; }
    const NestedCover& cover() const { return cover_; }
    PathBuilder& builder() { return *builder_; }
    /// What is seen in it; null where nothing is looked for: it is glass, or paths end there.
    NestedOptics* deeper() { return deeper_.get(); }
    const SurfaceGrid& grid() const { return *stage_.optics[optic_].grid; }
    bool is_mirror() const { return stage_.world.optics[optic_].mirror; }
    /// How the eye's ray arrives at a point of a facet: the side is the facet's own; the angle that of the
    /// interpolated normal, grazing where it turned away.
    Incidence arrival(const CoveringFacet& at) const;
    /// The point of the facet, world.
    Vec3 point(const CoveringFacet& at) const;

  private:
    PathCamera make_camera() const;
    std::vector<char> seen_facets() const;
    CornerView view_of(const ChainRay& ray, const Vec3& point) const;
    const ChainRay* nearest_image(const Vec3& point) const;

    const NestedStage& stage_;
    std::vector<Id> chain_;
    Id optic_ = kNone;
    MirrorChain mirrors_;
    PathWorld world_;  // paths from here on
    std::vector<std::optional<ChainRay>> images_;
    std::vector<CornerView> views_;  // per corner; w = 0: no image
    std::unique_ptr<NestedOptics> deeper_;
    std::optional<PathBuilder> builder_;
    NestedCover cover_;
};

/// The chain's mirrors as rays meet them.
MirrorChain mirror_chain(const NestedStage& stage, std::span<const Id> chain);

}  // namespace trilens
