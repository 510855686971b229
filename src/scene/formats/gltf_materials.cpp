// Materials of a glTF, in a scene's terms: metallic-roughness and the KHR_materials extensions.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <tiny_gltf.h>

#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

class MaterialReader {
  public:
    MaterialReader(GltfSource& source, GltfModel& into, std::size_t index)
        : source_(source),
          into_(into),
          in_(source.model.materials[index]),
          place_("/materials/" + std::to_string(index)) {
        out_.material.name = in_.name.empty() ? "material" + std::to_string(index) : in_.name;
        out_.written["name"] = out_.material.name;
        out_.extras = json_of_gltf(in_.extras);
    }

    GltfMaterial read() {
        read_base();
        read_metal();
        read_light();
        read_coverage();
        read_glass();
        warn_of_maps();
        return std::move(out_);
    }

  private:
    std::string at(const std::string& key) const { return place_ + "/" + key; }
    Json extension(const char* name) const {
        const auto found = in_.extensions.find(name);
        return found == in_.extensions.end() ? Json() : json_of_gltf(found->second);
    }
    bool has(const char* name) const { return in_.extensions.count(name) > 0; }

    double number(const Json& of, const char* key, double fallback, double high, const std::string& place) {
        return of.is_object() && of.contains(key)
                   ? gltf_number(source_, of.at(key), 0, high, place + "/" + key)
                   : fallback;
    }
    Vec3 color(const Json& of, const char* key, const Vec3& fallback, const std::string& place) {
        if (!of.is_object() || !of.contains(key)) return fallback;
        const Json& list = of.at(key);
        if (!list.is_array() || list.size() < 3) source_.fail(place + "/" + key, "is no colour");
        Vec3 color;
        for (int k = 0; k < 3; ++k)
            color[k] = gltf_number(source_, list.at(static_cast<std::size_t>(k)), 0, kLargestCoordinate,
                                   place + "/" + key);
        return color;
    }
    void write(const char* key, const Vec3& value) { out_.written[key] = {value.x, value.y, value.z}; }

    void read_base() {
        const tinygltf::PbrMetallicRoughness& pbr = in_.pbrMetallicRoughness;
        for (int k = 0; k < 3; ++k)
            out_.material.base_color_factor[k] = factor(pbr.baseColorFactor[static_cast<std::size_t>(k)]);
        write("baseColorFactor", out_.material.base_color_factor);
        Json texture = read_texture(pbr.baseColorTexture, "pbrMetallicRoughness/baseColorTexture");
        if (!texture.is_null()) {
            out_.image = texture.at("image").get<int>();
            out_.written["baseColorTexture"] = std::move(texture);
        }
        out_.material.unlit = has("KHR_materials_unlit");
        if (out_.material.unlit) out_.written["unlit"] = true;
    }

    void read_metal() {
        const tinygltf::PbrMetallicRoughness& pbr = in_.pbrMetallicRoughness;
        out_.material.metallic_factor = factor(pbr.metallicFactor);
        out_.material.roughness_factor = factor(pbr.roughnessFactor);
        // Unlit is its colour alone.
        if (out_.material.unlit) return;
        out_.written["metallicFactor"] = out_.material.metallic_factor;
        out_.written["roughnessFactor"] = out_.material.roughness_factor;
        add_texture("metallicRoughnessTexture", pbr.metallicRoughnessTexture,
                    "pbrMetallicRoughness/metallicRoughnessTexture");
        if (add_texture("normalTexture", in_.normalTexture, "normalTexture"))
            out_.written["normalTexture"]["scale"] = in_.normalTexture.scale;
        if (add_texture("occlusionTexture", in_.occlusionTexture, "occlusionTexture"))
            out_.written["occlusionTexture"]["strength"] = factor(in_.occlusionTexture.strength);
        const Json specular = extension("KHR_materials_specular");
        if (specular.is_null()) return;
        const std::string place = at("extensions/KHR_materials_specular");
        out_.written["specularFactor"] = number(specular, "specularFactor", 1, 1, place);
        write("specularColorFactor", color(specular, "specularColorFactor", Vec3(1), place));
        for (const char* key : {"specularTexture", "specularColorTexture"})
            if (specular.contains(key)) out_.written[key] = true;
    }

    /// Of what check_gltf_keys lets pass: a 1 of single precision may be a little more.
    static double factor(double value) { return std::min(value, 1.0); }

