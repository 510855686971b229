// What callers hand to the public functions: errors come of it where it is no data, and nothing else does.
#include "support/callers_data.h"
#include <fstream>

#include "study/sweep_subjects.h"
#include "support/test.h"
#include "trilens/odd_images.h"
#include "trilens/trilens.h"
#include "vector/caustic.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Scene callers_scene() {
    return parse_scene(scene_examples()[0].json, "",
                       std::vector<SceneOverride>{{"/film/width", "16"}, {"/film/height", "12"}});
}

PictureRequest picture_of(const FrameParams& frame, const EngineChoice& engine = {}) {
    PictureRequest request;
    request.frame = frame, request.engine = engine;
    return request;
}

}  // namespace

TEST_CASE("numbers and texts that are none are refused or written", "[trilens][bad-input]") {
    for (const double x : kOddNumbers) {
        for (const int n : kOddInts) {
            only_errors("fixed_text", [&] { fixed_text(x, n); });
            only_errors("rounded_text", [&] { rounded_text(x, n); });
        }
        only_errors("shortest_text", [&] { shortest_text(x); });
        const ToneMapping tone{x, ToneCurve::kReinhard, x};
        only_errors("tone_mapped", [&] { tone_mapped(Vec3(x), tone); });
        only_errors("check_tone_mapping", [&] { check_tone_mapping(tone); });
        only_errors("encode_image_as", [&] { encode_image_as(small_image(), ImageFormat::kPng, tone); });
        only_errors("fit_power_law", [&] {
            fit_power_law(std::vector<FitPoint>{{x, 1}, {2, x}, {4, 1}, {8, 0.1}}, {x, true});
        });
        only_errors("student_t", [&] { student_t(3, x); });
        const std::vector<std::vector<unsigned char>> pictures{{}, {1, 2}};
        only_errors("encode_apng", [&] { encode_apng(pictures, x); });
        only_errors("encode_apng", [&] { encode_apng({}, x); });
    }
    CHECK(fixed_text(0.5, 1000).size() == 102);
    CHECK(rounded_text(0.1, 1000) == rounded_text(0.1, 17));
    for (const int n : {0, -1, -2147483647 - 1}) CHECK_THROWS_AS(student_t(n, 0.95), UsageError);
    only_errors("fit_power_law", [] { fit_power_law({}); });
    for (const std::string& text : kOddTexts) {
        only_errors("tone_curve", [&] { tone_curve(text); });
        only_errors("escape_markup", [&] { escape_markup(text); });
        only_errors("json_text", [&] { json_text(text); });
        only_errors("csv_text", [&] { csv_text(text); });
        only_errors("latex_text", [&] { latex_text(text); });
        only_errors("suggestion", [&] { suggestion(text, kOddTexts); });
        only_errors("one_line", [&] { one_line(text); });
        only_errors("shell_quoted", [&] { shell_quoted(text); });
        only_errors("parse_point", [&] { parse_point(text); });
        only_errors("parse_points", [&] { parse_points(text, text); });
        only_errors("parse_numbers", [&] { parse_numbers(text, text, {2, text, text}); });
        only_errors("find_numbers", [&] { find_numbers(callers_scene(), std::vector{text}); });
        only_errors("scene_with", [&] { scene_with(callers_scene(), {text, 1}); });
        only_errors("is_same_scene", [&] { is_same_scene(callers_scene(), text); });
        only_errors("require_distinct_names", [&] { require_distinct_names(std::vector{text, text}); });
        only_errors("parse_frames", [&] { parse_frames(text); });
        only_errors("frame_file", [&] { frame_file(text, -2147483647 - 1); });
        only_errors("find_engine", [&] { find_engine(text); });
        only_errors("matches_pattern", [&] { matches_pattern(text, text, {text}); });
        only_errors("has_this_platform", [&] { has_this_platform({text}); });
        for (const auto& read : std::vector<std::pair<const char*, void (*)(const std::string&)>>{
                 {"read_points", [](const std::string& f) { read_points(f); }},
                 {"read_numbers", [](const std::string& f) { read_numbers(f, {}); }},
                 {"read_image", [](const std::string& f) { read_image(f); }},
                 {"read_image_parts", [](const std::string& f) { read_image_parts(f); }},
                 {"read_compared_image", [](const std::string& f) { read_compared_image(f, f); }},
                 {"read_whole_file", [](const std::string& f) { read_whole_file(f); }},
                 {"check_writable", [](const std::string& f) { check_writable(f, {f}); }},
                 {"load_scene", [](const std::string& f) { load_scene(SceneRequest{f, {}, -1}); }},
                 {"parse_scene", [](const std::string& f) { parse_scene(f, f, {}, f); }},
                 {"read_sweep_file", [](const std::string& f) { read_sweep_file(f, {}); }},
                 {"is_sweep_file", [](const std::string& f) { is_sweep_file(f); }},
                 {"is_whole_sweep", [](const std::string& f) { is_whole_sweep(f); }},
                 {"require_no_sweep", [](const std::string& f) { require_no_sweep(f); }},
                 {"load_sweep", [](const std::string& f) { load_sweep(f); }},
                 {"list_suite", [](const std::string& f) { list_suite({f}, f); }},
                 {"meant_tests", [](const std::string& f) { meant_tests({f}, f); }},
                 {"find_tests", [](const std::string& f) { find_tests({f}); }}})
            // What is no file of ours: the folder that the program runs in is one to search, and is passed
            // over.
            if (text != ".." || std::string(read.first).find("s") == std::string::npos)
                only_errors(read.first, [&] { read.second(text); });
    }
    only_errors("base64_text", [] { base64_text({}); });
    only_errors("engine_names", [] { engine_names(); });
    only_errors("layer_names", [] { layer_names(); });
    only_errors("summary_schema", [] { summary_schema(), sweep_schema(), test_schema(); });
    only_errors("scene_schema", [] { scene_schema(); });
    only_errors("version", [] { version(), library_versions(), this_platform(), farm_systems(); });
    for (const int n : {-2147483647 - 1, -1}) {
        only_errors("set_threads", [&] { set_threads(n); });
        CHECK(threads() >= 1);
    }
    set_threads(0);
}

