// What of a CAD file becomes which body: names, units, losses, and files that are none.
#include <trilens/error.h>
#include <trilens/scene.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <fstream>
#include <regex>

#include "cad_files.h"

using namespace trilens;
using namespace trilens_test;

namespace {

TopoDS_Shape two_boxes() {
    BRep_Builder builder;
    TopoDS_Compound both;
    builder.MakeCompound(both);
    builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 2, 3, 4).Solid());
    builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(9, 0, 0), 2, 3, 4).Solid());
    return both;
}

}  // namespace

TEST_CASE("bodies are mirrors, glass and objects by their names", "[cad]") {
    const std::string file = written(BRepPrimAPI_MakeBox(2, 3, 4).Solid(), "box.step");
    std::vector<CadBody> bodies = read_cad_file(file, 1e-3).bodies;
    REQUIRE(bodies.size() == 1);
    bodies[0].name = "box";
    bodies.push_back(bodies[0]);
    bodies.push_back(bodies[0]);
    bodies[2].name = "lid";
    CHECK(scene_of_cad({bodies, {}}, asked(file)).mirrors == 3);
    CadOptions options = asked(file);
    options.mirrors = {"l*"};
    options.glass = {"box"};
    const CadScene made = scene_of_cad({bodies, {}}, options);
    CHECK(made.mirrors == 1);
    CHECK(made.glass == 2);
    CHECK(made.objects == 0);
    const Scene scene = parse_scene(made.text);
    CHECK(scene.warnings == std::vector<std::string>{});
    REQUIRE(scene.meshes.size() == 4);
    CHECK(scene.meshes[1].name == "box (2)");
    options.glass.clear();
    const Scene of_objects = parse_scene(scene_of_cad({bodies, {}}, options).text);
    CHECK(of_objects.warnings == std::vector<std::string>{});
    options.glass = {"nut"};
    CHECK(refusal([&] {
              scene_of_cad({bodies, {}}, options);
          }) == file + ": has no body \"nut\"; it has \"box\", \"box\", \"lid\"");
    options.glass = {"*"};
    CHECK(refusal([&] {
              scene_of_cad({bodies, {}}, options);
          }) == file + ": lid: is to be a mirror and glass");
    options.mirrors.clear();
    bodies[1].is_solid = false;
    CHECK(refusal([&] {
              scene_of_cad({bodies, {}}, options);
          }) == file + ": box: is no solid, which glass must be");
}

TEST_CASE("a STEP file's names, unit and losses are told", "[cad]") {
    std::ifstream in(written(two_boxes(), "both.step"));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    for (const std::string name : {"left", "right"}) {
        const std::size_t unnamed = text.find("MANIFOLD_SOLID_BREP(''");
        REQUIRE(unnamed != std::string::npos);
        text.insert(unnamed + 21, name);
    }
    const auto read = [&](const std::string& changed) {
        std::ofstream(file_named("named.step")) << changed;
        return read_cad_file(file_named("named.step"), 1e-3);
    };
    const CadModel model = read(text);
    REQUIRE(model.bodies.size() == 2);
    CHECK(model.bodies[0].name == "left");
    CHECK(model.bodies[1].name == "right");
    CHECK(model.warnings == std::vector<std::string>{});

    // In metres: a thousand times as large in millimetres.
    std::string metres = text;
    REQUIRE(metres.find("SI_UNIT(.MILLI.,.METRE.)") != std::string::npos);
    for (std::size_t unit; (unit = metres.find("SI_UNIT(.MILLI.,.METRE.)")) != std::string::npos;)
        metres.replace(unit + 8, 7, "$");
    const auto reach = [](const CadModel& of) {
        double most = 0;
        for (const CadBody& body : of.bodies)
            for (const CadFace& face : body.faces)
                for (const Vec3& point : face.points) most = std::max(most, point.x);
        return most;
    };
    CHECK(std::fabs(reach(model) - 11) < 1e-9);
    CHECK(std::fabs(reach(read(metres)) - 11000) < 1e-6);

    // A plane that is nowhere: its face is lost, and said to be.
    const std::size_t plane = text.find("PLANE('',#");
    REQUIRE(plane != std::string::npos);
    std::string lost = text;
    lost.replace(plane + 9, text.find(')', plane) - plane - 9, "$");
    const CadModel less = read(lost);
    REQUIRE(less.warnings.size() == 1);
    CHECK(less.warnings[0] == "1 of 12 faces are left out: OpenCASCADE makes nothing of them");
    CHECK(scene_of_cad(less, asked("a.step")).warnings.at(0) == "a.step: " + less.warnings[0]);

    const std::string point = "CARTESIAN_POINT('',(2.,0.,0.))";
    REQUIRE(text.find(point) != std::string::npos);
    for (const std::string number : {"1.E+31", "1.E+400"}) {
        std::string far = text;
        far.replace(far.find(point), point.size(), "CARTESIAN_POINT('',(" + number + ",0.,0.))");
        CHECK(refusal([&] { read(far); }) == file_named("named.step") + ": goes beyond coordinates of 1e30");
    }
}

