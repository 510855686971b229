#include "inverse/maps/film_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_targets.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// Of a fisheye's radius: its outermost ring lies within its circle.
constexpr double kJustInside = 1 - 1e-9;
/// Cells whose errors are measured: of more every second, third... is.
constexpr std::size_t kMostMeasured = 50'000;
constexpr std::size_t kFewestAtOnce = 64, kMostAtOnce = 1 << 13;  // places between two reports
/// Of a fisheye's mesh, so that its cells are about square a third of the way out.
constexpr double kRingsPerRay = 0.5;
/// So many times the columns in a step, at most.
constexpr double kLargestStep = 4;

/// What makes nodes: places where a mesh is regular in, their places on the other side out, on the target or
/// on the film.
struct MeshMaker {
    const World& world;
    const FilmMapRequest& request;
    WarpGrid grid;
    Target target;
    Proxy proxy;
    FilmTargetsParams to_target;
    FilmImagesParams to_film;
    const Progress& progress;
    double begun = 0, each = 0;  // share of the work that is done, and of one place

    MeshMaker(const World& of, const FilmMapRequest& asked, WarpGrid regular_on, const Progress& reports)
        : world(of),
          request(asked),
          grid(regular_on),
          target(asked.target, of.scene),
          proxy(asked.proxy, of, center_of_directions(of, asked.center, asked.optic)),
          progress(reports) {
        if (!target.has_directions())
            throw UsageError("a warp mesh is of a picture of directions: fisheye, equirect or cubemap");
        if (grid == WarpGrid::kTarget && asked.target.kind == TargetKind::kCubemap)
            throw UsageError("a mesh that is regular on its target is of a fisheye or an equirect");
        if (grid == WarpGrid::kTarget && asked.word.asks())
            throw UsageError("a word of events goes with meshes that are regular on the film");
        if (grid == WarpGrid::kFilm && asked.path)
            throw UsageError("a path goes with meshes that are regular on their target; else, a word");
        to_target.shoot = {asked.frame.camera, asked.word};
        to_target.optic = asked.optic;
        to_target.over_optics = !of.optics.empty();
        to_film = {asked.frame, asked.optic, asked.path, proxy.is_hidden_by_objects()};
        to_film.beyond_film = !to_film.objects_hide;
    }

    /// Whether places lie in columns and rows.
    bool is_straight() const { return is_on_film() || request.target.kind != TargetKind::kFisheye; }
    bool is_on_film() const { return grid == WarpGrid::kFilm; }
    /// The side of a node that is regular, and the one that is found.
    Vec2 WarpNode::*regular() const { return is_on_film() ? &WarpNode::film : &WarpNode::target; }
    Vec2 WarpNode::*found() const { return is_on_film() ? &WarpNode::target : &WarpNode::film; }

    /// In columns and rows of a mesh, from its first node.
    Vec2 place(const WarpMesh& mesh, double x, double y) const {
        const Vec2 share(x / (mesh.columns - 1), y / (mesh.rows - 1));
        if (is_on_film()) return share * Vec2(mesh.film_width, mesh.film_height);
        const Vec2 size(mesh.target_width, mesh.target_height);
        if (is_straight()) return share * size;
        const double angle = 2 * std::numbers::pi * share.x;
        return 0.5 * size * (Vec2(1) + kJustInside * share.y * Vec2(std::sin(angle), std::cos(angle)));
    }

    /// The places of a mesh of so many nodes, and those at which it is measured, as shares of the work.
    void begin(std::size_t nodes, double from, double to) {
        const std::size_t measured = (is_straight() ? 3 : 5) * std::min(nodes, 2 * kMostMeasured);
        begun = from;
        each = (to - from) / static_cast<double>(nodes + measured);
    }

    std::vector<MapImages> find(const std::vector<Vec2>& places, bool with_jacobians) {
        std::vector<MapImages> found(places.size());
        FilmTargetsParams asked = to_target;
        asked.with_jacobians = with_jacobians;
        Portions portions(kFewestAtOnce, kMostAtOnce);
        for (std::size_t first = 0, count = 0; first < places.size(); first += count) {
            progress.stop_if_cancelled();
            count = portions.next(places.size() - first);
            const std::span<const Vec2> some = std::span(places).subspan(first, count);
            const std::span<MapImages> here = std::span(found).subspan(first, count);
            if (is_on_film())
                find_film_targets(world, asked, target, proxy, some, here);
            else
                find_film_images(world, to_film, world_places(target, proxy, some), here);
            begun += each * static_cast<double>(count);
            progress(std::min(1.0, begun));
        }
        return found;
    }
};

