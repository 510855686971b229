// What trilens reads of a glTF's JSON, key by key: the library leaves out what has a wrong type, and takes
// an index of -1 for none.
#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string_view>

#include "json/fields.h"
#include "json/schema.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

/// A key's place: a JSON pointer with * for every entry of an array and @ for every member of an object; a !
/// at its end says that what holds the key must have it.
struct KeyRule {
    std::string place;
    Json schema;     // of the value; unused for an index
    std::string of;  // an index: the pointer of the array whose entries it counts
};

/// A factor of 1, as single precision rounds it.
constexpr double kOne = 1 + 1e-6;

const Json kAnyList{{"type", "array"}}, kAnyObject{{"type", "object"}}, kAnyInteger{{"type", "integer"}};

Json any_number() {
    return {{"type", "number"}};
}
Json any_text() {
    return {{"type", "string"}};
}
/// Of bytes and entries, as many as the library counts.
Json any_size() {
    return {{"type", "integer"}, {"minimum", 0}};
}
Json one_of_codes(std::initializer_list<int> codes) {
    return {{"type", "integer"}, {"enum", Json(codes)}};
}

std::vector<KeyRule> rules_of_scenes() {
    const std::string node = "/nodes/*/", light = "/extensions/KHR_lights_punctual/lights/*/";
    return {{"/asset!", kAnyObject, ""},
            {"/asset/version!", any_text(), ""},
            {"/asset/minVersion", any_text(), ""},
            {"/extensionsUsed", list_of(any_text()), ""},
            {"/extensionsRequired", list_of(any_text()), ""},
            {"/scene", {}, "/scenes"},
            {"/scenes/*/nodes/*", {}, "/nodes"},
            {node + "name", any_text(), ""},
            {node + "children/*", {}, "/nodes"},
            {node + "mesh", {}, "/meshes"},
            {node + "skin", {}, "/skins"},
            {node + "camera", {}, "/cameras"},
            {node + "matrix", several(16, any_number()), ""},
            {node + "translation", several(3, any_number()), ""},
            {node + "rotation", several(4, any_number()), ""},
            {node + "scale", several(3, any_number()), ""},
            {node + "weights", list_of(any_number()), ""},
            {node + "extensions/KHR_lights_punctual/light!", {}, "/extensions/KHR_lights_punctual/lights"},
            {node + "extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION", {}, "/accessors"},
            {node + "extensions/EXT_mesh_gpu_instancing/attributes/ROTATION", {}, "/accessors"},
            {node + "extensions/EXT_mesh_gpu_instancing/attributes/SCALE", {}, "/accessors"},
            {"/cameras/*/name", any_text(), ""},
            {"/cameras/*/type!", word_of({"perspective", "orthographic"}), ""},
            {"/cameras/*/perspective/yfov!", any_number(), ""},
            {"/cameras/*/perspective/aspectRatio", {{"type", "number"}, {"exclusiveMinimum", 0}}, ""},
            {"/cameras/*/orthographic/xmag!", any_number(), ""},
            {"/cameras/*/orthographic/ymag!", any_number(), ""},
            {light + "name", any_text(), ""},
            {light + "type!", word_of({"directional", "point", "spot"}), ""},
            {light + "color", several(3, any_number()), ""},
            {light + "intensity", any_number(), ""},
            {light + "range", any_number(), ""},
            {light + "spot/innerConeAngle", any_number(), ""},
            {light + "spot/outerConeAngle", any_number(), ""}};
}

