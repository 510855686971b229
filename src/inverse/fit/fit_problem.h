// Numbers of a scene named by JSON pointers, as unknowns of a fit.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"
#include "camera/camera.h"
#include "intersect/limit_tracer.h"
#include "inverse/fit/fit.h"
#include "inverse/solve/least_squares.h"
#include "json/json.h"
#include "render/frame/camera_rays.h"
#include "scene/data/polygons.h"
#include "scene/data/scene.h"

namespace trilens {

struct World;

/// The parts of a scene whose numbers a picture's geometry depends on.
enum class ScenePart { kCamera, kMesh, kMaterial };

/// One unknown: a number of the scene's JSON, or a turn of a mesh about a world axis.
struct FitParameter {
    std::string name;  // its pointer; of a turn with the axis: "/meshes/0/transform/rotate/x"
    ScenePart part = ScenePart::kMesh;
    std::size_t index = 0;  // of the part in its array
    std::string inside;     // JSON pointer inside of the part
    bool is_turn = false;   // of a quaternion: about `axis`, degrees, counted from where the fit begins
    Vec3 axis{0};
    double scale = 1;  // a large step, in the parameter's unit
};

/// The unknowns that pointers name, each once: a number, an array of numbers (all of its entries), or a
/// mesh's quaternion `transform/rotate` (three turns about the world's axes). Entries of arrays are named by
/// place or by name; a key that is missing in `document` but has a default in the schema is added to it.
/// `extent`: the scene's size, a large step of lengths. Throws InputError with the pointer where it names no
/// number, or none of a camera, an optic or a material.
std::vector<FitParameter> find_parameters(Json& document, std::span<const std::string> pointers,
                                          const std::string& file, double extent);

/// Throws InputError with the pointer where the keys that find_parameters adds make another scene, or none: a
/// primitive's radius where a mesh has points.
void require_same_scene(const Scene& scene, std::span<const std::string> free);

/// The part's JSON in the document.
Json& part_of(Json& document, const FitParameter& parameter);
const Json& part_of(const Json& document, const FitParameter& parameter);

/// Moves the parameter by `amount` of its unit; `part`: the JSON that it stands in.
void move_parameter(Json& part, const FitParameter& parameter, double amount);

/// Its number; of a turn the component of the rotation vector from `start` to `document`, degrees.
double parameter_value(const Json& document, const FitParameter& parameter, const Json& start);

/// What a null vector moves, in words: "turning /meshes/0 about the axis (0, 1, 0)", "/meshes/0/primitive/
/// radius with /cameras/0/yfov".
std::string describe_motion(std::span<const FitParameter> parameters, std::span<const double> motion);

// The part of a scene that images of points depend on, made anew where a fit's parameters move it.

/// An optic: a surface as it was built, moved since by an affine map, under which limit surfaces stay limit
/// surfaces, so that nothing is built again.
struct FitOptic {
    Id mesh = kNone;
    bool mirror = true;  // else glass
    int priority = 0;
    double ior = 1;
    std::shared_ptr<const Surface> surface;     // as built
    std::shared_ptr<const LimitTracer> tracer;  // of it; null where only its parameters are asked for
    std::shared_ptr<const std::vector<Vec3>> outline;  // of glass that has a tracer, see outline_of
    Transform built;                            // the mesh's transform when it was built
    Transform moved, unmoved;                   // from there to where it is now, and back
    bool is_moved = false;
};

/// Cameras of the scene, and its optics.
struct FitScene {
    std::vector<Camera> cameras;
    std::vector<FitOptic> optics;
    std::vector<CameraMedia> media;  // per camera what its rays start in; see ask_media
};

/// Sets what the cameras' rays start in, as pictures of the scene have it: of the optics, which have tracers.
void ask_media(FitScene& scene);

/// The ray as the optic's surface, as built, meets it at the same t.
Ray unmoved_ray(const FitOptic& optic, const Ray& ray);

/// Position and derivatives as the moved surface has them, of those as built.
SurfacePoint moved_point(const FitOptic& optic, const SurfacePoint& as_built);

/// Makes the scene's parts of its JSON. Keeps a reference to the scene.
class FitSceneMaker {
  public:
    /// Throws InputError where an optic has overridden normals, whose images are no stationary paths.
    explicit FitSceneMaker(const Scene& scene);

    /// Whole, with tracers. `parameters`: those that will move: meshes whose transform alone moves are built
    /// once.
    FitScene make(const Json& document, const std::vector<FitParameter>& parameters);

    /// Puts the part that the parameter stands in, as `part` has it, into a scene made before. Throws
    /// InputError where it is none. `with_tracer`: for rays; else for derivatives.
    void set_part(FitScene& scene, const FitParameter& parameter, const Json& part, bool with_tracer) const;

  private:
    Camera camera_of(const Json& json, std::size_t index) const;
    void set_mesh(FitScene& scene, std::size_t index, const Json& json, bool with_tracer) const;
    void build(FitOptic& optic, const Mesh& mesh, bool with_tracer) const;
    std::string file() const { return scene_title(scene_); }

