#include "scene/imports/expand_lenses.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "json/schema.h"
#include "scene/data/polygons.h"
#include "scene/read/read_lens.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// KHR_materials_dispersion's number is 20 over Abbe's.
constexpr double kDispersionTimesAbbe = 20;

/// How far a stop's ring reaches beyond the lens.
constexpr double kRingReach = 1.25;
constexpr int kRingSegments = 128;

void check_lenses(const Json& scene, const std::string& file) {
    const Json& whole = scene_schema_json();
    const Json alone{{"definitions", whole.at("definitions")},
                     {"title", "a scene"},
                     {"type", "object"},
                     {"properties", {{"lenses", whole.at("properties").at("lenses")}}}};
    if (const auto found = find_problem(Json{{"lenses", scene.at("lenses")}}, alone))
        fail_at(file, found->place, found->message);
}

Json side_json(const LensSide& side) {
    Json json = Json::object();
    if (side.curvature != 0) json["radius"] = 1 / side.curvature;
    if (side.conic != 0) json["conic"] = side.conic;
    const auto is_zero = [](double a) { return a == 0; };
    if (!std::all_of(side.coefficients.begin(), side.coefficients.end(), is_zero))
        json["coefficients"] = side.coefficients;
    if (departs_along_normal(side)) json["normalDepartures"] = side.normal_departures;
    json["aperture"] = side.aperture;
    const double across = side.across_curvature == 0 ? 0 : 1 / side.across_curvature;
    if (side.form == SideForm::kBiconic) {
        json["radiusX"] = across;
        json["conicX"] = side.across_conic;
    } else if (!is_round(side)) {
        json["rotationRadius"] = across;
        json["profileAlong"] = side.form == SideForm::kToricY ? "y" : "x";
    }
    return json;
}

Json material_json(const std::string& name, const Glass& glass, bool disperses) {
    Json material{{"name", name}, {"transmissionFactor", 1}, {"ior", glass.index}};
    if (disperses && glass.abbe > 0) material["dispersion"] = kDispersionTimesAbbe / glass.abbe;
    return material;
}

/// One lens' meshes and materials, added to the scene's.
class Expansion {
  public:
    Expansion(const Node& node, const ReadLens& lens, Json& scene)
        : node_(node), lens_(lens), scene_(scene) {}

    void add_bodies() {
        const std::vector<LensElement> elements = lens_elements(lens_.prescription);
        for (std::size_t i = 0; i < elements.size(); ++i) {
            const LensElement& element = elements[i];
            const std::string material =
                element.is_mirror ? mirror_material() : material_of(element.medium.glass);
            Json mesh{{"name", lens_.name + "/" + std::to_string(i + 1)},
                      {"role", "optic"},
                      {"material", material},
                      {"resolution", lens_.resolution}};
            mesh["primitive"] = {{"type", "lens"},
                                 {"center", json_of(element.pose.shift)},
                                 {"axis", json_of(element.pose.turn[2])},
                                 {"tangent", json_of(element.pose.turn[0])},
                                 {"thickness", element.shape.thickness},
                                 {"front", side_json(element.shape.front)},
                                 {"back", side_json(element.shape.back)}};
            if (element.shape.hole > 0) mesh["primitive"]["hole"] = element.shape.hole;
            add(std::move(mesh));
        }
    }

    /// Of rows whose obscuration has no place.
    std::vector<const LensRow*> add_obscurations() {
        const LensPrescription& lens = lens_.prescription;
        const std::vector<LensObscuration> shells = lens_obscurations(lens);
        for (const LensObscuration& shell : shells) {
            const std::string name = lens_.name + "/obscuration " + std::to_string(shell.row + 1);
            Json mesh{{"name", name}, {"role", "object"}, {"material", black_material()}};
            mesh["primitive"] = {{"type", "lens"},
                                 {"center", json_of(shell.pose.shift)},
                                 {"axis", json_of(shell.pose.turn[2])},
                                 {"tangent", json_of(shell.pose.turn[0])},
                                 {"thickness", shell.shape.thickness},
                                 {"front", side_json(shell.shape.front)},
                                 {"back", side_json(shell.shape.back)},
                                 {"segments", kShellSegments}};
            add(std::move(mesh));
        }
        std::vector<const LensRow*> left_out;
        for (std::size_t i = 0; i < lens.rows.size(); ++i)
            if (lens.rows[i].obscuration > 0 &&
                std::none_of(shells.begin(), shells.end(), [i](const auto& shell) { return shell.row == i; }))
                left_out.push_back(&lens.rows[i]);
        return left_out;
    }