TEST_CASE("bodies of a STEP file without names of their own have their parts'", "[cad]") {
    STEPControl_Controller::Init();
    REQUIRE(Interface_Static::SetIVal("write.step.assembly", 1));
    const std::string file = written(two_boxes(), "parts.step");
    REQUIRE(Interface_Static::SetIVal("write.step.assembly", 0));
    // The writer's own names of parts are none.
    CHECK(read_cad_file(file, 1e-3).bodies.at(1).name == "body 2");

    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    std::size_t at = 0;
    for (const std::string name : {"telescope", "primary mirror", "tube"}) {
        at = text.find("= PRODUCT(", at);
        REQUIRE(at != std::string::npos);
        at += 10;
        text.replace(at, text.find(",(", at) - at, "'a part','" + name + "',''");
    }
    const auto names = [](const std::string& changed) {
        std::ofstream(file_named("parts named.step")) << changed;
        std::vector<std::string> found;
        for (const CadBody& body : read_cad_file(file_named("parts named.step"), 1e-3).bodies)
            found.push_back(body.name);
        return found;
    };
    CHECK(names(text) == std::vector<std::string>{"primary mirror", "tube"});
    // As other exporters write it: a part's representation is another one, said to be that of its solid.
    std::smatch solid;
    const std::regex of_solid(R"((#\d+) = ADVANCED_BREP_SHAPE_REPRESENTATION\('',\((#\d+),#\d+\),(#\d+)\);)");
    REQUIRE(std::regex_search(text, solid, of_solid));
    std::string apart = std::regex_replace(text, std::regex("," + solid.str(1) + "([,)])"), ",#90001$1");
    apart.insert(apart.rfind("ENDSEC;"),
                 "#90001 = SHAPE_REPRESENTATION('',(" + solid.str(2) + ")," + solid.str(3) +
                     ");\n#90002 = SHAPE_REPRESENTATION_RELATIONSHIP('','',#90001," + solid.str(1) + ");\n");
    CHECK(names(apart) == std::vector<std::string>{"primary mirror", "tube"});
    // A solid's own name is nearer.
    text.insert(text.find("MANIFOLD_SOLID_BREP('") + 21, "glass blank");
    CHECK(names(text) == std::vector<std::string>{"glass blank", "tube"});
}

TEST_CASE("files that are no CAD files are refused", "[cad][bad-input]") {
    const auto refused = [](const std::string& name, const std::string& text) {
        const std::string file = file_named(name);
        std::ofstream(file) << text;
        return refusal([&] { read_cad_file(file, 1e-3); });
    };
    CHECK(refused("a.obj", "v 0 0 0") ==
          file_named("a.obj") + ": is neither STEP (.step, .stp) nor IGES (.iges, .igs)");
    for (const std::string name : {"a.step", "a.STP", "a.iges", "a.igs"})
        for (const std::string text :
             {"", "garbage", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"}) {
            CAPTURE(name, text);
            CHECK(refused(name, text).starts_with(file_named(name) + ": "));
        }
    CHECK(refusal([] { read_cad_file(file_named("none.step"), 1e-3); }) ==
          file_named("none.step") + ": cannot be read");
    // Cut short at every tenth of its length.
    const std::string file = written(BRepPrimAPI_MakeBox(2, 3, 4).Solid(), "whole.step");
    std::ifstream in(file);
    const std::string all{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t i = 0; i < 10; ++i) {
        CAPTURE(i);
        CHECK_FALSE(refused("short.step", all.substr(0, all.size() * i / 10)).empty());
    }
}
