// Fold curves of line drawings against the exact truth: there, and only there, what an optic shows turns
// over.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;

namespace {

constexpr int kFinerCurves = 8;  // the truth's pixels along one of the drawing's

Scene before_wall(const Primitive& optic, bool glass, double wall, const Vec3& eye) {
    Scene scene;
    scene.film = {80, 60, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = eye;
    camera.at = {0, 0, 0};
    camera.kind = PerspectiveCamera{.yfov = 40};
    scene.cameras.push_back(camera);
    Material bright, red;
    bright.transmission_factor = glass ? 1 : 0;
    bright.metallic_factor = glass ? 0 : 1;
    red.unlit = true;
    scene.materials = {bright, red};
    Mesh body, far;
    body.name = "optic", body.role = Role::kOptic, body.material = 0, body.resolution = 32;
    body.primitive = optic;
    far.name = "wall";
    far.object.points = {{-60, -60, wall}, {60, -60, wall}, {60, 60, wall}, {-60, 60, wall}};
    far.object.triangles = {{0, 1, 2}, {0, 2, 3}};
    far.object.material = {1, 1};
    scene.meshes = {body, far};
    return scene;
}

/// What the truth shows on the wall z = const, and how its orientation goes over the film.
class TurningTruth {
  public:
    TurningTruth(Scene scene, const std::string& path) {
        scene.film.width *= kFinerCurves, scene.film.height *= kFinerCurves;
        PictureRequest request;
        request.engine = Engine::kLimitTruth;
        request.layers.layers = {path};
        image_ = Renderer(std::move(scene)).draw(request).image;
        object_ = &image_.find(path + "ID.object")->ids();
        x_ = &image_.find(path + "P.X")->floats(), y_ = &image_.find(path + "P.Y")->floats();
    }

    /// The sign of the Jacobian by differences of neighbours; 0 where one of them does not see the wall.
    int side(int x, int y) const {
        if (x < 1 || y < 1 || x + 1 >= image_.width || y + 1 >= image_.height) return 0;
        const std::size_t w = static_cast<std::size_t>(image_.width),
                          at = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
        for (const std::size_t one : {at, at - 1, at + 1, at - w, at + w})
            if ((*object_)[one] != 1) return 0;
        const double xx = (*x_)[at + 1] - (*x_)[at - 1], xy = (*x_)[at + w] - (*x_)[at - w],
                     yx = (*y_)[at + 1] - (*y_)[at - 1], yy = (*y_)[at + w] - (*y_)[at - w];
        const double jacobian = xx * yy - xy * yx;
        return (jacobian > 0) - (jacobian < 0);
    }

    /// Whether both orientations, or a border of what shows the wall, are within `reach` of a place in the
    /// drawing's pixels.
    bool turns_near(const Vec2& place, double reach) const {
        bool plus = false, minus = false;
        const int x = static_cast<int>(place.x * kFinerCurves), y = static_cast<int>(place.y * kFinerCurves),
                  r = static_cast<int>(std::ceil(reach * kFinerCurves));
        for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx) {
                plus |= side(x + dx, y + dy) > 0;
                minus |= side(x + dx, y + dy) < 0;
            }
        return plus && minus;
    }

    /// Places in the drawing's pixels where the orientation changes from one pixel to the next.
    std::vector<Vec2> turns() const {
        std::vector<Vec2> found;
        for (int y = 0; y < image_.height; ++y)
            for (int x = 0; x < image_.width; ++x) {
                if (side(x, y) * side(x + 1, y) < 0)
                    found.push_back(Vec2(x + 1.0, y + 0.5) / 1.0 / double(kFinerCurves));
                if (side(x, y) * side(x, y + 1) < 0)
                    found.push_back(Vec2(x + 0.5, y + 1.0) / double(kFinerCurves));
            }
        return found;
    }

  private:
    Image image_;
    const std::vector<Id>* object_ = nullptr;
    const std::vector<float>*x_ = nullptr, *y_ = nullptr;
};

/// The lines of a drawing's folds over this path.
std::vector<std::vector<Vec2>> folds_in(const std::string& svg, const std::string& path) {
    std::vector<std::vector<Vec2>> folds;
    const std::string start = "<g class=\"fold\" data-path=\"" + path + "\"";
    for (std::size_t group = svg.find(start); group != std::string::npos;
         group = svg.find(start, group + 1)) {
        const std::size_t end = svg.find("</g>", group);
        for (std::size_t at = svg.find("d=\"M", group); at < end; at = svg.find("d=\"M", at + 1)) {
            std::string numbers = svg.substr(at + 4, svg.find('"', at + 4) - at - 4);
            std::replace(numbers.begin(), numbers.end(), 'L', ' ');
            std::stringstream in(numbers);
            folds.emplace_back();
            for (Vec2 p; in >> p.x >> p.y;) folds.back().push_back(p);
        }
    }
    return folds;
}

double distance(const Vec2& p, const std::vector<std::vector<Vec2>>& lines) {
    double nearest = 1e9;
    for (const std::vector<Vec2>& line : lines)
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const Vec2 along = line[i + 1] - line[i];
            const double u =
                std::clamp(dot(p - line[i], along) / std::max(dot(along, along), 1e-300), 0.0, 1.0);
            nearest = std::min(nearest, length(p - line[i] - u * along));
        }
    return nearest;
}

