// The light that was baked into a mesh, and the triangles that it was baked for.
#include <string>

#include "scene/data/baked_light.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr double kMostWeightedCorners = 1e40;  // of coordinates up to 1e30

Field<BakedLightRecord> by_hand(const char* key, Json values, const char* help) {
    return part<BakedLightRecord>(key, std::move(values), help);
}

void split_triangles(const Node& splits, ObjectMesh& object) {
    if (splits.size() % 2 != 0) splits.fail("are pairs of a triangle and an edge, but their count is odd");
    TriangleSplitter splitter(object);
    for (std::size_t i = 0; i < splits.size(); i += 2) {
        const auto triangle = splits.json.at(i).get<std::size_t>();
        const int edge = splits.json.at(i + 1).get<int>();
        if (triangle >= object.triangles.size())
            splits[i].fail("there is no triangle " + std::to_string(triangle) + " by then, but " +
                           std::to_string(object.triangles.size()));
        if (edge > 2) splits[i + 1].fail("a triangle has the edges 0, 1 and 2");
        splitter.split({static_cast<Id>(triangle), edge});
    }
}

/// One side's light, corner by corner.
void read_side(const Node& baked, const char* key, std::array<Vec3, 3> BakedLight::*side,
               ObjectMesh& object) {
    if (!baked.has(key)) return;
    const Node indices = baked[key];
    const Node colors = baked["colors"];
    if (indices.size() != 3 * object.triangles.size())
        indices.fail("has " + std::to_string(indices.size()) + " entries, must have " +
                     std::to_string(3 * object.triangles.size()) + ": one per corner of each triangle");
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const auto index = indices.json.at(i).get<std::size_t>();
        if (index >= colors.size())
            indices[i].fail("index " + std::to_string(index) + " is out of range: there are " +
                            std::to_string(colors.size()) + " colors");
        (object.baked[i / 3].*side)[i % 3] = to_vec3(colors.json.at(index));
    }
}

}  // namespace

Json baked_light_schema() {
    const std::vector<Field<BakedLightRecord>> fields{
        by_hand("triangles", ref("index"),
                "How many the mesh had when its light was baked: of another mesh it is refused."),
        by_hand(
            "corners", several(3, number_in(-kMostWeightedCorners, kMostWeightedCorners)),
            "A sum over the corners of these triangles in the scene, each times a weight of its own: light "
            "of a "
            "mesh whose points or corners are others is refused. Without it only their number is looked at."),
        by_hand("splits", list_of(ref("index")),
                "Pairs of a triangle and its edge 0, 1 or 2, in order: the triangle is halved by that edge's "
                "midpoint, and its second half comes last."),
        by_hand("colors", list_of(ref("color")), "Irradiance over pi, in the units of the lights."),
        by_hand("front", list_of(ref("index")),
                "Of 'colors', three per triangle after the splits: on the side that shows its corners "
                "anticlockwise."),
        by_hand("back", list_of(ref("index")), "On the other side; without it, none.")};
    return object_schema({.title = "baked light",
                          .description = "Light that an object has beside what the lights send, as "
                                         "'trilens bake' writes it: linear between the corners.",
                          .required = {"triangles", "colors"}},
                         fields);
}

void read_baked_light(const Node& baked, ObjectMesh& object) {
    const auto triangles = baked["triangles"].json.get<std::size_t>();
    if (triangles != object.triangles.size())
        baked["triangles"].fail("the light was baked for a mesh of " + std::to_string(triangles) +
                                " triangles, but this one has " + std::to_string(object.triangles.size()) +
                                ": bake it again");
    if (baked.has("corners") && !has_corners(object, to_vec3(baked["corners"].json)))
        baked["corners"].fail(
            "the light was baked for a mesh whose points or corners are not where this one has them: bake it "
            "again");
    if (baked.has("splits")) split_triangles(baked["splits"], object);
    object.baked.assign(object.triangles.size(), {});
    read_side(baked, "front", &BakedLight::front, object);
    read_side(baked, "back", &BakedLight::back, object);
}

}  // namespace trilens