    void read_light() {
        Vec3 emissive(0);
        for (std::size_t k = 0; k < 3 && k < in_.emissiveFactor.size(); ++k)
            emissive[static_cast<int>(k)] = in_.emissiveFactor[k];
        if (emissive == Vec3(0) || out_.material.unlit) return;
        write("emissiveFactor", emissive);
        add_texture("emissiveTexture", in_.emissiveTexture, "emissiveTexture");
        const Json strength = extension("KHR_materials_emissive_strength");
        if (!strength.is_null())
            out_.written["emissiveStrength"] = number(strength, "emissiveStrength", 1, kLargestCoordinate,
                                                      at("extensions/KHR_materials_emissive_strength"));
    }

    void read_coverage() {
        if (in_.alphaMode.empty() || in_.alphaMode == "OPAQUE") return;
        out_.written["alphaMode"] = in_.alphaMode == "MASK" ? "mask" : "blend";
        const std::vector<double>& factors = in_.pbrMetallicRoughness.baseColorFactor;
        if (factor(factors[3]) != 1) out_.written["alphaFactor"] = factors[3];
        if (in_.alphaMode == "BLEND" && !in_.doubleSided) out_.written["doubleSided"] = false;
        if (in_.alphaMode != "MASK") return;
        out_.written["alphaCutoff"] = std::min(in_.alphaCutoff, 2.0);  // beyond 1 all is cut away
    }

    void read_glass() {
        const Json transmission = extension("KHR_materials_transmission"),
                   ior = extension("KHR_materials_ior"), volume = extension("KHR_materials_volume"),
                   dispersion = extension("KHR_materials_dispersion");
        if (!ior.is_null()) {
            const double value =
                number(ior, "ior", 1.5, kLargestCoordinate, at("extensions/KHR_materials_ior"));
            if (value != 0 && !(value >= 1 && value <= 10))
                source_.fail(at("extensions/KHR_materials_ior/ior"), "must be 0, or lie in 1..10");
            if (value == 0) {
                source_.warn_of_material("an ior of 0 (all reflects) is taken for 1.5");
                out_.written["an ior of 0 (all reflects)"] = true;
            } else {
                out_.written["ior"] = value;
            }
        }
        if (!transmission.is_null()) {
            const std::string place = at("extensions/KHR_materials_transmission");
            out_.written["transmissionFactor"] = number(transmission, "transmissionFactor", 0, 1, place);
            if (transmission.contains("transmissionTexture")) out_.written["transmissionTexture"] = true;
        }
        if (!dispersion.is_null())
            out_.written["dispersion"] = number(dispersion, "dispersion", 0, kLargestCoordinate,
                                                at("extensions/KHR_materials_dispersion"));
        if (!volume.is_null()) {
            const std::string place = at("extensions/KHR_materials_volume");
            const double thickness = number(volume, "thicknessFactor", 0, kLargestCoordinate, place);
            const Vec3 tint = color(volume, "attenuationColor", Vec3(1), place);
            for (int k = 0; k < 3; ++k)
                if (!(tint[k] <= 1)) source_.fail(place + "/attenuationColor", "is brighter than 1");
            const double distance = number(volume, "attenuationDistance", 0, kLargestCoordinate, place);
            if (thickness > 0)
                out_.written["volume"] = {{"attenuationColor", {tint.x, tint.y, tint.z}},
                                          {"attenuationDistance", distance}};
            else if (out_.written.value("transmissionFactor", 0.0) > 0)
                out_.written["a thin wall (a volume's thicknessFactor 0)"] = true;
        }
    }

    template <class Info>
    bool add_texture(const char* key, const Info& info, const std::string& place) {
        Json texture = read_texture(info, place);
        if (texture.is_null()) return false;
        out_.written[key] = std::move(texture);
        return true;
    }

    /// Null where there is none, or one without a picture.
    template <class Info>
    Json read_texture(const Info& info, const std::string& key) {
        const int texture = source_.checked(info.index, source_.model.textures.size(), at(key), "texture");
        if (texture < 0) return nullptr;
        const std::string place = "/textures/" + std::to_string(texture);
        const tinygltf::Texture& in = source_.model.textures[static_cast<std::size_t>(texture)];
        const int image = picture_of(in, place);
        if (image < 0) {
            source_.warn(in.extensions.count("KHR_texture_basisu") > 0
                             ? "a texture of KTX2 alone (KHR_texture_basisu) is ignored: KTX2 is not read"
                             : "a texture without a picture that is known is ignored");
            return nullptr;
        }
        Json written{{"image", image}};
        TextureSampler sampler;
        read_sampler(in.sampler, sampler, written);
        int set = info.texCoord;
        const auto transform = info.extensions.find("KHR_texture_transform");
        if (transform != info.extensions.end())
            set = read_transform(json_of_gltf(transform->second), at(key), sampler, written).value_or(set);
        if (set > 1) source_.warn("sets of uv beyond TEXCOORD_1 are not read: the first is taken for them");
        if (set == 1) written["texCoord"] = sampler.uv_set = 1;
        if (key == "pbrMetallicRoughness/baseColorTexture") out_.material.base_color_sampler = sampler;
        return written;
    }

