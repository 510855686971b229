// Line drawings of what stands parallel to the film or to a mirror, exactly and nearly: nothing is lost, and
// nothing jumps.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "laws/line_borders.h"
#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// What looks at the objects, and over what.
struct LineView {
    std::string name;
    CameraKind camera;
    bool spreads = true;  // a pinhole: what is far is small
    std::optional<PrimitiveKind> mirror = std::nullopt;
    int resolution = 1;
};

const double kEyeHeight = 5;  // over the mirror, which lies in z = 0
const std::vector<double> kNearlyStraight{0,    1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9,
                                          1e-8, 1e-7,  1e-6,  1e-5,  1e-4,  1e-3};

std::vector<LineView> line_views() {
    const PlanePrimitive plane{.size = {4.3, 3.1}};
    const CylinderPrimitive column{.radius = 1.7, .height = 3.1};
    const PerspectiveCamera pinhole{.yfov = 40};
    const OrthographicCamera parallel{.ymag = 1.8};
    const FisheyeCamera fisheye{.fov = 60};
    return {{"perspective", pinhole},
            {"orthographic", parallel, false},
            {"oblique", ObliqueCamera{.ymag = 1.8, .scale = 0.1}, false},
            {"fisheye", fisheye},
            {"perspective over one facet pair", pinhole, true, plane, 1},
            {"perspective over many facets", pinhole, true, plane, 16},
            {"orthographic over a mirror", parallel, false, plane, 3},
            {"fisheye over a mirror", fisheye, true, plane, 5},
            {"perspective over a column", pinhole, true, column, 16}};
}

void append_quads(const std::vector<std::array<Id, 4>>& quads, ObjectMesh& object) {
    for (std::size_t q = 0; q < quads.size(); ++q) {
        const auto& [a, b, c, d] = quads[q];
        object.triangles.push_back({a, b, c});
        object.triangles.push_back({a, c, d});
        object.material.insert(object.material.end(), 2, 0);
    }
}

/// A card on the left and a box on the right, at random places, with edges parallel to the film; with an odd
/// seed the camera stands upright.
class StraightScene {
  public:
    explicit StraightScene(unsigned seed) : random_(seed) {
        card_.points = {{-number(1.5, 1.9), -number(0.7, 1.2), 0},
                        {-number(0.3, 0.6), -number(0.7, 1.2), 0},
                        {-number(0.3, 0.6), number(0.7, 1.2), 0},
                        {-number(1.5, 1.9), number(0.7, 1.2), 0}};
        append_quads({{0, 1, 2, 3}}, card_);
        const Vec3 low(number(0.1, 0.5), -number(0.6, 1.1), -number(0.3, 0.8)),
            high(number(1.2, 1.7), number(0.6, 1.1), 0);
        for (int k = 0; k < 8; ++k)
            box_.points.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
        append_quads({{4, 5, 7, 6}, {0, 2, 3, 1}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}},
                     box_);
        const double turn = number(0, 6.28);
        tilt_ = {std::cos(turn), std::sin(turn), 0};
        depth_ = number(4.6, 5.4);
        if (const double lean = number(-0.5, 0.5); seed % 2 == 0) up_ = {std::sin(lean), std::cos(lean), 0};
    }

    Scene seen_by(const LineView& view, double tilt) const {
        Scene scene;
        scene.film = {96, 72, 1};
        CameraDescription camera;
        camera.name = "main", camera.kind = view.camera;
        camera.eye = {0, 0, kEyeHeight}, camera.at = Vec3(0), camera.up = up_;
        scene.cameras = {camera};
        Material plain, chrome;
        plain.unlit = true, chrome.metallic_factor = 1;
        scene.materials = {plain, chrome};
        for (const ObjectMesh* object : {&card_, &box_}) {
            Mesh mesh;
            mesh.name = object == &card_ ? "card" : "box";
            mesh.object = *object;
            for (Vec3& p : mesh.object.points) p = placed(p + Vec3(0, 0, tilt * dot(p, tilt_)), view);
            scene.meshes.push_back(mesh);
        }
        if (!view.mirror) return scene;
        Mesh mirror;
        mirror.name = "mirror", mirror.role = Role::kOptic, mirror.material = 1;
        mirror.resolution = view.resolution, mirror.rays = CornerRays::kInterpolated;
        const bool flat = std::holds_alternative<PlanePrimitive>(*view.mirror);
        mirror.primitive = Primitive{.kind = *view.mirror};
        if (flat) mirror.primitive->axis = {0, 0, 1};
        if (!flat) mirror.primitive->center = {0, 0, -1.7};
        scene.meshes.push_back(mirror);
        return scene;
    }

  private:
    double number(double low, double high) {
        return low + (high - low) * static_cast<double>(random_()) / static_cast<double>(random_.max());
    }

    /// Before the eye, or behind it where a mirror shows it, and then as much larger as it is farther.
    Vec3 placed(const Vec3& p, const LineView& view) const {
        if (!view.mirror) return p + Vec3(0, 0, kEyeHeight - depth_);
        const double far = depth_ + 6, size = view.spreads ? far / depth_ : 1;
        return size * p * Vec3(1, 1, -1) + Vec3(0, 0, far - kEyeHeight);
    }

    std::mt19937 random_;
    ObjectMesh card_, box_;
    Vec3 tilt_{0}, up_{0, 1, 0};
    double depth_ = 5;
};