/// Of a mesh that is regular on its target the first and the last column are one, and the mesh goes round.
void join_seam(WarpMesh& mesh, Vec2 WarpNode::*found) {
    if (mesh.grid == WarpGrid::kFilm) return;
    const auto columns = static_cast<std::size_t>(mesh.columns);
    for (std::size_t first = 0; first < mesh.nodes.size(); first += columns) {
        WarpNode& last = mesh.nodes[first + columns - 1];
        last.*found = mesh.nodes[first].*found;
        last.intensity = mesh.nodes[first].intensity;
    }
}

/// Solid angle per film pixel.
double spread_of(const WarpNode& node, const MapImage& image, const MeshMaker& maker) {
    const std::optional<TargetPlace> place = maker.target.place(node.target);
    const double det = std::fabs(glm::determinant(image.jacobian));
    if (!place || !(det > 0)) return 0;
    return maker.target.measure(*place) * (maker.is_on_film() ? det : 1 / det);
}

/// Of several the best resolved.
const MapImage& image_of_node(const MeshMaker& maker, const MapImages& images) {
    return maker.is_on_film() ? images[0] : best_resolved(images);
}

WarpMesh nodes_of(MeshMaker& maker, int columns, int rows) {
    const Film& film = maker.world.scene.film;
    WarpMesh mesh;
    mesh.grid = maker.grid;
    mesh.columns = columns;
    mesh.rows = rows;
    mesh.film_width = film.width;
    mesh.film_height = film.height;
    mesh.target_width = maker.request.target.width;
    mesh.target_height = maker.request.target.height;
    std::vector<Vec2> places;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) places.push_back(maker.place(mesh, x, y));
    const std::vector<MapImages> found = maker.find(places, true);
    std::vector<double> spreads;
    for (std::size_t n = 0; n < places.size(); ++n) {
        WarpNode node;
        node.*maker.regular() = places[n];
        if (!found[n].empty()) {
            const MapImage& image = image_of_node(maker, found[n]);
            node.*maker.found() = image.position;
            node.intensity = spread_of(node, image, maker);
            spreads.push_back(node.intensity);
        }
        mesh.nodes.push_back(node);
    }
    if (spreads.empty())
        throw InputError(scene_title(maker.world.scene), "",
                         "no node of the mesh shows anything of the target");
    const auto p95 = spreads.begin() + static_cast<std::ptrdiff_t>(0.95 * double(spreads.size() - 1));
    std::nth_element(spreads.begin(), p95, spreads.end());
    for (WarpNode& node : mesh.nodes)
        if (node.intensity >= 0) node.intensity = *p95 > 0 ? std::min(1.0, node.intensity / *p95) : 1;
    join_seam(mesh, maker.found());
    return mesh;
}

/// Nodes of a cell, 0 1 above, 2 3 below, in whose mean programs draw the mean of their places on the other
/// side.
using Means = std::vector<std::vector<int>>;

/// By place in the cell, where what is linear on two triangles, cut along either diagonal, or bilinear is off
/// the farthest as long as cells are so small that their maps are of second degree: its middle, and two of
/// its sides.
const std::array<Means, 3>& probes() {
    static const std::array<Means, 3> kProbes{Means{{0, 1, 2, 3}, {0, 3}, {1, 2}}, Means{{0, 1}},
                                              Means{{0, 2}}};
    return kProbes;
}

using Cell = std::array<int, 2>;  // its upper left node

Vec2 mean_of(const WarpMesh& mesh, const Cell& cell, const std::vector<int>& nodes, Vec2 WarpNode::*side) {
    Vec2 sum(0);
    for (const int k : nodes) sum += mesh.at(cell[0] + k % 2, cell[1] + k / 2).*side;
    return sum / double(nodes.size());
}

/// Upper left nodes of cells whose nodes are all drawn, but for those of the film across a seam of the target
/// (more than half of it wide).
std::vector<Cell> whole_cells(const WarpMesh& mesh) {
    std::vector<Cell> cells;
    for (int y = 0; y + 1 < mesh.rows; ++y)
        for (int x = 0; x + 1 < mesh.columns; ++x) {
            double low = 1e300, high = -1e300;
            bool drawn = true;
            for (int k = 0; k < 4; ++k) {
                const WarpNode& node = mesh.at(x + k % 2, y + k / 2);
                drawn = drawn && node.intensity >= 0;
                low = std::min(low, node.target.x);
                high = std::max(high, node.target.x);
            }
            const bool is_seam = mesh.grid == WarpGrid::kFilm && high - low > 0.5 * mesh.target_width;
            if (drawn && !is_seam) cells.push_back({x, y});
        }
    return cells;
}