    /// The index of a texture's picture: that of EXT_texture_webp where it has one; negative: none.
    int picture_of(const tinygltf::Texture& texture, const std::string& place) {
        const auto webp = texture.extensions.find("EXT_texture_webp");
        if (webp == texture.extensions.end())
            return source_.checked(texture.source, into_.images.size(), place, "image");
        return webp->second.Get("source").GetNumberAsInt();
    }

    void read_sampler(int index, TextureSampler& sampler, Json& written) {
        if (source_.checked(index, source_.model.samplers.size(), "/textures", "sampler") < 0) return;
        const tinygltf::Sampler& given = source_.model.samplers[static_cast<std::size_t>(index)];
        const auto wrap = [](int code) {
            return code == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::kClampToEdge
                   : code == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirroredRepeat
                                                                   : Wrap::kRepeat;
        };
        sampler.wrap_s = wrap(given.wrapS);
        sampler.wrap_t = wrap(given.wrapT);
        if (given.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) {
            source_.warn_of_material("the magFilter NEAREST of samplers is taken for LINEAR");
            written["magFilter NEAREST"] = true;
        }
        if (sampler.wrap_s != Wrap::kRepeat) written["wrapS"] = name_of(sampler.wrap_s);
        if (sampler.wrap_t != Wrap::kRepeat) written["wrapT"] = name_of(sampler.wrap_t);
    }

    /// KHR_texture_transform; gives the set of uv that it asks for, if any.
    std::optional<int> read_transform(const Json& given, const std::string& place, TextureSampler& sampler,
                                      Json& written) {
        const std::string malformed = "KHR_texture_transform is malformed";
        const auto number = [&](const Json& value) {
            if (!value.is_number() || !(std::fabs(value.get<double>()) <= kLargestCoordinate))
                source_.fail(place, malformed);
            return value.get<double>();
        };
        TextureTransform transform;
        const auto pair = [&](const char* key, Vec2& values) {
            if (!given.contains(key)) return;
            const Json& list = given.at(key);
            if (!list.is_array() || list.size() != 2) source_.fail(place, malformed);
            values = {number(list.at(0)), number(list.at(1))};
            written["transform"][key] = {values.x, values.y};
        };
        if (!given.is_object()) source_.fail(place, malformed);
        pair("offset", transform.offset);
        pair("scale", transform.scale);
        if (given.contains("rotation")) {
            transform.rotation = number(given.at("rotation"));
            written["transform"]["rotation"] = transform.rotation * kDegreesPerRadian;
        }
        set_transform(transform, sampler);
        if (!given.contains("texCoord")) return std::nullopt;
        const double set = number(given.at("texCoord"));
        if (!(set >= 0 && set <= 64)) source_.fail(place, malformed);
        return static_cast<int>(set);
    }

    /// What a material has beside its base colour, for whoever takes nothing else.
    void warn_of_maps() {
        const std::pair<const char*, int> maps[] = {
            {"normal", in_.normalTexture.index},
            {"metallic-roughness", in_.pbrMetallicRoughness.metallicRoughnessTexture.index},
            {"occlusion", in_.occlusionTexture.index},
            {"emissive", in_.emissiveTexture.index}};
        for (const auto& [name, texture] : maps)
            if (texture >= 0) source_.warn_of_material(std::string(name) + " maps are ignored");
        if (in_.emissiveTexture.index < 0 && out_.written.contains("emissiveFactor"))
            source_.warn_of_material("light that materials emit is ignored");
        if (out_.written.contains("alphaMode"))
            source_.warn_of_material("alphaMode " + in_.alphaMode + " is ignored: all is opaque");
    }

    GltfSource& source_;
    GltfModel& into_;
    const tinygltf::Material& in_;
    std::string place_;
    GltfMaterial out_;
};

}  // namespace

void read_gltf_materials(GltfSource& source, GltfModel& into) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < source.model.materials.size(); ++i) {
        into.materials.push_back(MaterialReader(source, into, i).read());
        // Scenes name each material once.
        std::string name = into.materials.back().material.name;
        if (name == "inherit") name += ".1";
        const std::string first = name;
        for (int k = 2; !names.insert(name).second; ++k) name = first + "." + std::to_string(k);
        into.materials.back().material.name = name;
        into.materials.back().written["name"] = name;
    }
}

}  // namespace trilens