TEST_CASE("scenes that are none are refused by all that takes scenes", "[trilens][bad-input]") {
    std::vector<Scene> all(1);
    const auto add = [&](const auto& change) { change(all.emplace_back(callers_scene())); };
    add([](Scene&) {});
    for (const char* text : {"{", "[]", "3", "{\"animation\":3}", "{\"meshes\":[]}"})
        add([&](Scene& scene) { scene.resolved = text; });
    add([](Scene& scene) { scene.resolved.clear(); });
    add([](Scene& scene) { scene.cameras.clear(); });
    add([](Scene& scene) { scene.meshes.clear(); });
    add([](Scene& scene) { scene.materials.clear(); });
    add([](Scene& scene) { scene.own_camera = 99; });
    for (const double x : kOddNumbers) {
        add([&](Scene& scene) { scene.cameras[0].eye = Vec3(x); });
        add([&](Scene& scene) { scene.cameras[0].at = Vec3(1, x, 0), scene.cameras[0].up = Vec3(x, 1, 0); });
        add([&](Scene& scene) { scene.lights.assign(1, {}), scene.lights[0].intensity = x; });
        add([&](Scene& scene) { scene.materials[0].ior = x; });
        add([&](Scene& scene) { scene.render.max_error = x; });
    }
    for (Mesh& mesh : all[1].meshes) {
        const auto index = static_cast<std::size_t>(&mesh - all[1].meshes.data());
        add([&](Scene& scene) { scene.meshes[index].material = 77; });
        add([&](Scene& scene) { scene.meshes[index].primitive.reset(); });
        add([&](Scene& scene) { scene.meshes[index].role = Role::kOptic; });
        add([&](Scene& scene) { scene.meshes[index].role = Role::kObject; });
        add([&](Scene& scene) { scene.meshes[index].object.triangles.push_back({0, 1, kNone}); });
        add([&](Scene& scene) { scene.meshes[index].cage.crease_lengths = {3}; });
        for (const double x : kOddNumbers)
            add([&](Scene& scene) {
                if (scene.meshes[index].primitive) scene.meshes[index].primitive->kind = SpherePrimitive{x};
            });
    }
    const Warn quiet = [](const std::string&) {};
    for (const Scene& scene : all) {
        only_errors("check_scene", [&] { check_scene(scene); });
        only_errors("make_scene_info", [&] { make_scene_info(scene); });
        only_errors("find_animation", [&] { find_animation(scene); });
        only_errors("find_camera", [&] { find_camera(scene, ""), find_camera(scene, "nobody"); });
        only_errors("scene_title", [&] { scene_title(scene); });
        for (const double x : kOddNumbers) {
            only_errors("scene_at_frame", [&] { scene_at_frame(scene, x); });
            only_errors("scene_on_turntable", [&] { scene_on_turntable(scene, x, 0, 4); });
        }
        only_errors("load_frame", [&] { load_frame(scene, 0, {}, {}); });
        for (const int n : kOddInts) {
            only_errors("turntable", [&] { turntable(scene, 0, n, n); });
            only_errors("turntable", [&] { turntable(scene, 99, 1, n); });
            Scene changed = scene;
            only_errors("set_resolution", [&] { set_resolution(changed, n); });
        }
        Scene changed = scene;
        only_errors("set_resolution", [&] { set_resolution(changed, 2); });
        only_errors("Renderer", [&] {
            Renderer(scene, quiet).draw(picture_of({find_camera(scene, ""), 2}), {}, quiet);
        });
    }
    CHECK_THROWS_AS(turntable(callers_scene(), 0, 1, 0), UsageError);
    CHECK_THROWS_AS(make_scene_info(Scene()), InputError);
    for (const std::string& text : kOddTexts) {
        only_errors("load_scene_text", [&] { load_scene_text(text, SceneSource("x"), {}, {}); });
        only_errors("parse_scene", [&] {
            parse_scene(scene_examples()[0].json, "", std::vector<SceneOverride>{{text, text}});
        });
    }
}