    const Scene& scene_;
    std::set<std::size_t> moves_only_;  // meshes of which only the transform changes
    std::set<std::size_t> moved_materials_;
};

// What a path of light does at each optic that it meets, as letters: R reflected, T transmitted, ? either.

/// "R", "TT", "R?T"; "D": direct, over no optic; empty: whatever it is that carries most light.
using PathWord = std::string;

/// Throws UsageError for other letters, and for D among others.
void check_path_word(const PathWord& word);

// The path of the camera's ray through a film place, over the exact optics of a fit.

/// One meeting with an optic.
struct OpticEvent {
    std::size_t optic = 0;  // of FitScene::optics
    Id face = kNone;
    Vec2 uv{0};
    SurfacePoint as_built;  // of the optic's surface as built, with second derivatives
    SurfacePoint point;     // world
    bool reflects = true;
    Id before = kNone, after = kNone;  // optics whose glass the light runs in; kNone: air
};

/// A path from the camera: its events, and the ray that leaves the last of them.
struct ShotPath {
    Ray view;  // the camera's ray, unit direction
    std::vector<OpticEvent> events;
    Ray last;  // unit direction
    /// Per number of events k: the ray after k of them, and how far it goes to the next event.
    std::vector<Ray> after;
    std::vector<double> reach;
};

/// The refractive index of the glass of an optic; 1 of air.
double index_of(const FitScene& scene, Id medium);

/// The path of the ray through `pixel` that the word describes; with an empty word the one that mirrors
/// reflect and glass transmits, or reflects totally, to its end. It begins in the camera's media. None where
/// the camera has no ray there, or where the ray does not meet what the word says.
std::optional<ShotPath> shoot_path(const FitScene& scene, std::size_t camera, const Vec2& pixel,
                                   const PathWord& word);

/// Keeps the first `count` events.
void cut_path(ShotPath& path, std::size_t count);

/// Where the last ray passes nearest to a point: in front of where it starts.
Vec3 nearest_on_last(const ShotPath& path, const Vec3& point);

/// Of the numbers of events after which the light runs in air, or in what it began in, or of all, the one
/// whose ray passes nearest to the point before it meets the next optic.
std::size_t events_towards(const ShotPath& path, const Vec3& point);

// How the image of a point moves with the point and with a scene's parameters: the implicit function theorem
// on Fermat's stationary path.

/// A scene with one parameter moved back and forth by `step` of its unit; surfaces keep their parameters.
struct ParameterDifference {
    FitScene minus, plus;
    double step = 1;
    bool moves_camera = false;  // some camera
};

/// Of the image of a point on a path's last ray.
struct PathDerivatives {
    std::array<Vec3, 2> by_point{};  // of x and of y, pixels per scene unit
    std::vector<Vec2> by_parameter;  // pixels per unit of each parameter
};

/// A place on the film and the camera that it is of.
struct ShownPlace {
    std::size_t camera = 0;
    Vec2 pixel{0};
};

/// Of the image at `place`, whose path to `point` goes over the events. None at a caustic, where the image
/// moves infinitely fast, and where the camera does not show the first event.
std::optional<PathDerivatives> path_derivatives(const FitScene& scene, const ShownPlace& place,
                                                std::span<const OpticEvent> events, const Vec3& point,
                                                std::span<const ParameterDifference> parameters);

// The least squares problem of a fit: residuals and Jacobians of all pairs, along rays or by exact images.

/// What a pair's residual is: along the ray of its pixel, (dx/dX) (X - Y) with Y the ray's place nearest to
/// the point X (Sampson's, its metric held until the next linearisation); or by the image of X.
/// Near a fold, where the least step of a parameter may leave no image, kImage takes the former.
enum class FitResidual { kRay, kImage };

/// How much less a pixel tells near a fold than the image's slope there says: the residual loses a part along
/// the direction of the film in which images move most, so that its variance is that of the pixel again.
struct FoldWhitening {
    Vec2 along{0};        // unit, or 0
    double variance = 1;  // of the residual along it, in squared sigmas, at least 1

    double shrink() const { return 1 - 1 / std::sqrt(variance); }
    Vec2 of(const Vec2& residual) const { return residual - shrink() * dot(along, residual) * along; }
};

/// The mean of f(z, w)^2 over independent normal z and w, by Gauss's and Hermite's rule of three points each:
/// exact where f is of second degree. Where f is none it is left out; 0 where it is so everywhere.
double normal_mean_square(const std::function<std::optional<double>(double, double)>& f);

/// Of an image with slope dx/dX: unit, the direction on the film in which it moves most, and how far, in
/// pixels per scene unit.
struct FastestMotion {
    Vec2 along{0};
    double rate = 0;
};
FastestMotion fastest_motion(const std::array<Vec3, 2>& slope);

/// A pair as the problem holds it.
struct FitPair {
    Vec2 pixel{0};
    Vec3 point{0};
    double sigma = 1;
    std::size_t camera = 0;
    std::string word;

