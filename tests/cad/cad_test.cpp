// STEP and IGES files, written here by OpenCASCADE of shapes whose closed forms are known: what is read of
// them, and the rays that the scenes made of them send.
#include <trilens/render.h>
#include <trilens/scene.h>

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>

#include <cmath>
#include <numbers>
#include <random>

#include "cad_files.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Numbers between two bounds, the same ones always.
struct Draw {
    std::mt19937 engine{1};
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0);
    }
};

/// By the Cox-de Boor recurrence, straight from its definition.
double basis(const std::vector<double>& knots, std::size_t i, int degree, double t) {
    if (degree == 0) {
        const bool is_last = t == knots.back() && knots[i] < knots[i + 1] && knots[i + 1] == knots.back();
        return (knots[i] <= t && t < knots[i + 1]) || is_last ? 1 : 0;
    }
    double sum = 0;
    const auto p = static_cast<std::size_t>(degree);
    if (knots[i + p] > knots[i])
        sum += (t - knots[i]) / (knots[i + p] - knots[i]) * basis(knots, i, degree - 1, t);
    if (knots[i + p + 1] > knots[i + 1])
        sum +=
            (knots[i + p + 1] - t) / (knots[i + p + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, t);
    return sum;
}

/// At shares u, v of the range between as many knots as the degree at either end.
Vec3 at(const CadSurface& surface, double u, double v) {
    const auto place = [&](std::size_t k, double share) {
        const std::vector<double>& knots = surface.knots[k];
        const auto degree = static_cast<std::size_t>(surface.degree[k]);
        return knots[degree] + share * (knots[knots.size() - 1 - degree] - knots[degree]);
    };
    const double s = place(0, u), t = place(1, v);
    Vec3 sum(0);
    double weights = 0;
    const auto columns = static_cast<std::size_t>(surface.columns);
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
        const double weight = surface.weights[i] *
                              basis(surface.knots[0], i % columns, surface.degree[0], s) *
                              basis(surface.knots[1], i / columns, surface.degree[1], t);
        sum += weight * surface.points[i];
        weights += weight;
    }
    return sum / weights;
}

/// Of its front, by differences: with the length of the surface's element.
Vec3 front(const CadSurface& surface, double u, double v) {
    constexpr double kStep = 1e-6;
    return cross(at(surface, u + kStep, v) - at(surface, u - kStep, v),
                 at(surface, u, v + kStep) - at(surface, u, v - kStep)) /
           (4 * kStep * kStep);
}

/// By the middles of 64 x 64 squares.
double area_of(const std::vector<CadFace>& faces) {
    constexpr int kSquares = 64;
    double sum = 0;
    for (const CadFace& face : faces)
        for (const CadSurface& surface : face.surfaces)
            for (int i = 0; i < kSquares * kSquares; ++i)
                sum +=
                    length(front(surface, (i % kSquares + 0.5) / kSquares, (i / kSquares + 0.5) / kSquares)) /
                    (kSquares * kSquares);
    return sum;
}

/// Within fronts that look outwards, by the divergence theorem on the same squares.
double volume_of(const std::vector<CadFace>& faces) {
    constexpr int kSquares = 64;
    double sum = 0;
    for (const CadFace& face : faces)
        for (const CadSurface& surface : face.surfaces)
            for (int i = 0; i < kSquares * kSquares; ++i) {
                const double u = (i % kSquares + 0.5) / kSquares, v = (i / kSquares + 0.5) / kSquares;
                sum += dot(at(surface, u, v), front(surface, u, v)) / (3 * kSquares * kSquares);
            }
    return sum;
}

/// Towards their front, as long as their area.
Vec3 across(const CadFace& face, const std::array<int, 3>& triangle) {
    const auto p = [&](int k) {
        return face.points[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    return 0.5 * cross(p(1) - p(0), p(2) - p(0));
}

double area_of_triangles(const CadFace& face) {
    double sum = 0;
    for (const std::array<int, 3>& triangle : face.triangles) sum += length(across(face, triangle));
    return sum;
}

TopoDS_Face flat_face(const std::vector<gp_Pnt>& corners) {
    BRepBuilderAPI_MakePolygon polygon;
    for (const gp_Pnt& corner : corners) polygon.Add(corner);
    polygon.Close();
    return BRepBuilderAPI_MakeFace(polygon.Wire());
}

/// A flat face, then a sphere's cap towards +z, and a cylinder between: a solid about the z axis.
TopoDS_Shape plano_convex(double radius, double rim, double edge) {
    const double sag = radius - std::sqrt(radius * radius - rim * rim);
    const gp_Pnt middle(0, 0, 0), flat(rim, 0, 0), bend(rim, 0, edge), vertex(0, 0, edge + sag);
    const double half = 0.5 * std::asin(rim / radius), center = edge + sag - radius;
    const gp_Pnt between(radius * std::sin(half), 0, center + radius * std::cos(half));
    BRepBuilderAPI_MakeWire profile(
        BRepBuilderAPI_MakeEdge(middle, flat).Edge(), BRepBuilderAPI_MakeEdge(flat, bend).Edge(),
        BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(bend, between, vertex).Value()).Edge(),
        BRepBuilderAPI_MakeEdge(vertex, middle).Edge());
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(profile.Wire()), gp::OZ()).Shape();
}

}  // namespace