TEST_CASE("a renderer refuses requests that are none", "[trilens][bad-input]") {
    const Warn quiet = [](const std::string&) {};
    Renderer renderer(callers_scene(), quiet);
    const std::string written = scratch_dir("renderer_requests") + "/a.exr";
    for (const int n : kOddInts) {
        PictureRequest request;
        request.frame.resolution = 2;
        request.layers = {n, 0, 1 + n % 7, n, {}};
        only_errors("window", [&] { renderer.draw(request, {}, quiet); });
        only_errors("draw_exr", [&] { renderer.draw_exr(request, {}, quiet); });
        only_errors("draw_png", [&] { renderer.draw_png(request, {}, {}, quiet); });
        only_errors("write_exr", [&] { renderer.write_exr(written, request, {}, quiet); });
        request.layers = {};
        only_errors("explain", [&] { renderer.explain(request, n, n); });
        if (n > 1024 || n < 0) {
            const FrameParams frame{0, n};
            only_errors("check", [&] { renderer.check(frame); });
            only_errors("facet_count", [&] { renderer.facet_count(n); });
            only_errors("draw_lines", [&] { renderer.draw_lines(frame, {true, true, true}, quiet); });
            only_errors("project", [&] { renderer.project({}, {frame}); });
        }
        ClassicParams classic;
        classic.pieces = n;
        if (n <= 1 || n > 1024)
            only_errors("classic", [&] { renderer.draw(picture_of({0, 2}, classic), {}, quiet); });
        only_errors("classic_name", [&] { classic_name(classic); });
    }
    for (const double x : kOddNumbers) {
        FrameParams frame{0, 2};
        frame.max_error = x;
        only_errors("max_error", [&] { renderer.draw(picture_of(frame), {}, quiet); });
        only_errors("project", [&] { renderer.project(std::vector<Vec3>{Vec3(x)}); });
        only_errors("seen_triangle", [&] { renderer.seen_triangle({kNone, x, {x, x}}); });
        only_errors("seen_triangle", [&] { renderer.seen_triangle({0, x, {x, x}}); });
    }
    const FrameParams nobody{99, 2};
    CHECK_THROWS_AS(renderer.draw(picture_of(nobody)), UsageError);
    CHECK_THROWS_AS(renderer.explain(picture_of(nobody), 1, 1), UsageError);
    CHECK_THROWS_AS(renderer.draw_lines(nobody), UsageError);
    CHECK_THROWS_AS(renderer.change(Scene()), InputError);
    CHECK(renderer.scene().film.width == 16);
}