    Vec2 guess{0};           // kImage: where its image was last
    std::size_t events = 0;  // of its path; 0 and no "D": none is known yet, the pair is lost
    bool is_lost = false;
    std::array<Vec3, 2> metric{};  // dx/dX at the last linearisation
    double distance = 0;           // there, of the point from where its last ray begins
    FoldWhitening whitening = {};  // there
    Vec2 off = Vec2(0);            // there, the residual, pixels
    bool is_near_fold = false;     // kImage: measured along its ray
    /// kImage, near a fold: the variance of the offset from its ray in the direction of the whitening, scene
    /// units; 0: not asked yet.
    double spread = 0;
    std::vector<OpticEvent> path = {};  // at the last linearisation where it was not lost; may be empty
};

/// Residuals are in units of the pairs' sigmas; unknowns in the parameters' scales. The scene must live
/// longer.
class FitProblem {
  public:
    FitProblem(const Scene& scene, Json document, std::vector<FitParameter> parameters,
               std::vector<FitPair> pairs);

    struct Prior {
        std::size_t parameter = 0;
        double value = 0, sigma = 1;
    };

    std::vector<Prior> priors;
    double huber = 8;  // of a pair in units of its own sigma
    /// kImage: a pair without a path takes that of its pixel's ray, as soon as there is one.
    bool finds_paths = true;
    FitResidual residual = FitResidual::kRay;
    /// kRay: a pair's ray counts only over the optics that its path has already.
    bool keeps_paths = false;
    /// The residual of a lost pair, in sigmas: constant, so that it pulls nowhere.
    double lost_sigmas = 40;
    const Progress* progress = nullptr;

    LeastSquares least_squares();
    Linearisation linearise();

    const Json& document() const { return document_; }
    const FitScene& scene() const { return scene_; }
    const std::vector<FitParameter>& parameters() const { return parameters_; }
    std::vector<FitPair>& pairs() { return pairs_; }
    const std::vector<FitPair>& pairs() const { return pairs_; }
    const Json& start() const { return start_; }

  private:
    std::optional<std::vector<double>> residuals_after(std::span<const double> step);
    bool move(std::span<const double> step, Json& document, FitScene& scene) const;
    std::vector<ParameterDifference> differences() const;
    void take_path(FitPair& pair) const;
    Vec2 linearise_pair(FitPair& pair, std::span<const ParameterDifference> parameters, DenseMatrix& jacobian,
                        std::size_t row) const;
    std::optional<PathDerivatives> linearise_either(FitPair& pair,
                                                    std::span<const ParameterDifference> parameters) const;
    std::optional<PathDerivatives> linearise_ray(FitPair& pair,
                                                 std::span<const ParameterDifference> parameters) const;
    std::optional<PathDerivatives> linearise_image(FitPair& pair,
                                                   std::span<const ParameterDifference> parameters) const;
    std::optional<Vec3> passes(const FitPair& pair, const Vec2& pixel) const;
    FoldWhitening whitening_at(FitPair& pair, const Vec2& pixel) const;
    double lost_residual(const FitPair& pair) const;
    std::optional<Vec2> trial_residual(const FitPair& pair, const FitScene& scene) const;
    std::optional<ShotPath> shoot(const FitScene& scene, const FitPair& pair, const Vec2& pixel) const;
    struct Image {
        Vec2 pixel{0};
        ShotPath path;
    };
    std::optional<Image> image_of(const FitScene& scene, const FitPair& pair) const;
    void add_priors(const Json& document, std::vector<double>& residuals) const;

    FitSceneMaker maker_;
    Json start_, document_;
    std::vector<FitParameter> parameters_;
    std::vector<FitPair> pairs_;
    FitScene scene_;
    int images_linearised_ = 0;
    /// Of images: pixels for the angle of a last ray.
    double usual_rate_ = std::numeric_limits<double>::infinity();
};

/// Starts each pair at an image of its point in the world as it is; pairs without one are lost.
void match_images(const World& world, std::span<const Correspondence> given, FitMatch match,
                  FitProblem& problem);

/// What each pair's ray starts in.
std::vector<Media> media_of_pairs(const FitScene& scene, std::span<const FitPair> pairs);

/// Tells of cameras of pairs that do not end in what they began in, and of those of which it is not sure what
/// they stand in. `began`: media_of_pairs where the fit began.
std::vector<std::string> media_warnings(const Scene& scene, const FitProblem& problem,
                                        std::span<const Media> began);

/// The smallest value that half of all do not exceed, or the next; some values.
double median_of(std::vector<double> values);

/// What must be said of pairs that alone fix a part of what is free, because their images lie near a fold:
/// each by its number from 1 on, as the pairs were given. `jacobian`: reweighted, two rows a pair first;
/// `found`: of it. None where pairs are so few that each fixes something.
std::vector<std::string> leverage_warnings(const DenseMatrix& jacobian, const Uncertainty& found,
                                           const std::vector<FitPair>& pairs);

}  // namespace trilens