/// A card behind the eye whose image in a square mirror has two sides on the borders of any even number of
/// facets: along the rows, the columns and, for any number, the diagonal.
Scene on_facet_borders(int resolution) {
    Scene scene;
    scene.film = {96, 72, 1};
    CameraDescription camera;
    camera.name = "main", camera.kind = PerspectiveCamera{.yfov = 40};
    camera.eye = {0, 0, kEyeHeight}, camera.at = Vec3(0);
    scene.cameras = {camera};
    Material plain, chrome;
    plain.unlit = true, chrome.metallic_factor = 1;
    scene.materials = {plain, chrome};
    Mesh card, mirror;
    card.name = "card", mirror.name = "mirror";
    card.object.points = {{0, 0, 6}, {2, 0, 6}, {2, 2, 6}, {0, 2, 6}, {-1, -1, 6}, {-1, -2, 6}};
    append_quads({{0, 1, 2, 3}}, card.object);
    card.object.triangles.push_back({0, 4, 5}), card.object.material.push_back(0);
    mirror.role = Role::kOptic, mirror.material = 1, mirror.resolution = resolution;
    mirror.primitive = Primitive{.axis = {0, 0, 1}, .kind = PlanePrimitive{.size = {3.2, 3.2}}};
    scene.meshes = {card, mirror};
    return scene;
}

}  // namespace

TEST_CASE("every border between objects has a line, however parallel its edge is to the film or a mirror",
          "[laws][vector][law]") {
    for (const LineView& view : line_views())
        for (unsigned seed = 1; seed <= 3; ++seed) {
            const StraightScene scene(seed);
            std::vector<double> tilts = kNearlyStraight;
            tilts.insert(tilts.end(), {0.05, 0.3});
            for (const double tilt : tilts) {
                const Renderer renderer(scene.seen_by(view, tilt));
                const LinedBorders borders = lined_borders(renderer);
                INFO(view.name << ", seed " << seed << ", tilt " << tilt << ": " << borders.without << " of "
                               << borders.count << " without a line, farthest " << borders.farthest);
                REQUIRE(borders.count > 100);
                CHECK(borders.without == 0);
            }
        }
}

TEST_CASE("the length of a drawing's lines changes no more than the scene does", "[laws][vector][law]") {
    for (const LineView& view : line_views())
        for (const bool wire : {false, true})
            for (unsigned seed = 4; seed <= 5; ++seed) {
                const StraightScene scene(seed);
                double straight = 0;
                for (const double tilt : kNearlyStraight) {
                    const LineDrawing drawing =
                        Renderer(scene.seen_by(view, tilt)).draw_lines({}, {.wire = wire});
                    const double whole = length_of(drawing.edge_lines);
                    if (tilt == 0) straight = whole;
                    INFO(view.name << (wire ? ", wire" : "") << ", seed " << seed << ", tilt " << tilt << ": "
                                   << whole << " px, straight on " << straight);
                    REQUIRE(whole > 100);
                    CHECK(std::fabs(whole - straight) <= 2 + 1000 * tilt);
                }
            }
}

TEST_CASE("an edge along the border of facets is drawn once", "[laws][vector][law]") {
    for (const bool wire : {false, true}) {
        double one = 0;
        for (int resolution = 1; resolution <= 8; ++resolution) {
            const std::vector<EdgeLine> lines =
                Renderer(on_facet_borders(resolution)).draw_lines({}, {.wire = wire}).edge_lines;
            const double whole = length_of(lines);
            if (resolution == 1) one = whole;
            INFO(resolution << (wire ? ", wire: " : ": ") << whole << " px, one pair of facets " << one);
            REQUIRE(whole > 200);
            CHECK(std::fabs(whole - one) <= 0.5);
            for (const EdgeLine& line : lines) CHECK(length_of({line}) > 0);
        }
    }
}