TEST_CASE("a ball of a STEP or IGES file is one, whole and outwards", "[cad][oracle]") {
    const Vec3 center(3, -2, 5);
    const gp_Ax2 frame(gp_Pnt(center.x, center.y, center.z), gp_Dir(1, 2, 3));
    for (const std::string name : {"ball.step", "ball.iges"}) {
        CAPTURE(name);
        const std::vector<CadBody> bodies = read_back(BRepPrimAPI_MakeSphere(frame, 4).Solid(), name);
        REQUIRE(bodies.size() == 1);
        CHECK(bodies[0].is_solid == (name == "ball.step"));
        REQUIRE(bodies[0].faces.size() == 1);
        const CadFace& face = bodies[0].faces[0];
        CHECK(face.covered == 1);
        REQUIRE(face.surfaces.size() == 1);
        Draw draw;
        double off = 0;
        for (int i = 0; i < 200; ++i) {
            const double u = draw.uniform(0.01, 0.99), v = draw.uniform(0.01, 0.99);
            const Vec3 from_center = at(face.surfaces[0], u, v) - center;
            off = std::max(off, std::fabs(length(from_center) - 4));
            CAPTURE(u, v);
            CHECK(dot(front(face.surfaces[0], u, v), from_center) > 0);
        }
        CHECK(off < 1e-9);
        for (const std::array<int, 3>& triangle : face.triangles)
            CHECK(dot(across(face, triangle), face.points[static_cast<std::size_t>(triangle[0])] - center) >
                  0);
        CHECK(std::fabs(area_of(bodies[0].faces) / (64 * std::numbers::pi) - 1) < 1e-3);
        CHECK(std::fabs(area_of_triangles(face) / (64 * std::numbers::pi) - 1) < 0.02);
    }
}

TEST_CASE("flat faces of any outline that is seen from their middle are all of their surfaces",
          "[cad][oracle]") {
    struct Flat {
        const char* name;
        TopoDS_Shape shape;
        double area;
        std::size_t surfaces;
    };
    const gp_Circ wide(gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(0, 1, 1)), 5), narrow(wide.Position(), 2);
    const TopoDS_Wire rim = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(wide).Edge());
    TopoDS_Wire hole = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(narrow).Edge());
    hole.Reverse();
    const double pi = std::numbers::pi;
    const std::vector<Flat> all{
        {"square.step", flat_face({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}}), 6, 1},
        {"triangle.step", flat_face({{0, 0, 1}, {4, 0, 1}, {0, 3, 1}}), 6, 3},
        {"ell.step", flat_face({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {2, 2, 0}, {2, 3, 0}, {0, 3, 0}}), 8, 6},
        {"disk.step", BRepBuilderAPI_MakeFace(rim), 25 * pi, 1},
        {"ring.step", BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeFace(rim).Face(), hole), 21 * pi, 1}};
    for (const Flat& flat : all)
        for (const bool is_turned : {false, true}) {
            CAPTURE(flat.name, is_turned);
            const std::vector<CadBody> bodies =
                read_back(is_turned ? flat.shape.Reversed() : flat.shape, flat.name);
            REQUIRE(bodies.size() == 1);
            REQUIRE(bodies[0].faces.size() == 1);
            const CadFace& face = bodies[0].faces[0];
            CHECK(face.covered == 1);
            CHECK(face.surfaces.size() == flat.surfaces);
            CHECK(std::fabs(area_of(bodies[0].faces) / flat.area - 1) < 1e-3);
            for (const CadSurface& surface : face.surfaces)
                CHECK(dot(front(surface, 0.3, 0.4), across(face, face.triangles[0])) > 0);
        }
}

