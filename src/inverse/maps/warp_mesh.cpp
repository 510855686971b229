#include "inverse/maps/film_map.h"

#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/maps/film_targets.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// What makes nodes: places of one film in, their places on the target out.
struct MeshMaker {
    const World& world;
    const FilmMapRequest& request;
    Target target;
    Proxy proxy;
    FilmTargetsParams params;

    MeshMaker(const World& of, const FilmMapRequest& asked)
        : world(of),
          request(asked),
          target(asked.target, of.scene),
          proxy(asked.proxy, of, center_of_directions(of, asked.center, asked.optic)) {
        if (!target.has_directions())
            throw UsageError("a warp mesh is of a picture of directions: fisheye, equirect or cubemap");
        params.shoot = {asked.frame.camera, asked.word};
        params.optic = asked.optic;
        params.over_optics = !of.optics.empty();
    }

    std::vector<MapImages> find(const std::vector<Vec2>& places) const {
        std::vector<MapImages> found(places.size());
        find_film_targets(world, params, target, proxy, places, found);
        return found;
    }
};

Vec2 node_place(const WarpMesh& mesh, double x, double y) {
    return {x / (mesh.columns - 1) * mesh.film_width, y / (mesh.rows - 1) * mesh.film_height};
}

/// Solid angle per film pixel.
double spread_of(const MapImage& image, const Target& target) {
    const std::optional<TargetPlace> place = target.place(image.position);
    const Mat2& j = image.jacobian;
    return place ? std::fabs(j[0].x * j[1].y - j[1].x * j[0].y) * target.measure(*place) : 0;
}

WarpMesh nodes_of(const MeshMaker& maker, int columns, int rows) {
    const Film& film = maker.world.scene.film;
    WarpMesh mesh;
    mesh.columns = columns;
    mesh.rows = rows;
    mesh.film_width = film.width;
    mesh.film_height = film.height;
    mesh.target_width = maker.request.target.width;
    mesh.target_height = maker.request.target.height;
    std::vector<Vec2> places;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) places.push_back(node_place(mesh, x, y));
    const std::vector<MapImages> found = maker.find(places);
    std::vector<double> spreads;
    for (std::size_t n = 0; n < places.size(); ++n) {
        WarpNode node{places[n]};
        if (!found[n].empty()) {
            node.target = found[n][0].position;
            node.intensity = spread_of(found[n][0], maker.target);
            spreads.push_back(node.intensity);
        }
        mesh.nodes.push_back(node);
    }
    if (spreads.empty())
        throw InputError(scene_title(maker.world.scene), "", "the film shows nothing of the target");
    const auto p95 = spreads.begin() + static_cast<std::ptrdiff_t>(0.95 * double(spreads.size() - 1));
    std::nth_element(spreads.begin(), p95, spreads.end());
    for (WarpNode& node : mesh.nodes)
        if (node.intensity >= 0) node.intensity = *p95 > 0 ? std::min(1.0, node.intensity / *p95) : 1;
    return mesh;
}

/// Errors in the middle of cells whose nodes are all drawn; those across a seam of the target (more than half
/// of it wide) are left out.
void measure(const MeshMaker& maker, WarpMesh& mesh) {
    std::vector<Vec2> places, interpolated;
    for (int y = 0; y + 1 < mesh.rows; ++y)
        for (int x = 0; x + 1 < mesh.columns; ++x) {
            Vec2 sum(0), low(1e300), high(-1e300);
            bool drawn = true;
            for (int k = 0; k < 4; ++k) {
                const WarpNode& node = mesh.at(x + k % 2, y + k / 2);
                drawn = drawn && node.intensity >= 0;
                sum += node.target;
                low = glm::min(low, node.target);
                high = glm::max(high, node.target);
            }
            if (!drawn || high.x - low.x > 0.5 * mesh.target_width) continue;
            places.push_back(node_place(mesh, x + 0.5, y + 0.5));
            interpolated.push_back(0.25 * sum);
        }
    const std::vector<MapImages> found = maker.find(places);
    std::vector<double> errors;
    double sum = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (found[i].empty()) continue;
        errors.push_back(length(found[i][0].position - interpolated[i]));
        sum += errors.back();
    }
    if (errors.empty()) return;
    std::sort(errors.begin(), errors.end());
    mesh.error_mean = sum / double(errors.size());
    mesh.error_p99 = errors[static_cast<std::size_t>(0.99 * double(errors.size() - 1))];
    mesh.error_max = errors.back();
}