void check_folds(const Scene& scene, const std::string& path) {
    const LineDrawing drawing = Renderer(scene).draw_lines({}, {.wire = false, .folds = true});
    const auto folds = folds_in(drawing.svg, path);
    const TurningTruth truth(scene, path);

    std::size_t points = 0, on_turn = 0;
    for (const std::vector<Vec2>& fold : folds)
        for (const Vec2& p : fold) {
            ++points;
            on_turn += truth.turns_near(p, 0.5);
        }
    const std::vector<Vec2> turns = truth.turns();
    std::vector<double> off;
    for (const Vec2& turn : turns) off.push_back(distance(turn, folds));
    std::sort(off.begin(), off.end());
    REQUIRE(points > 40);
    REQUIRE(off.size() > 200);
    INFO(path << ": " << points << " points, " << on_turn << " on turns; " << turns.size()
              << " turns, off median " << off[off.size() / 2] << " p95 " << off[off.size() * 95 / 100]
              << " most " << off.back());
    CHECK(on_turn * 100 >= points * 98);
    CHECK(off[off.size() / 2] < 0.1);
    CHECK(off[off.size() * 95 / 100] < 0.5);
}

}  // namespace

TEST_CASE("folds drawn through glass and in a mirror are where the truth's Jacobian changes its sign",
          "[laws][oracle][law]") {
    // A wall inside the caustic of a ball lens.
    check_folds(before_wall(Primitive{}, true, -1.4, {0, 0.2, 4.2}), "refract");

    // A concave mirror that throws the image of an eye beside its axis about on the wall behind the camera.
    Primitive bowl;
    bowl.kind = ParaboloidPrimitive{.radius = 1.5, .focal_length = 2.6};
    bowl.center = {0, 0, -1};
    bowl.axis = {0, 0, 1};
    Scene scene = before_wall(bowl, false, 4.5, {0.9, 0.4, 4});
    scene.render.max_depth = 0;
    check_folds(scene, "reflect");
}

TEST_CASE("flat and convex mirrors have no folds, and none are drawn that nobody asked for", "[laws][law]") {
    Scene ball = before_wall(Primitive{}, false, 6, {0, 0.2, 4});
    CHECK(Renderer(ball).draw_lines({}, {.folds = true}).folds == 0);
    Primitive flat;
    flat.kind = PlanePrimitive();
    flat.axis = {0, 0, 1};
    CHECK(Renderer(before_wall(flat, false, 6, {0, 0.2, 4})).draw_lines({}, {.folds = true}).folds == 0);
    const LineDrawing plain = Renderer(before_wall(Primitive{}, true, -1.4, {0, 0.2, 4.2})).draw_lines({});
    CHECK(plain.folds == 0);
    CHECK(plain.svg.find("class=\"fold\"") == std::string::npos);
}