std::vector<KeyRule> rules_of_meshes() {
    const std::string primitive = "/meshes/*/primitives/*/", accessor = "/accessors/*/",
                      sparse = accessor + "sparse/", view = "/bufferViews/*/";
    return {{"/meshes/*/name", any_text(), ""},
            {"/meshes/*/weights", list_of(any_number()), ""},
            {primitive + "attributes/@", {}, "/accessors"},
            {primitive + "indices", {}, "/accessors"},
            {primitive + "material", {}, "/materials"},
            {primitive + "mode", whole_in(0, 6), ""},
            {primitive + "targets/*/@", {}, "/accessors"},
            {accessor + "bufferView", {}, "/bufferViews"},
            {accessor + "byteOffset", any_size(), ""},
            {accessor + "componentType!", whole_in(0, kMostIndex), ""},
            {accessor + "normalized", yes_or_no(), ""},
            {accessor + "count!", any_size(), ""},
            {accessor + "type!", word_of({"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}), ""},
            {sparse + "count!", whole_in(0, kMostIndex), ""},
            {sparse + "indices/bufferView!", {}, "/bufferViews"},
            {sparse + "indices/byteOffset", whole_in(0, kMostIndex), ""},
            {sparse + "indices/componentType!", whole_in(0, kMostIndex), ""},
            {sparse + "values/bufferView!", {}, "/bufferViews"},
            {sparse + "values/byteOffset", whole_in(0, kMostIndex), ""},
            {view + "buffer!", {}, "/buffers"},
            {view + "byteOffset", any_size(), ""},
            {view + "byteLength!", any_size(), ""},
            {view + "byteStride", any_size(), ""},
            {"/buffers/*/uri", any_text(), ""},
            {"/buffers/*/byteLength!", any_size(), ""},
            {"/skins/*/joints/*", {}, "/nodes"},
            {"/skins/*/inverseBindMatrices", {}, "/accessors"},
            {"/animations/*/name", any_text(), ""},
            {"/animations/*/channels/*/sampler!", whole_in(0, kMostIndex), ""},
            {"/animations/*/channels/*/target!", kAnyObject, ""},
            {"/animations/*/channels/*/target/node", {}, "/nodes"},
            {"/animations/*/channels/*/target/path!", any_text(), ""},
            {"/animations/*/samplers/*/input!", {}, "/accessors"},
            {"/animations/*/samplers/*/output!", {}, "/accessors"},
            {"/animations/*/samplers/*/interpolation", word_of({"LINEAR", "STEP", "CUBICSPLINE"}), ""}};
}

/// Of one kind of picture that materials have; `place` is the object that names the texture.
void add_texture_rules(const std::string& place, std::vector<KeyRule>& into) {
    const std::string transform = place + "/extensions/KHR_texture_transform";
    into.insert(into.end(), {{place + "/index!", {}, "/textures"},
                             {place + "/texCoord", whole_in(0, kMostIndex), ""},
                             {transform, kAnyObject, ""},
                             {transform + "/offset", several(2, any_number()), ""},
                             {transform + "/scale", several(2, any_number()), ""},
                             {transform + "/rotation", any_number(), ""},
                             {transform + "/texCoord", whole_in(0, kMostIndex), ""}});
}

std::vector<KeyRule> rules_of_materials() {
    const std::string material = "/materials/*/", base = material + "pbrMetallicRoughness/",
                      extension = material + "extensions/KHR_materials_";
    const Json factor = number_in(0, 1), wrap = one_of_codes({33071, 33648, 10497});
    std::vector<KeyRule> rules{
        {material + "name", any_text(), ""},
        {base + "baseColorFactor", several(4, any_number()), ""},
        {base + "baseColorFactor/*", factor, ""},
        {base + "metallicFactor", factor, ""},
        {base + "roughnessFactor", factor, ""},
        {material + "normalTexture/scale", any_number(), ""},
        {material + "occlusionTexture/strength", factor, ""},
        {material + "emissiveFactor", several(3, number_in(0, kLargestCoordinate)), ""},
        {material + "alphaMode", word_of({"OPAQUE", "MASK", "BLEND"}), ""},
        {material + "alphaCutoff", {{"type", "number"}, {"minimum", 0}}, ""},
        {material + "doubleSided", yes_or_no(), ""},
        {extension + "ior/ior", any_number(), ""},
        {extension + "transmission/transmissionFactor", any_number(), ""},
        {extension + "volume/thicknessFactor", any_number(), ""},
        {extension + "volume/attenuationColor", several(3, any_number()), ""},
        {extension + "volume/attenuationDistance", any_number(), ""},
        {extension + "dispersion/dispersion", any_number(), ""},
        {extension + "specular/specularFactor", any_number(), ""},
        {extension + "specular/specularColorFactor", several(3, any_number()), ""},
        {extension + "emissive_strength/emissiveStrength", any_number(), ""},
        {extension + "unlit", kAnyObject, ""},
        {"/textures/*/source", {}, "/images"},
        {"/textures/*/sampler", {}, "/samplers"},
        {"/textures/*/extensions/EXT_texture_webp/source!", {}, "/images"},
        {"/images/*/uri", any_text(), ""},
        {"/images/*/bufferView", {}, "/bufferViews"},
        {"/samplers/*/wrapS", wrap, ""},
        {"/samplers/*/wrapT", wrap, ""},
        {"/samplers/*/magFilter", one_of_codes({9728, 9729}), ""}};
    for (const char* texture :
         {"pbrMetallicRoughness/baseColorTexture", "pbrMetallicRoughness/metallicRoughnessTexture",
          "normalTexture", "occlusionTexture", "emissiveTexture"})
        add_texture_rules(material + texture, rules);
    return rules;
}

const std::vector<KeyRule>& all_key_rules() {
    static const std::vector<KeyRule> rules = [] {
        std::vector<KeyRule> all = rules_of_scenes();
        for (const auto& more : {rules_of_meshes(), rules_of_materials()})
            all.insert(all.end(), more.begin(), more.end());
        return all;
    }();
    return rules;
}

class KeyChecker {
  public:
    KeyChecker(const Json& json, const std::string& file) : root_{json, "", file} {}

    void check(const KeyRule& rule) {
        std::string_view steps = rule.place;
        const bool needed = steps.ends_with('!');
        if (needed) steps.remove_suffix(1);
        walk(root_, steps, rule, needed);
    }

  private:
    /// `steps`: what is left of the rule's place, each step after a slash.
    void walk(const Node& at, std::string_view steps, const KeyRule& rule, bool needed) {
        if (steps.empty()) return rule.of.empty() ? check_value(at, rule.schema) : check_index(at, rule.of);
        const std::size_t end = std::min(steps.find('/', 1), steps.size());
        const std::string step(steps.substr(1, end - 1));
        const std::string_view rest = steps.substr(end);
        check_value(at, step == "*" ? kAnyList : kAnyObject);
        if (step == "*") {
            for (std::size_t i = 0; i < at.size(); ++i) walk(at[i], rest, rule, needed);
        } else if (step == "@") {
            for (const auto& [key, value] : at.json.items()) walk(at[key.c_str()], rest, rule, needed);
        } else if (at.has(step.c_str())) {
            walk(at[step.c_str()], rest, rule, needed);
        } else if (needed && rest.empty()) {
            at.fail("has no '" + step + "'");
        }
    }

    static void check_value(const Node& at, const Json& schema) {
        // glTF 2.0, section 2.7; the library takes such a number for none.
        if (schema.value("type", "") == "integer" && at.json.is_number_float())
            at.fail("is written " + at.json.dump() + ": must be a whole number without a fraction");
        if (at.json.is_number_float() && at.json > 1.0 && at.json <= kOne &&
            schema.value("maximum", 0.0) == 1)
            return;
        if (const std::optional<Problem> problem = find_problem(at.json, schema))
            fail_at(at.file, at.place + problem->place, problem->message);
    }

    void check_index(const Node& at, const std::string& of) {
        const std::size_t count = count_of(of);
        check_value(at, kAnyInteger);
        if (!at.json.is_number_unsigned() || at.json.get<std::uint64_t>() >= count)
            at.fail(at.json.dump() + " is out of range: there are " + std::to_string(count) + " " +
                    of.substr(of.rfind('/') + 1));
    }

    std::size_t count_of(const std::string& of) {
        const auto [known, is_new] = counts_.try_emplace(of, 0);
        if (is_new) {
            walk(root_, of, {"", kAnyList, ""}, false);
            const Json::json_pointer array(of);
            known->second = root_.json.contains(array) ? root_.json.at(array).size() : 0;
        }
        return known->second;
    }

    Node root_;
    std::map<std::string, std::size_t> counts_;  // by the array's pointer
};

}  // namespace

void check_gltf_keys(const Json& json, const std::string& file) {
    KeyChecker checker(json, file);
    for (const KeyRule& rule : all_key_rules()) checker.check(rule);
}

}  // namespace trilens