TEST_CASE("a trimmed face says so, and keeps its trims as triangles", "[cad]") {
    // A bent sheet of which a disk is cut out.
    TColgp_Array2OfPnt points(1, 8, 1, 8);
    for (int i = 1; i <= 8; ++i)
        for (int j = 1; j <= 8; ++j) points(i, j) = gp_Pnt(i, j, 0.05 * (i - 4) * (i - 4));
    const Handle(Geom_BSplineSurface) sheet = GeomAPI_PointsToBSplineSurface(points).Surface();
    const BRepBuilderAPI_MakeFace whole(sheet, 1e-6);
    const std::vector<CadBody> uncut = read_back(whole.Face(), "sheet.step");
    CHECK(uncut.at(0).faces.at(0).covered == 1);
    double u0, u1, v0, v1;
    sheet->Bounds(u0, u1, v0, v1);
    const TopoDS_Face half = BRepBuilderAPI_MakeFace(sheet, u0, 0.5 * (u0 + u1), v0, v1, 1e-6);
    // A part between parameters is a surface of its own, and whole.
    CHECK(read_back(half, "half.step").at(0).faces.at(0).covered == 1);
    CHECK(scene_of_cad({uncut, {}}, asked("sheet.step")).warnings.empty());

    const gp_Ax2 through(gp_Pnt(4, 4, -5), gp::DZ());
    const TopoDS_Shape cut =
        BRepAlgoAPI_Cut(whole.Face(), BRepPrimAPI_MakeCylinder(through, 1.5, 20).Solid()).Shape();
    for (const std::string name : {"cut.step", "cut.iges"}) {
        CAPTURE(name);
        const std::vector<CadBody> bodies = read_back(cut, name);
        REQUIRE(bodies.size() == 1);
        REQUIRE(bodies[0].faces.size() == 1);
        const CadFace& face = bodies[0].faces[0];
        const double all = area_of(bodies[0].faces);
        // The disk, seen from above, is nearly as large on the sheet, which lies flat there.
        CHECK(std::fabs((1 - face.covered) * all / (2.25 * std::numbers::pi) - 1) < 0.05);
        CHECK(std::fabs(area_of_triangles(face) / (face.covered * all) - 1) < 0.01);
        const CadScene made = scene_of_cad({bodies, {}}, asked(name));
        REQUIRE(made.warnings.size() == 1);
        CHECK(made.warnings[0].find("is trimmed to 8") != std::string::npos);
        CadOptions as_object = asked(name);
        as_object.mirrors = {"lid"};
        std::vector<CadBody> two = bodies;
        two.push_back(read_back(BRepPrimAPI_MakeBox(1, 1, 1).Solid(), "box.step")[0]);
        two[1].name = "lid";
        CHECK(scene_of_cad({two, {}}, as_object).warnings.empty());
    }
}

TEST_CASE("solids whose files overstep the parameters of their surfaces by rounding are whole glass",
          "[cad][oracle]") {
    struct Solid {
        const char* name;
        TopoDS_Shape shape;
        double volume;
    };
    const double pi = std::numbers::pi;
    const TopoDS_Shape box = BRepPrimAPI_MakeBox(8, 6, 4).Shape();
    BRepFilletAPI_MakeFillet fillet(box);
    for (TopExp_Explorer at(box, TopAbs_EDGE); at.More(); at.Next())
        fillet.Add(1, TopoDS::Edge(at.Current()));
    const TopoDS_Shape rounded_box = fillet.Shape();
    const TopoDS_Shape low = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, -8), 10).Shape(),
                       high = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 8), 10).Shape();
    const std::vector<Solid> all{
        {"frustum.step", BRepPrimAPI_MakeCone(5, 2, 10).Shape(), 130 * pi},
        {"cone.step", BRepPrimAPI_MakeCone(5, 0, 10).Shape(), 250 * pi / 3},
        {"biconvex.step", BRepAlgoAPI_Common(low, high).Shape(), 2 * 4 * 28 * pi / 3},
        {"rounded box.step", rounded_box, 6 * 4 * 2 + 2 * (6 * 4 + 4 * 2 + 2 * 6) + 12 * pi + 4 * pi / 3}};
    for (const Solid& solid : all) {
        CAPTURE(solid.name);
        const std::vector<CadBody> bodies = read_back(solid.shape, solid.name);
        REQUIRE(bodies.size() == 1);
        for (const CadFace& face : bodies[0].faces) {
            CHECK(face.fault.empty());
            CHECK(face.covered == 1);
        }
        CHECK(std::fabs(volume_of(bodies[0].faces) / solid.volume - 1) < 1e-3);
        CadOptions options = asked(solid.name);
        options.glass = {"*"};
        const CadScene made = scene_of_cad({bodies, {}}, options);
        CHECK(made.warnings.empty());
        // No edge of its patches is open.
        CHECK(parse_scene(made.text).warnings == std::vector<std::string>{});
    }
}