std::vector<Cell> evenly_spread(const std::vector<Cell>& cells, std::size_t most) {
    const std::size_t step = std::max<std::size_t>(1, cells.size() / most);
    std::vector<Cell> some;
    for (std::size_t i = 0; i < cells.size(); i += step) some.push_back(cells[i]);
    return some;
}

/// Errors of whole cells, if there are.
void measure(MeshMaker& maker, WarpMesh& mesh) {
    const std::vector<Cell> cells = evenly_spread(whole_cells(mesh), kMostMeasured);
    std::vector<double> errors(cells.size(), -1);
    for (const Means& means : probes()) {
        std::vector<MapImages> found;
        for (std::size_t m = 0; m < means.size(); ++m) {
            if (m == 0 || !maker.is_straight()) {  // else all means are of one place
                std::vector<Vec2> places;
                for (const Cell& cell : cells)
                    places.push_back(mean_of(mesh, cell, means[m], maker.regular()));
                found = maker.find(places, !maker.is_on_film());
            }
            for (std::size_t i = 0; i < cells.size(); ++i) {
                if (found[i].empty()) continue;
                const Vec2 exact = image_of_node(maker, found[i]).position;
                errors[i] =
                    std::max(errors[i], length(exact - mean_of(mesh, cells[i], means[m], maker.found())));
            }
        }
    }
    std::erase(errors, -1);
    if (errors.empty()) return;
    std::sort(errors.begin(), errors.end());
    mesh.error = {std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size()),
                  errors[static_cast<std::size_t>(0.99 * double(errors.size() - 1))], errors.back()};
}

/// Nodes that show nothing beside ones that do: the mean of what these and those behind them go on to.
void extend_rim(WarpMesh& mesh, Vec2 WarpNode::*found) {
    const WarpMesh old = mesh;
    const int around = mesh.columns - 1;
    const auto column = [&](int x) {  // its own: beyond the film's, none
        return mesh.grid == WarpGrid::kFilm ? x : (x + 2 * around) % around;
    };
    for (int y = 0; y < mesh.rows; ++y)
        for (int x = 0; x < mesh.columns; ++x) {
            if (old.at(x, y).intensity >= 0) continue;
            Vec2 sum(0);
            int count = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int nx = column(x + dx), fx = column(x + 2 * dx), fy = y + 2 * dy;
                    if ((dx == 0 && dy == 0) || fx < 0 || fy < 0 || fx >= mesh.columns || fy >= mesh.rows)
                        continue;
                    const WarpNode &near = old.at(nx, y + dy), &far = old.at(fx, fy);
                    if (near.intensity < 0 || far.intensity < 0) continue;
                    sum += 2.0 * (near.*found) - far.*found;
                    ++count;
                }
            if (count == 0) continue;
            WarpNode& node = mesh.nodes[static_cast<std::size_t>(y) * static_cast<std::size_t>(mesh.columns) +
                                        static_cast<std::size_t>(x)];
            node.*found = sum / double(count);
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
    MeshMaker maker(world, request, params.grid, progress);
    const double aspect = maker.is_on_film()     ? double(world.scene.film.height) / world.scene.film.width
                          : !maker.is_straight() ? kRingsPerRay
                                                 : double(request.target.height) / request.target.width;
    const auto rows_for = [&](int columns) {
        return std::max(2, static_cast<int>((columns - 1) * aspect + 0.5) + 1);
    };
    int columns = chooses ? 33 : params.columns;
    double done = 0;
    while (true) {
        const int rows = chooses ? rows_for(columns) : params.rows;
        const double until = chooses ? double(columns) / kMostWarpColumns : 1;
        maker.begin(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), done, until);
        done = until;
        WarpMesh mesh = nodes_of(maker, columns, rows);
        measure(maker, mesh);
        if (!chooses || (mesh.error && mesh.error->p99 <= params.max_error) || columns >= kMostWarpColumns) {
            extend_rim(mesh, maker.found());
            progress(1);
            return mesh;
        }
        // The error falls with the square of the cells' size; near the rim more slowly.
        const double finer =
            mesh.error ? std::clamp(1.1 * std::sqrt(mesh.error->p99 / params.max_error), 1.2, kLargestStep)
                       : kLargestStep;
        columns = std::min(kMostWarpColumns, static_cast<int>(finer * (columns - 1)) + 1);
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