TEST_CASE("surfaces refuse cages, primitives and grids that are none", "[trilens][bad-input]") {
    const Warn quiet = [](const std::string&) {};
    Cage plain;
    plain.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    plain.face_vertex_counts = {4};
    plain.face_vertex_indices = {0, 1, 2, 3};
    const auto with_cage = [&](const auto& change) {
        Cage cage = plain;
        change(cage);
        only_errors("make_surface", [&] { make_surface_grid(*make_surface(cage, "", quiet), 2); });
    };
    with_cage([](Cage& cage) { cage = {}; });
    for (const int n : kOddInts) {
        with_cage([&](Cage& cage) { cage.face_vertex_counts = {n}; });
        with_cage([&](Cage& cage) { cage.face_vertex_indices[2] = n; });
        with_cage([&](Cage& cage) {
            cage.crease_indices = {0, n}, cage.crease_lengths = {2}, cage.crease_sharpnesses = {1};
        });
        with_cage([&](Cage& cage) {
            cage.crease_indices = {0, 1}, cage.crease_lengths = {n}, cage.crease_sharpnesses = {1};
        });
        with_cage([&](Cage& cage) { cage.corner_indices = {n}, cage.corner_sharpnesses = {1}; });
        with_cage([&](Cage& cage) { cage.hole_indices = {n}; });
        if (n < 1 || n > 1024)
            only_errors("make_surface_grid", [&] { make_surface_grid(*make_surface(plain), n); });
    }
    for (const double x : kOddNumbers) {
        with_cage([&](Cage& cage) { cage.points[1] = Vec3(x); });
        with_cage([&](Cage& cage) {
            cage.corner_indices = {0}, cage.corner_sharpnesses = {static_cast<float>(x)};
        });
        for (const PrimitiveKind& kind : std::initializer_list<PrimitiveKind>{
                 SpherePrimitive(), ParaboloidPrimitive(), CylinderPrimitive(), ConePrimitive(),
                 PlanePrimitive(), LensPrimitive()})
            for (int field = 0; field < 5; ++field) {
                Primitive odd{.kind = kind};
                if (field == 0) odd.center = Vec3(x);
                if (field == 1) odd.axis = Vec3(x);
                if (field == 2) odd.tangent = Vec3(x);
                int number = 3;  // of a kind's first two lengths
                const auto make_odd = [&](double& length, const char*) {
                    if (field == number++) length = x;
                };
                std::visit([&](auto& one) { for_each_length(one, make_odd); }, odd.kind);
                only_errors("make_surface", [&] { make_surface_grid(*make_surface(odd), 2); });
            }
    }
    with_cage([](Cage& cage) { cage.crease_lengths = {2}; });
    with_cage([](Cage& cage) { cage.corner_sharpnesses = {2}; });
    SurfaceGrid grid = make_surface_grid(*make_surface(plain), 1);
    only_errors("faces_front", [&] { faces_front(grid, grid.facets[0], Vec3(kNaN)); });
    only_errors("lies_before", [&] { lies_before(grid, Vec3(kNaN)); });
}

