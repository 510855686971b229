// A list of every public function, which keeps the tests of callers' data whole.
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "support/test.h"

using namespace trilens_test;

namespace {

namespace fs = std::filesystem;

/// Functions that no data of a caller's can end, or that other tests hand what is no data: each with why.
const std::map<std::string, std::string> kElsewhere{
    {"explain_pixel", "Renderer::explain"},
    {"project_points", "Renderer::project"},
    {"project_directions", "Renderer::project_directions"},
    {"refine_images", "Renderer::refine"},
    {"shoot_places", "Renderer::shoot"},
    {"shoot_rays", "Renderer::shoot"},
    {"make_optic_surface", "Renderer, of scenes that are no data"},
    {"file_ending", "of any name"},
    {"kind_name", "of any primitive"},
    {"name_of", "of an enumerator"},
    {"normalize_or_zero", "of any vector"},
    {"remove_unfinished_files", "of no data"},
    {"unit_across", "of any vector; it is none of one without length"},
    {"triple", "of any vectors"},
    {"cross", "of any vectors"},
    {"body_orientation", "of grids that make_surface_grid made"},
    {"names_of", "of an enumeration"},
    {"append_facets", "of grids that make_surface_grid made"},
    {"make_linear_view", "make_camera, of descriptions that are no data"},
    {"find_named", "of any text"},
    {"is_linear", "of any camera"},
    {"has_look_at", "of any camera"},
    {"projects", "of an enumerator"},
    {"follows_paths", "of an enumerator"},
    {"state_name", "of an enumerator"},
    {"path_name", "of an enumerator"},
    {"event_name", "of an enumerator"},
    {"general_linear_kind_name", "of an enumerator"},
    {"engine_name", "of an enumerator"},
    {"test_state_name", "of an enumerator"},
    {"test_state_of", "of an enumerator"},
    {"run_sweep", "tests/sweep and tests/cli: what a sweep is asked"},
    {"why_left_out", "plan_sweep, which plans the same"},
    {"keep_left_out", "tests/cli: galleries"},
    {"left_out_of_gallery", "tests/cli: galleries"},
    {"chooses_facets", "of any camera"},
    {"require_comparable", "compare_images, of images that are no data"},
    {"compared_pixels", "compare_images, of images that are no data"},
    {"float_channel", "compare_images, of images that are no data"},
    {"id_channel", "compare_images, of images that are no data"},
    {"channel_of", "of any two names"},
    {"seen_channel", "tests/measure: names"},
    {"junit_xml", "of results that run_suite gives"},
    {"linear_from_srgb", "of any number"},
    {"srgb_from_linear", "of any number"},
    {"merge_folders", "tests/sweep"},
    {"summarize", "of any numbers"},
    {"create_image_message", "tests/image: displays"},
    {"bourke_mesh", "of meshes that make_warp_mesh made"},
    {"center_of_directions", "tests/inverse: unwrap"},
    {"check_target_request", "tests/inverse: maps"},
    {"check_page_name", "tests/inverse: commands"},
    {"design_cage", "of designs that design_mirror made"},
    {"design_mirror", "tests/inverse: wishes that are none"},
    {"design_obj", "of designs that design_mirror made"},
    {"design_of_sphere", "of designs that design_mirror made"},
    {"design_sag_table", "of designs that design_mirror made"},
    {"design_scene", "of designs that design_mirror made"},
    {"design_stl", "of designs that design_mirror made"},
    {"clamped_to", "of any place"},
    {"find_mesh", "of any name"},
    {"has_own_normals", "of any mesh"},
    {"against_name", "of an enumerator"},
    {"check_wish", "tests/inverse: wishes that are none"},
    {"largest_curvature", "of designs that design_mirror made"},
    {"limited_names", "of nothing"},
    {"parse_length", "tests/inverse: lengths that are none"},
    {"parse_paper", "tests/inverse: papers that are none"},
    {"parse_unit", "tests/inverse: units that are none"},
    {"parse_wish", "tests/inverse: wishes that are none"},
    {"read_render_test", "tests/suite: test.json that is none"},
    {"read_wish", "tests/inverse: wishes that are none"},
    {"vector_graphics_message", "tests/view: displays"},
    {"wish_example", "of nothing"},
    {"wish_schema", "of nothing"},
    {"scene_document", "of scenes that load_scene gave"},
    {"first_cell", "of any size"},
    {"fit_html", "of results that fit_scene gave"},
    {"fit_scene", "tests/inverse: pairs and pointers that are none"},
    {"is_only_optic", "tests/inverse: unwrap"},
    {"largest_window", "tests/inverse: anamorph"},
    {"make_anamorph", "tests/inverse: anamorph"},
    {"image_of", "of maps that make_caustic_map made"},
    {"make_caustic_map", "tests/laws: caustics"},
    {"bake_light", "tests/laws: radiosity"},
    {"convergence_plot", "tests/radiosity: plots"},
    {"make_film_map", "tests/inverse: maps"},
    {"make_map", "tests/inverse: maps"},
    {"make_mesh", "tests/inverse: maps"},
    {"make_warp_mesh", "tests/inverse: maps"},
    {"map_format", "tests/inverse: commands"},
    {"npz_of", "of maps that make_film_map made"},
    {"obj_mesh", "of meshes that make_warp_mesh made"},
    {"optic_word", "of any wish"},
    {"pair_state_name", "of an enumerator"},
    {"parse_correspondences", "tests/inverse: pairs that are none"},
    {"pdf_of", "of pages that make_anamorph made"},
    {"pgm_name", "of any name"},
    {"pgm_of", "of maps that make_film_map made"},
    {"photo_of", "tests/inverse: unwrap"},
    {"png_of", "of pages that make_anamorph made"},
    {"read_correspondences", "tests/inverse: pairs that are none"},
    {"read_photo", "tests/inverse: unwrap"},
    {"residual_arrows", "of results that fit_scene gave"},
    {"stmap_of", "of maps that make_film_map made"},
    {"svg_of", "of pages that make_anamorph made"},
    {"unwrap", "tests/inverse: photographs that are none"},
    {"verify_anamorph", "of pages that make_anamorph made"},
    {"write_map", "tests/inverse: maps"},
    {"write_mesh", "tests/inverse: maps, and of meshes that make_warp_mesh made"},
    {"write_page", "of pages that make_anamorph made"},
    {"update_image_message", "tests/image: displays"},
    {"replace_file", "tests/base and tests/image: outputs"},
    {"output_target", "tests/image: outputs"},
    {"readable_size", "tests/image: inputs"},
    {"replace_text_file", "tests/image: outputs"},
    {"make_folder", "tests/sweep"},
    {"remove_file", "tests/sweep"},
};

/// Adds the headers that one includes; those of the study room pass on what they include, too.
void add_passed_on(const fs::path& header, std::set<std::string>& headers) {
    static const std::regex kInclude(R"x(^#include "([\w/]+\.h)")x");
    const fs::path source = fs::path(source_dir()) / "src";
    std::ifstream in(header);
    std::smatch match;
    for (std::string line; std::getline(in, line);) {
        if (!std::regex_search(line, match, kInclude)) continue;
        const std::string name = match[1].str();
        headers.insert((source / name).string());
        if (name.rfind("study/", 0) == 0) add_passed_on(source / name, headers);
    }
}

/// The public headers and those that they include to pass on, in the source; what these include again is
/// theirs alone.
std::set<std::string> public_headers() {
    std::set<std::string> headers;
    const fs::path installed = fs::path(trilens_test::build_dir()) / "include" / "trilens";
    for (const auto& entry : fs::directory_iterator(installed)) {
        const fs::path header = fs::path(source_dir()) / "src" / "trilens" / entry.path().filename();
        headers.insert(header.string());
        add_passed_on(header, headers);
    }
    return headers;
}

/// Names of the functions that they declare outside of types.
std::set<std::string> public_functions() {
    static const std::regex kFunction(
        R"(^(?:inline |constexpr |\[\[noreturn\]\] )*[\w:<>,\s\*&]*?[\w>\*&]\s+[\*&]?(\w+)\()");
    std::set<std::string> names;
    for (const std::string& header : public_headers()) {
        std::ifstream in(header);
        std::smatch match;
        for (std::string line; std::getline(in, line);)
            if (!line.empty() && std::isalpha(static_cast<unsigned char>(line[0])) &&
                line.find("return") != 0 && std::regex_search(line, match, kFunction))
                names.insert(match[1]);
    }
    return names;
}

}  // namespace

TEST_CASE("every public function meets what is no data", "[trilens][bad-input]") {
    std::string tests;
    for (const char* file : {"/tests/trilens/callers_data_test.cpp", "/tests/trilens/callers_images_test.cpp",
                             "/tests/trilens/callers_lenses_test.cpp", "/tests/core/callers_data_test.cpp"}) {
        std::ifstream in(source_dir() + file);
        std::stringstream text;
        text << in.rdbuf();
        tests += text.str();
    }
    const std::set<std::string> functions = public_functions();
    CHECK(functions.size() > 90);
    std::string missing;
    for (const std::string& name : functions) {
        const bool called = std::regex_search(tests, std::regex("\\b" + name + "\\("));
        if (!called && kElsewhere.count(name) == 0) missing += name + " ";
    }
    CHECK(missing == "");
}