TEST_CASE("a face that ends on its axis within its meridian's parameters has its pole", "[cad][oracle]") {
    // The lower half of an ellipsoid, under a disk: its meridian begins at the rim.
    const gp_Elips ellipse(gp_Ax2(gp_Pnt(0, 0, 9), gp::DY(), gp::DX()), 9, 6);
    const gp_Pnt pole(0, 0, 3), middle(0, 0, 9), rim(9, 0, 9);
    BRepBuilderAPI_MakeWire profile(BRepBuilderAPI_MakeEdge(ellipse, 0, std::numbers::pi / 2).Edge(),
                                    BRepBuilderAPI_MakeEdge(pole, middle).Edge(),
                                    BRepBuilderAPI_MakeEdge(middle, rim).Edge());
    const TopoDS_Shape bowl =
        BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(profile.Wire()), gp::OZ()).Shape();
    const std::vector<CadBody> bodies = read_back(bowl, "bowl.step");
    REQUIRE(bodies.size() == 1);
    REQUIRE(bodies[0].faces.size() == 2);
    const double volume = 324 * std::numbers::pi;
    CHECK(std::fabs(volume_of(bodies[0].faces) / volume - 1) < 1e-3);
    double by_triangles = 0;
    for (const CadFace& face : bodies[0].faces) {
        CHECK(face.covered == 1);
        for (const std::array<int, 3>& triangle : face.triangles)
            by_triangles +=
                dot(across(face, triangle), face.points[static_cast<std::size_t>(triangle[0])]) / 3;
    }
    CHECK(std::fabs(by_triangles / volume - 1) < 0.02);
    CadOptions options = asked("bowl.step");
    options.glass = {"*"};
    CHECK(parse_scene(scene_of_cad({bodies, {}}, options).text).warnings == std::vector<std::string>{});
}

TEST_CASE("a lens of a STEP file refracts as the prescription's primitive does", "[cad][law]") {
    const double radius = 30, rim = 10, edge = 2;
    const std::string file = written(plano_convex(radius, rim, edge), "lens.step");
    CadOptions options = asked(file);
    options.glass = {"*"};
    options.ior = 1.6;
    const CadScene made = scene_of_cad(read_cad_file(file, 1e-3), options);
    CHECK(made.glass == 1);
    CHECK(made.warnings.empty());
    const Scene scene = parse_scene(made.text);
    // No edge of its patches is open.
    CHECK(scene.warnings == std::vector<std::string>{});
    const double sag = radius - std::sqrt(radius * radius - rim * rim);
    const std::string prescribed =
        R"({"version": 1, "cameras": [{"lookAt": {"eye": [0, 0, 90], "at": [0, 0, 0]}}],
        "materials": [{"name": "glass", "transmissionFactor": 1, "ior": 1.6}],
        "meshes": [{"name": "lens", "role": "optic", "material": "glass", "primitive": {"type": "lens",
            "center": [0, 0, 0], "axis": [0, 0, 1], "thickness": )" +
        std::to_string(edge + sag) +
        R"(, "front": {"aperture": 10}, "back": {"radius": -30, "aperture": 10}}}]})";
    const Renderer by_file(scene), by_numbers(parse_scene(prescribed));
    Draw draw;
    std::vector<Ray> rays;
    for (int i = 0; i < 300; ++i) {
        const Vec3 to(draw.uniform(-9, 9), draw.uniform(-9, 9), 1),
            from(draw.uniform(-4, 4), draw.uniform(-4, 4), 60);
        rays.push_back({from, normalize(to - from)});
    }
    ShootRequest request;
    request.path = EventWord("TT");
    const ShotRays a = by_file.shoot(rays, request), b = by_numbers.shoot(rays, request);
    std::size_t through = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        REQUIRE(a.rays[i].followed() == b.rays[i].followed());
        if (!a.rays[i].followed()) continue;
        ++through;
        // The thickness is written with six digits.
        CHECK(length(a.rays[i].direction - b.rays[i].direction) < 1e-6);
        CHECK(length(a.rays[i].origin - b.rays[i].origin) < 1e-5);
    }
    CHECK(through > 200);
}
