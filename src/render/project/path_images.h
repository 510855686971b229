// Where a point appears over several optics: seeds from the facets' RayMeshes, then exact.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/util/parallel.h"
#include "paths/facets/optic_paths.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/project/coaxial_images.h"
#include "render/project/film_parts.h"
#include "render/project/path_starts.h"
#include "render/shoot/shoot.h"
#include "specular/specular_point.h"
#include "trilinear/points/point_images.h"

namespace trilens {

/// An image of a point over two steps or more.
struct SeveralOpticsImage {
    Path path = Path::kReflect;
    Id optic = kNone;  // the first
    Id facet = kNone;  // of its grid
    std::vector<Step> steps;
    HistoryImage exact;
};

/// Which of the paths over several optics are looked for.
struct SeveralOpticsChoice {
    EventWord word;         // only its histories, and no deeper than it goes
    double min_weight = 0;  // histories that nowhere carry half of it in any colour are left out
    std::size_t least_steps = 2;  // shorter histories are left out
};

/// Looks through all facets of one optic that lie on the film; where facets are traced, from the exact rays
/// that pass nearest to the point. Each start is led to a path of light by Newton's method, and an exact ray
/// says whether the camera sees it; where a facet is proven to have one history none is asked. World and
/// frame must outlive it. Thread-safe to read.
class SeveralOpticsImages {
  public:
    SeveralOpticsImages(const World& world, const Frame& frame, std::size_t optic,
                        const SeveralOpticsChoice& choice = {});

    /// Every image that a facet leads to, each once. Images that something hides are among them.
    std::vector<SeveralOpticsImage> images(const Vec3& point) const;

  private:
    /// Rays of traced parts that one search starts from.
    static constexpr std::size_t kLoneStarts = 10;

    /// A film position in a part of a facet that has no corner rays, and where its path leaves the optics.
    struct LoneRay {
        Vec2 pixel{0};
        Id facet = kNone;
        Ray exit;          // unit
        double reach = 0;  // pixels: the part lies within
        bool may_be_on_film = true;
    };
    struct History {
        Path path = Path::kReflect;
        std::vector<Step> steps;
        std::vector<PathSegment> chain;
        std::vector<Colours> colours;            // per step
        RayMesh mesh;                            // until the seeds are made of it
        std::unique_ptr<MeshPointImages> seeds;  // null: no facet has it
        std::vector<Id> grid_facet;              // per facet of the seeds' mesh
        std::vector<char> proven;                // likewise: all its rays have the history
        std::vector<LoneRay> lone;
        std::unique_ptr<CoaxialImages> coaxial;
        double most_light = 0;  // of any colour, at any corner or lone ray
        // Made when first asked for: per facet of the seeds' mesh, and per lone ray.
        std::unique_ptr<Lazy<FacetPaths>[]> facet_paths;
        std::unique_ptr<Lazy<LonePath>[]> lone_paths;

        Few<std::size_t, kLoneStarts> nearest_lone(const Vec3& point, bool off_film) const;
    };

    /// Histories told apart: a step after a place, kNone the beginning, is a place too.
    using StepFrom = std::tuple<Id, Id, Event>;
    using HistoryEnd = std::pair<Id, Colours>;  // its last place

    class Search;

    void add_nodes();
    std::vector<FilmTriangle> traced_triangles() const;
    void add_film_parts();
    void add_film_part(const FilmParts& parts, const FilmPart& part, std::vector<char>& begun);
    static void add_fine_facet(History& history, Id facet, const std::array<Vec3, 3>& screen,
                               const std::array<const PathSegment*, 3>& ends);
    bool is_near_facet(Id facet, const Vec3& place) const;
    std::vector<PathSegment> followed_from(Id facet, const Vec2& pixel) const;
    History& history_of(const std::vector<PathSegment>& segments, Id last);
    void drop_histories();
    void get_ready();
    void find_coaxial(History& history) const;
    std::vector<SeveralOpticsImage> images_over(const History& history, const Vec3& point) const;

    const World& world_;
    const Frame& frame_;
    SeveralOpticsChoice choice_;
    PathWorld followed_;  // as deep as the word goes
    PathBuilder builder_;
    std::vector<History> histories_;
    std::map<StepFrom, Id> places_;
    std::map<HistoryEnd, std::size_t> history_at_;
    SurfaceOf surface_of_;
};

// Where a point appears through the facets of one optic, each image then refined on the exact surface.

/// An image of a point over one optic, before anything asks what hides it.
struct OpticImage {
    Id facet = kNone;   // of the optic's grid
    Vec2 pixel{0};      // from the film's top left
    double t = 0;       // along the ray that leaves the optic, in units of its direction
    double length = 0;  // the same in scene units
    Vec3 from{0};       // where light leaves the optic: on the exact surface where refined, else on the facet
    SurfaceParameter at{};  // where refined
    Vec3 normal{0};         // there
    bool refined = false;
    bool front = true;  // the camera sees the optic's front there
};

/// An image on the exact surface, seen at a pixel.
OpticImage optic_image(const SpecularPoint& exact, Id facet, const Vec2& pixel);

/// The law by which the optic images `point` on this path; for glass seen from its front. The camera has an
/// eye or parallel rays; of one whose film is not linear pixels mean nothing.
SpecularQuery specular_query(const World& world, const Frame& frame, std::size_t optic, Path path);

/// Copies what it needs of the mesh; world, frame and path must outlive it. Thread-safe to read.
class FacetImages {
  public:
    FacetImages(const World& world, const Frame& frame, std::size_t optic, const PathMesh& path);

    /// All images through the facets (thesis chapter 3), those left out that the facets themselves hide from
    /// the camera. `refine`: each is moved to the exact image near it, where there is one (linear cameras
    /// only); two that come to one exact image count once. `known`: exact images that are had already, not
    /// listed again.
    std::vector<OpticImage> images(const Vec3& point, bool refine,
                                   std::vector<SpecularPoint> known = {}) const;

  private:
    bool is_shown(const MeshPointImage& image) const;
    bool hidden(const MeshPointImage& image) const;
    bool shows_front(const MeshPointImage& image) const;
    std::optional<SpecularPoint> refined(const MeshPointImage& image, const Vec3& point) const;

    const World& world_;
    const Frame& frame_;
    std::size_t optic_;
    const PathMesh& path_;
    const OpticFacets& facets_;
    struct Search {
        MeshPointImages images;
        FacetsAround around;  // facets at each point of the grid
    };
    const Search& search() const;
    Lazy<Search> search_;  // where exact surfaces are searched completely nobody asks
};

}  // namespace trilens
