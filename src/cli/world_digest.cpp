#include "cli/world_digest.h"

#include <string_view>
#include <type_traits>

#include "base/hash.h"

namespace trilens {
namespace {

/// Hashes of blocks, hashed again at the end: no copy of the whole scene.
class Digest {
  public:
    template <typename T>
    void add(const std::vector<T>& block) {
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(block.data(), block.size() * sizeof(T));
    }
    template <typename T>
    void add_value(const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T>);
        add_bytes(&value, sizeof value);
    }
    void add_numbers(std::initializer_list<double> numbers) { add(std::vector<double>(numbers)); }
    void add_texture(const std::shared_ptr<const Texture>& texture) {
        add_value(texture ? texture->width : 0);
        add_value(texture ? texture->height : 0);
        if (texture) add(texture->rgb);
    }
    std::string digits() const { return hash_text(hashes_); }

  private:
    void add_bytes(const void* bytes, std::size_t size) {
        hashes_ += hash_text({static_cast<const char*>(bytes), size});
    }
    std::string hashes_;
};

void add_cage(const Cage& cage, Digest& digest) {
    digest.add(cage.points);
    digest.add_value(static_cast<int>(cage.scheme));
    digest.add_value(static_cast<int>(cage.interpolate_boundary));
    digest.add(cage.crease_sharpnesses);
    digest.add(cage.corner_sharpnesses);
    for (const std::vector<int>* list :
         {&cage.face_vertex_counts, &cage.face_vertex_indices, &cage.crease_indices, &cage.crease_lengths,
          &cage.corner_indices, &cage.hole_indices})
        digest.add(*list);
}

}  // namespace

std::string world_digest(const World& world) {
    Digest digest;
    digest.add(world.objects.points);
    digest.add(world.objects.triangles);
    digest.add(world.objects.object);
    digest.add(world.shading.material);
    digest.add(world.shading.uvs);
    digest.add(world.shading.normals);
    for (const Material& m : world.shading.materials) {
        digest.add_numbers({m.base_color_factor.x, m.base_color_factor.y, m.base_color_factor.z,
                            m.metallic_factor, m.roughness_factor, m.transmission_factor, m.ior,
                            m.unlit ? 1.0 : 0.0});
        digest.add_texture(m.base_color_texture);
    }
    digest.add_texture(world.shading.background.environment);
    for (const Optic& optic : world.optics) add_cage(world.scene.meshes[optic.mesh].cage, digest);
    return digest.digits();
}

}  // namespace trilens