    /// False where the stop lies on glass; a mirror's rim is one by itself.
    bool add_stop() {
        const LensPrescription& lens = lens_.prescription;
        const auto is_stop = [](const LensRow& row) { return row.stop; };
        const auto stop = std::find_if(lens.rows.begin(), lens.rows.end(), is_stop);
        if (stop == lens.rows.end() || !(stop->side.aperture > 0) || stop->mirror) return true;
        const auto index = static_cast<std::size_t>(stop - lens.rows.begin());
        const std::vector<LensMedium> media = lens_media(lens);
        if (!media[index].glass.is_air() || !media[index + 1].glass.is_air()) return false;
        double widest = 0;
        for (const LensRow& row : lens.rows) widest = std::max(widest, row.side.aperture);
        const std::string name = lens_.name + "/stop";
        scene_["materials"].push_back({{"name", name}, {"baseColorFactor", {0, 0, 0}}, {"unlit", true}});
        Json mesh{{"name", name}, {"role", "object"}, {"material", name}};
        const LensPose pose = lens_poses(lens)[index];
        mesh["primitive"] = {{"type", "disk"},
                             {"center", json_of(pose.shift)},
                             {"normal", json_of(pose.turn[2])},
                             {"tangent", json_of(pose.turn[0])},
                             {"radius", kRingReach * widest},
                             {"hole", stop->side.aperture},
                             {"segments", kRingSegments}};
        add(std::move(mesh));
        return true;
    }

  private:
    static Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

    std::string mirror_material() {
        std::string name = lens_.name + "/mirror";
        if (!has_mirror_)
            scene_["materials"].push_back({{"name", name}, {"metallicFactor", 1}, {"roughnessFactor", 0}});
        has_mirror_ = true;
        return name;
    }

    std::string black_material() {
        std::string name = lens_.name + "/black";
        if (!has_black_)
            scene_["materials"].push_back({{"name", name}, {"baseColorFactor", {0, 0, 0}}, {"unlit", true}});
        has_black_ = true;
        return name;
    }

    /// Its material's name, which is added where it is new. Glasses by numbers may share a name.
    std::string material_of(const Glass& glass) {
        std::size_t namesakes = 0;
        for (const auto& [known, material] : materials_) {
            if (known.name != glass.name) continue;
            if (known.index == glass.index && known.abbe == glass.abbe) return material;
            ++namesakes;
        }
        std::string material = lens_.name + "/" + glass.name;
        if (namesakes > 0) material += "/" + std::to_string(namesakes + 1);
        scene_["materials"].push_back(material_json(material, glass, lens_.dispersion));
        materials_.emplace_back(glass, material);
        return material;
    }

    void add(Json mesh) {
        if (node_.has("transform")) mesh["transform"] = node_["transform"].json;
        scene_["meshes"].push_back(std::move(mesh));
    }

    const Node& node_;
    const ReadLens& lens_;
    Json& scene_;
    std::vector<std::pair<Glass, std::string>> materials_;  // that were added
    bool has_mirror_ = false, has_black_ = false;
};

}  // namespace

void expand_lenses(Json& scene, Reading& reading) {
    if (!scene.is_object() || !scene.contains("lenses")) return;
    check_lenses(scene, reading.file);
    const Json lenses = scene.at("lenses");
    scene.erase("lenses");
    for (const char* list : {"materials", "meshes"}) {
        if (!scene.contains(list)) scene[list] = Json::array();
        if (!scene.at(list).is_array()) fail_at(reading.file, std::string("/") + list, "is no array");
    }
    for (std::size_t i = 0; i < lenses.size(); ++i) {
        const Node node{lenses[i], "/lenses/" + std::to_string(i), reading.file};
        if (!similarity_factor(read_transform(node)))
            node["transform"].fail("a lens stays exact only under a uniform scale");
        const ReadLens lens = read_lens(node, i, reading);
        Expansion expansion(node, lens, scene);
        try {
            expansion.add_bodies();
        } catch (const InputError& error) {
            if (node.has("surfaces")) throw;
            node["file"].fail(error.what());
        }
        const auto warn_of = [&](const LensRow& row, const std::string& what) {
            if (node.has("surfaces"))
                reading.warn(row.place, what);
            else
                reading.warn(node["file"].place, row.place + ": " + what);
        };
        for (const LensRow& row : lens.prescription.rows) {
            if (row.hole > 0 && !row.mirror) warn_of(row, "its hole is not drawn: only mirrors have holes");
            if (outreaches_terms(row.side)) warn_of(row, kOutreachesTerms);
        }
        for (const LensRow* row : expansion.add_obscurations())
            warn_of(*row, "its obscuration is not drawn: it has glass on both sides");
        if (!expansion.add_stop()) reading.warn(node.place, "its stop lies on glass: no ring is made of it");
    }
}

}  // namespace trilens