namespace {

/// Dense points of the conics in an SVG's data-conic attributes, one list for each curve.
std::vector<std::vector<Vec2>> conics_in(const std::string& svg) {
    std::vector<std::vector<Vec2>> curves;
    const std::string name = "data-conic=\"";
    for (std::size_t at = svg.find(name); at != std::string::npos; at = svg.find(name, at + 1)) {
        const std::size_t first = at + name.size();
        std::string text = svg.substr(first, svg.find('"', first) - first);
        std::replace(text.begin(), text.end(), ';', ' ');
        std::istringstream in(text);
        std::vector<Vec2> points;
        Vec2 a, b, c;
        double w = 0;
        while (in >> a.x >> a.y >> b.x >> b.y >> c.x >> c.y >> w)
            for (int i = 0; i <= 40; ++i) {
                const double u = i / 40.0, v = 1 - u;
                const double of_a = v * v, of_b = 2 * u * v * w, of_c = u * u;
                points.push_back((of_a * a + of_b * b + of_c * c) / (of_a + of_b + of_c));
            }
        curves.push_back(points);
    }
    return curves;
}

/// How far a point is from the border of the square |x|, |y| <= half.
double off_border(const Vec3& p, double half) {
    return std::fabs(std::max(std::fabs(p.x), std::fabs(p.y)) - half);
}

}  // namespace

TEST_CASE("edges as polygonal lines follow the exact conics, and what rays of theirs meet lies on the edge",
          "[laws][oracle][law]") {
    // A square behind a mirror ball, and a larger one behind the eye, which the ball shows.
    Scene scene = before_wall(Primitive{}, false, 6, {1.6, 1.1, 3.2});
    scene.film = {640, 480, 1};
    for (Vec3& p : scene.meshes[1].object.points) p = {p.x / 40, p.y / 40, 4.4};
    Mesh behind = scene.meshes[1];
    behind.name = "behind";
    for (Vec3& p : behind.object.points) p = {0.8 * p.x, 0.8 * p.y, -1.4};
    scene.meshes.push_back(behind);
    const Renderer renderer(scene);
    // Through coarse facets, whose conics are curved; the SVG has them in another order.
    const LineDrawing coarse = renderer.draw_lines({0, 2});
    const auto conics = conics_in(coarse.svg);
    REQUIRE(coarse.edge_lines.size() == coarse.curves);
    REQUIRE(conics.size() == coarse.curves);
    std::vector<std::vector<Vec2>> lines;
    for (const EdgeLine& edge : coarse.edge_lines) lines.push_back(edge.points);
    const auto most = std::max_element(lines.begin(), lines.end(),
                                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
    REQUIRE(most->size() > 4);
    double worst = 0;
    for (const std::vector<Vec2>& conic : conics)
        for (const Vec2& p : conic) worst = std::max(worst, distance(p, lines));
    CHECK(worst <= kEdgeTolerance);
    worst = 0;
    for (const std::vector<Vec2>& line : lines)
        for (const Vec2& p : line) worst = std::max(worst, distance(p, conics));
    CHECK(worst <= 0.02);  // between dense points

    const LineDrawing drawing = renderer.draw_lines({});
    const Camera camera = make_camera(scene.cameras[0], {640, 480});
    std::size_t direct = 0, mirrored = 0;
    std::vector<double> off;
    for (const EdgeLine& edge : drawing.edge_lines) {
        if (edge.path == "direct" && edge.object == 2) {
            CHECK(edge.optic == kNone);
            for (const Vec2& p : edge.points) {
                const Ray ray = *exact_ray(camera, p);
                const Vec3 at = ray.origin + (-1.4 - ray.origin.z) / ray.direction.z * ray.direction;
                CHECK(off_border(at, 1.2) < 1e-6);
                ++direct;
            }
        } else if (edge.path == "reflect" && edge.object == 1) {
            CHECK(edge.optic == 0);
            const ShotRays shots = renderer.shoot(edge.points);
            for (const ShotRay& shot : shots.rays)
                if (shot.object == 1) off.push_back(off_border(shot.position, 1.5));
            mirrored += edge.points.size();
        }
    }
    CHECK(direct >= 8);
    REQUIRE(mirrored > 40);
    // Half of them pass by on the other side of the border.
    REQUIRE(off.size() > mirrored / 5);
    std::sort(off.begin(), off.end());
    CHECK(off[off.size() / 2] < 0.01);
    CHECK(off.back() < 0.1);
}