TEST_CASE("sweeps and suites refuse requests that are none", "[trilens][bad-input]") {
    const std::string folder = scratch_dir("callers_sweeps");
    for (const std::string& text : kOddTexts) {
        only_errors("parse_over", [&] { parse_over(text); });
        only_errors("parse_over", [&] { parse_over("a=" + text); });
        only_errors("pointer_kind", [&] { pointer_kind(text); });
        only_errors("find_axis_kind", [&] { find_axis_kind(text, "here"); });
        only_errors("plan_sweep", [&] {
            SweepRequest request;
            request.loaded = callers_scene();
            request.over = {{text, {text}}};
            request.folder = folder + "/plan";
            plan_sweep(request);
        });
        for (const AxisKind& kind : axis_kinds()) {
            only_errors("make_axis", [&] { make_axis(kind, {kind.name, {text}}, "here"); });
            only_errors("make_axis", [&] {
                make_axis(kind, {kind.name, {text + ".." + text + ":x" + text}}, "here");
            });
            const Coordinates point{{kind.name, {text, {}}}}, huge{{kind.name, {text, 1e300}}};
            only_errors("request_at", [&] { request_at({}, point); });
            only_errors("request_at", [&] { request_at({}, huge); });
            only_errors("point_id", [&] { point_id({{{kind, {}}}, false}, point); });
            only_errors("point_text", [&] { point_text(point); });
            only_errors("find_coordinate", [&] { find_coordinate(point, text); });
        }
        PointRequest of_optic;
        of_optic.scene.file = of_optic.optic = text;
        only_errors("load_point_scene", [&] { load_point_scene(of_optic); });
        only_errors("farm_script", [&] { farm_script({text, -1, text, text, {text}, {}}); });
        only_errors("truth_file", [&] { truth_file(text, text), run_folder(text, text); });
        only_errors("without_axis", [&] { without_axis({}, text); });
        only_errors("find_value", [&] { find_value({}, text); });
    }
    CHECK_THROWS_AS(request_at({}, {{"resolution", {"8", {}}}}), UsageError);
    CHECK_THROWS_AS(make_points({{{axis_kinds()[0], {}}}, false}), UsageError);
    only_errors("make_points", [] { make_points({{}, true}); });
    only_errors("make_axis", [] { make_axis({}, {}, ""); });
    only_errors("report_sweep", [&] { report_sweep(folder + "/none"); });
    only_errors("write_sweep_gallery", [&] { write_sweep_gallery(folder + "/none", {}); });
    only_errors("run_suite", [&] {
        SuiteRequest request;
        request.folders = {folder};
        request.jobs = -3;
        run_suite(request);
    });
    only_errors("run_suite", [] { run_suite(SuiteRequest()); });
}

TEST_CASE("what looks through meshes by itself refuses what does not fit together", "[trilens]") {
    RayMesh mesh = make_camera_mesh(make_perspective({{}, 40, 4, 4}), 4, 4);
    const SampleGrid grid{0, 0, 4, 4, 1};
    const std::vector<Id> facets(16, 0), far(16, 9), few(3, 0);
    const auto nothing = [](const Ray&) { return Hit(); };
    const auto nobody = [](Id) { return Id{0}; };
    only_errors("fold_curves", [&] { fold_curves({mesh, grid, facets, nothing, nobody}); });
    CHECK(refusal([&] { fold_curves({mesh, grid, far, nothing, nobody}); }).rfind("facet: ", 0) == 0);
    CHECK(refusal([&] { fold_curves({mesh, grid, few, nothing, nobody}); }).rfind("facet: ", 0) == 0);
    CHECK_THROWS_AS(fold_curves({mesh, grid, facets, {}, {}}), UsageError);
    CHECK(refusal([&] { caustic_sheets({mesh, {1}, 1}); }).rfind("seen: ", 0) == 0);
    for (const double x : kOddNumbers) {
        only_errors("caustic_sheets", [&] { caustic_sheets({mesh, {}, x}); });
        RayMesh odd = mesh;
        odd.rays[1].direction = Vec3(x);
        only_errors("caustic_sheets", [&] { caustic_sheets({odd, {}, 1}); });
    }
    mesh.facets[0][1] = 44;
    CHECK(refusal([&] { caustic_sheets({mesh, {}, 1}); }).rfind("facets/0: ", 0) == 0);
}
