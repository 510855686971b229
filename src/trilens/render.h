// Pictures of scenes: projected, or ray traced as the truth.
//
//     #include <trilens/image.h>
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"scene.json"}));
//     trilens::PictureRequest request;
//     request.frame.resolution = 16;
//     trilens::write_image("projected.exr", renderer.draw(request).image);
//     request.engine = trilens::Engine::kLimitTruth;
//     trilens::write_image("truth.exr", renderer.draw(request).image);
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "image/tone.h"
#include "render/frame/request.h"
#include "render/picture/explain.h"
#include "render/project/project.h"
#include "render/shoot/shoot.h"
#include "render/world/scene_reuse.h"
#include "scene/data/scene.h"
#include "vector/lines.h"

namespace trilens {

struct World;

/// An optic as callers know it.
struct OpticInfo {
    Id object = kNone;  // its index in Scene::meshes, as in the channel optic.object
    std::string name;
    bool mirror = true;  // else glass
    int resolution = 8;  // the scene's
    std::size_t faces = 0;
};

/// A triangle of the scene, as images name it.
struct SeenTriangle {
    Id object = kNone, primitive = kNone;
    Vec3 position{0};  // the world point that is seen
};

/// A picture as the bytes of a file.
struct EncodedPicture {
    Picture picture;  // its image has windows and header, but no channels
    std::vector<unsigned char> bytes;
};

/// The outlines of what a camera and its optics show.
struct LineDrawing {
    std::string svg;                   // one document; see the command's help for its attributes
    std::size_t curves = 0, arcs = 0;  // of it
    std::size_t marks = 0;             // images of points and labels
    std::size_t folds = 0;             // curves where what an optic or the camera shows turns over
    // Where caustics were chosen: they and the fold curves in the world, as a Wavefront OBJ, and by layer.
    std::string obj;
    struct Caustic {
        std::string path;  // "reflect", "refract"; "direct": of the camera's own rays
        Id optic = kNone;  // object id; kNone: the camera
        CausticSheet sheet;
    };
    std::vector<Caustic> caustics;
    std::vector<EdgeLine> edge_lines;  // the curves of the SVG, in its order of layers
    std::vector<FoldCurve> fold_curves;
    std::vector<FacetEdge> facet_edges;  // where they were chosen
};

/// A scene with what is built from it, each part once: surfaces, trees, grids. Pictures of one renderer may
/// be drawn from several threads at once.
class Renderer {
  public:
    /// Throws InputError where the scene is none (check_scene) or a cage has no limit surface. `warn` is told
    /// of what cages leave out.
    explicit Renderer(Scene scene, const Warn& warn = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Goes on with another scene, as of an animation's next frame; what is built of meshes that are the same
    /// in both stays. Throws as the constructor does, and then nothing has changed; UsageError while another
    /// thread draws with this renderer, or is told to change it. Drawing throws UsageError meanwhile.
    SceneReuse change(Scene scene, const Warn& warn = {});

    const Scene& scene() const;
    std::vector<OpticInfo> optics() const;
    std::size_t triangle_count() const;  // of the objects
    /// Of the optics' grids; 0: at the scene's resolutions. Throws UsageError for one beyond 1..1024.
    std::size_t facet_count(int resolution = 0) const;

    /// Throws what draw would for this camera and resolution, without drawing.
    void check(const FrameParams& frame) const;

    /// One picture, the same pixels for any number of threads. Throws UsageError for a window, layer or
    /// camera that the scene does not have, InputError where it does not fit in memory, ComputationError for
    /// pixels that are not finite, Interrupted once `progress` says so.
    Picture draw(const PictureRequest& request, const Progress& progress = {}, const Warn& warn = {}) const;

    /// The same picture as write_image would write it, encoded while it is drawn: it is never held whole.
    /// Throws as draw does, and OutputError where it cannot be encoded.
    EncodedPicture draw_exr(const PictureRequest& request, const Progress& progress = {},
                            const Warn& warn = {}) const;

    /// Its beauty as the PNG that write_image would write. Throws as draw_exr does, and UsageError as
    /// write_image does.
    EncodedPicture draw_png(const PictureRequest& request, const ToneMapping& tone = {},
                            const Progress& progress = {}, const Warn& warn = {}) const;

    /// The same as draw_exr into a file, which is written while the picture is drawn and takes its name once
    /// it is whole: neither the picture nor its bytes are held. The picture that is returned has windows and
    /// header, but no channels. Throws as draw does, and OutputError where the file cannot be written; then
    /// nothing is left of it.
    Picture write_exr(const std::string& file, const PictureRequest& request, const Progress& progress = {},
                      const Warn& warn = {}) const;

    /// How one pixel comes about. Throws UsageError for a pixel off the film, or a camera, resolution,
    /// largest error or engine that there is not, InputError where the camera cannot show what the scene has
    /// or the optics have too many facets to hold.
    PixelExplanation explain(const PictureRequest& request, int x, int y) const;

    /// What a hit of an explanation is. Throws UsageError for one that is unset or of another scene.
    SeenTriangle seen_triangle(const Hit& hit) const;

    /// Where world points appear: for each point its images, direct and over every optic. What it builds for
    /// the search is kept for the next call with the same request. Throws InputError for points that are not
    /// within kLargestCoordinate, and where the camera cannot show what the scene has; UsageError for a
    /// camera, resolution or largest error that there is not; Interrupted once `progress` says so.
    std::vector<PointProjection> project(std::span<const Vec3> points, const ProjectRequest& request = {},
                                         const Progress& progress = {}) const;

    /// The same of points at infinity: directions from the scene to them, of any length but 0.
    std::vector<PointProjection> project_directions(std::span<const Vec3> directions,
                                                    const ProjectRequest& request = {},
                                                    const Progress& progress = {}) const;

    /// Moves known images to where they are now, by Newton's method alone: nothing is searched, and nothing
    /// but surfaces built. One for each start; none where there is none near. Throws UsageError for starts
    /// that are none of this scene's optics and faces.
    std::vector<std::optional<WorldImage>> refine(std::span<const Vec3> points,
                                                  std::span<const ImageStart> starts,
                                                  const ProjectRequest& request = {}) const;

    /// What the rays through places of a camera's film meet; pixels from the top left, a pixel's centre at
    /// .5. Throws UsageError for a camera that there is not, InputError for places that are not finite.
    ShotRays shoot(std::span<const Vec2> places, const ShootRequest& request = {}) const;

    /// What rays of one's own meet: world, directions of any length. Throws InputError for rays that are not
    /// finite or have no direction.
    ShotRays shoot(std::span<const Ray> rays, const ShootRequest& request = {}) const;

    /// The picture as lines. Throws UsageError for a camera, resolution or largest error that there is not,
    /// InputError where the camera cannot show what the scene has or the optics have too many facets to hold.
    /// `warn` is told of what the drawing leaves out.
    LineDrawing draw_lines(const FrameParams& frame, const LineChoice& lines = {},
                           const Warn& warn = {}) const;

    /// A digest (16 hexadecimal digits) of all that the scene holds: equal digests, equal pictures.
    std::string digest() const;

    /// What the renderer is made of; its type is no part of the public headers.
    const World& world() const { return *world_; }

    /// Does work that asks the world while nobody may change it. Throws UsageError where another thread does,
    /// and what `work` throws.
    void use_world(const std::function<void(const World&)>& work) const;

  private:
    class Users;
    class KeptProjector;

    std::unique_ptr<World> world_;
    std::unique_ptr<Users> users_;
    std::unique_ptr<KeptProjector> projector_;
};

}  // namespace trilens