/// Nodes that show nothing beside ones that do: the mean of what these and those behind them go on to.
void extend_rim(WarpMesh& mesh) {
    const WarpMesh old = mesh;
    for (int y = 0; y < mesh.rows; ++y)
        for (int x = 0; x < mesh.columns; ++x) {
            if (old.at(x, y).intensity >= 0) continue;
            Vec2 sum(0);
            int count = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int fx = x + 2 * dx, fy = y + 2 * dy;
                    if ((dx == 0 && dy == 0) || fx < 0 || fy < 0 || fx >= mesh.columns || fy >= mesh.rows)
                        continue;
                    const WarpNode &near = old.at(x + dx, y + dy), &far = old.at(fx, fy);
                    if (near.intensity < 0 || far.intensity < 0) continue;
                    sum += 2.0 * near.target - far.target;
                    ++count;
                }
            if (count == 0) continue;
            WarpNode& node = mesh.nodes[static_cast<std::size_t>(y) * static_cast<std::size_t>(mesh.columns) +
                                        static_cast<std::size_t>(x)];
            node.target = sum / double(count);
            node.intensity = 0;
        }
}

}  // namespace

std::size_t WarpMesh::drawn_count() const {
    return static_cast<std::size_t>(
        std::count_if(nodes.begin(), nodes.end(), [](const WarpNode& node) { return node.intensity > 0; }));
}

WarpMesh make_warp_mesh(const World& world, const FilmMapRequest& request, const WarpMeshParams& params,
                        const Progress& progress) {
    const bool chooses = params.columns == 0 && params.rows == 0;
    if (!chooses && (params.columns < 2 || params.rows < 2 || params.columns > 8193 || params.rows > 8193))
        throw UsageError("a warp mesh has 2 to 8193 nodes a side");
    if (!(params.max_error > 0)) throw UsageError("the largest error is a positive number of pixels");
    const MeshMaker maker(world, request);
    const double aspect = double(world.scene.film.height) / world.scene.film.width;
    const auto rows_for = [&](int columns) {
        return std::max(2, static_cast<int>((columns - 1) * aspect + 0.5) + 1);
    };
    int columns = chooses ? 33 : params.columns;
    while (true) {
        WarpMesh mesh = nodes_of(maker, columns, chooses ? rows_for(columns) : params.rows);
        measure(maker, mesh);
        if (progress.cancelled()) throw Interrupted();
        if (!chooses || mesh.error_p99 <= params.max_error || columns >= kMostWarpColumns) {
            extend_rim(mesh);
            progress(1);
            return mesh;
        }
        // The error falls with the square of the cells' size; near the rim more slowly.
        const double finer = std::clamp(1.1 * std::sqrt(mesh.error_p99 / params.max_error), 1.2, 4.0);
        columns = std::min(kMostWarpColumns, static_cast<int>(finer * (columns - 1)) + 1);
        progress(double(columns) / kMostWarpColumns);
    }
}

std::string bourke_mesh(const WarpMesh& mesh) {
    std::string text = fmt::format("2\n{} {}\n", mesh.columns, mesh.rows);
    for (int y = mesh.rows - 1; y >= 0; --y)
        for (int x = 0; x < mesh.columns; ++x) {
            const WarpNode& node = mesh.at(x, y);
            text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.6g}\n",
                                (2 * node.film.x - mesh.film_width) / mesh.film_height,
                                1 - 2 * node.film.y / mesh.film_height, node.target.x / mesh.target_width,
                                1 - node.target.y / mesh.target_height, node.intensity);
        }
    return text;
}

std::string obj_mesh(const WarpMesh& mesh) {
    std::string text =
        "# warp mesh: v in the film's -aspect..aspect and -1..1, vt in the projected picture\n";
    for (const WarpNode& node : mesh.nodes)
        text += fmt::format("v {:.9g} {:.9g} 0\nvt {:.9g} {:.9g}\n",
                            (2 * node.film.x - mesh.film_width) / mesh.film_height,
                            1 - 2 * node.film.y / mesh.film_height, node.target.x / mesh.target_width,
                            1 - node.target.y / mesh.target_height);
    for (int y = 0; y + 1 < mesh.rows; ++y)
        for (int x = 0; x + 1 < mesh.columns; ++x) {
            if (mesh.at(x, y).intensity < 0 || mesh.at(x + 1, y).intensity < 0 ||
                mesh.at(x, y + 1).intensity < 0 || mesh.at(x + 1, y + 1).intensity < 0)
                continue;
            const int a = y * mesh.columns + x + 1, b = a + mesh.columns;
            text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", b, b + 1, a + 1, a);
        }
    return text;
}

}  // namespace trilens
