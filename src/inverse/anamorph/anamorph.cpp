#include "inverse/anamorph/anamorph.h"

#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_witness.h"
#include "inverse/maps/sampled_map.h"
#include "inverse/unwrap/photo.h"
#include "render/frame/frame.h"
#include "render/shoot/shoot.h"
#include "render/world/world.h"

namespace trilens {

namespace {

constexpr int kMostCells = 384;      // of the film's longer side, where the window is looked for
constexpr double kOutlineMm = 0.25;  // above the page the mirrors' outlines are cut

/// Where the paper lies, and how: millimetres of the page to the world and back.
struct PaperPlace {
    FlatRectangle rectangle;
    Vec3 right{0}, up{0}, normal{0};  // unit
    double mm = 1;                    // scene units

    Vec2 mm_of(const Vec3& point) const {
        const Vec3 way = point - rectangle.origin;
        return Vec2(dot(way, right), dot(way, up)) / mm;
    }
};

PaperPlace place_paper(const World& world, const AnamorphRequest& request, AnamorphPage& page) {
    const Mesh& mesh = world.scene.meshes[request.page];
    if (mesh.role != Role::kObject)
        throw InputError(scene_title(world.scene), mesh.name, "is an optic: a page is a flat object");
    const std::optional<FlatRectangle> flat = flat_rectangle(mesh.object);
    if (!flat) throw InputError(scene_title(world.scene), mesh.name, "is not flat: a page is one plane");
    PaperPlace place;
    place.mm = 1e-3 / request.unit;
    page.paper = request.paper.value_or(PaperSize{length(flat->u) / place.mm, length(flat->v) / place.mm});
    place.right = normalize_or_zero(flat->u);
    place.up = normalize_or_zero(flat->v);
    place.normal = flat->normal();

    // Its printed side is the one that the mirrors stand on.
    const Vec3 middle = flat->origin + 0.5 * (flat->u + flat->v);
    double above = 0;
    for (std::size_t o = 0; o < world.optics.size(); ++o)
        for (const Vec3& point : optic_facets(world, o, world.optics[o].resolution)->grid().points)
            above += dot(point - middle, place.normal);
    if (above < 0) place.right = -place.right, place.normal = -place.normal;
    place.rectangle.u = page.paper.width * place.mm * place.right;
    place.rectangle.v = page.paper.height * place.mm * place.up;
    place.rectangle.origin = middle - 0.5 * (place.rectangle.u + place.rectangle.v);
    page.place = place.rectangle;
    return place;
}

/// Where the grids of mirrors cut the plane a little above the page.
std::vector<PageLine> outlines_of(const World& world, const PaperPlace& place) {
    std::vector<PageLine> lines;
    for (std::size_t o = 0; o < world.optics.size(); ++o) {
        const auto facets = optic_facets(world, o, 64);
        const SurfaceGrid& grid = facets->grid();
        for (const IdTriple& facet : grid.facets) {
            std::vector<Vec2> cuts;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 &a = grid.points[grid.corner_point[facet[k]]],
                           &b = grid.points[grid.corner_point[facet[(k + 1) % 3]]];
                const double ha = dot(a - place.rectangle.origin, place.normal) - kOutlineMm * place.mm;
                const double hb = dot(b - place.rectangle.origin, place.normal) - kOutlineMm * place.mm;
                if ((ha < 0) != (hb < 0)) cuts.push_back(place.mm_of(a + ha / (ha - hb) * (b - a)));
            }
            if (cuts.size() == 2) lines.push_back({cuts[0], cuts[1]});
        }
    }
    return lines;
}

/// Whether film places show the paper over a mirror.
std::vector<unsigned char> shows_paper(const World& world, const AnamorphRequest& request,
                                       const PaperPlace& place, const PaperSize& paper,
                                       const std::vector<Vec2>& places) {
    ShootRequest shoot;
    shoot.camera = request.frame.camera;
    const ShotRays shots = shoot_places(world, shoot, places);
    std::vector<unsigned char> shows(places.size(), 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const ShotRay& shot = shots.rays[i];
        if (!shot.followed() || shot.event_count == 0) continue;
        if (request.optic && shots.events_of(shot)[0].optic != *request.optic) continue;
        const double t =
            dot(place.rectangle.origin - shot.origin, place.normal) / dot(shot.direction, place.normal);
        if (!(t > 0) || !std::isfinite(t)) continue;
        if (shot.state == ShotState::kSeen && shot.object != request.page && shot.t < t) continue;
        const Vec2 mm = place.mm_of(shot.origin + t * shot.direction);
        shows[i] = mm.x >= 0 && mm.y >= 0 && mm.x <= paper.width && mm.y <= paper.height;
    }
    return shows;
}

/// Middles of columns x rows cells of a window.
std::vector<Vec2> cell_middles(const PictureWindow& window, int columns, int rows) {
    std::vector<Vec2> places;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            places.emplace_back(window[0] + (x + 0.5) / columns * (window[2] - window[0]),
                                window[1] + (y + 0.5) / rows * (window[3] - window[1]));
    return places;
}

PictureWindow find_window(const World& world, const AnamorphRequest& request, const PaperPlace& place,
                          const PaperSize& paper) {
    const Film& film = world.scene.film;
    const double step = std::max(1.0, std::max(film.width, film.height) / double(kMostCells));
    const int columns = std::max(1, static_cast<int>(film.width / step)),
              rows = std::max(1, static_cast<int>(film.height / step));
    const PictureWindow whole{0, 0, double(film.width), double(film.height)};
    const auto window = largest_window(
        shows_paper(world, request, place, paper, cell_middles(whole, columns, rows)), columns, rows,
        {film.width, film.height}, double(request.picture->width) / request.picture->height);
    if (!window)
        throw InputError(scene_title(world.scene), world.scene.meshes[request.page].name,
                         "is not seen in a mirror: there is nothing to print on");
    return *window;
}

/// Colours of the page, pixel by pixel.
class PagePainter {
  public:
    PagePainter(const AnamorphRequest& request, const PictureWindow& window, double dot_mm)
        : request_(request), window_(window), dot_mm_(dot_mm) {
        scale_ = Vec2(request.picture->width / (window[2] - window[0]),
                      request.picture->height / (window[3] - window[1]));
    }

    struct Dot {
        bool drawn = false;
        Vec3 colour{1};
        double lost = 0;  // square pixels of the film that show the dot beside the image that it fits
    };

    Dot paint(std::span<const MapImage> images) const {
        Dot dot;
        const MapImage* best = nullptr;
        double largest = 0, all = 0;
        for (const MapImage& image : images) {
            if (!inside(image.position)) continue;
            const double area = film_area(image);
            all += area;
            if (!best || area > largest) best = &image, largest = area;
        }
        if (!best) best = bleeding(images);
        if (!best) return dot;
        dot.drawn = true;
        dot.lost = std::max(0.0, all - largest);
        const Vec2 at =
            scale_ * (glm::clamp(best->position, Vec2(window_[0], window_[1]), Vec2(window_[2], window_[3])) -
                      Vec2(window_[0], window_[1]));
        Mat2 jacobian = best->jacobian;
        for (int k = 0; k < 2; ++k) jacobian[k] = scale_ * jacobian[k];
        dot.colour = sample_footprint(*request_.picture, at, jacobian);
        return dot;
    }

  private:
    bool inside(const Vec2& at) const {
        return at.x >= window_[0] && at.y >= window_[1] && at.x <= window_[2] && at.y <= window_[3];
    }
    static double film_area(const MapImage& image) {
        return std::fabs(image.jacobian[0].x * image.jacobian[1].y -
                         image.jacobian[1].x * image.jacobian[0].y);
    }
    /// An image that lies beyond the window by no more than the bleed, on the page.
    const MapImage* bleeding(std::span<const MapImage> images) const {
        for (const MapImage& image : images) {
            const Vec2 low(window_[0], window_[1]), high(window_[2], window_[3]);
            const Vec2 off = image.position - glm::clamp(image.position, low, high);
            if (film_area(image) > 0 &&
                length(glm::inverse(image.jacobian) * off) * dot_mm_ <= request_.bleed)
                return &image;
        }
        return nullptr;
    }

    const AnamorphRequest& request_;
    PictureWindow window_;
    double dot_mm_;
    Vec2 scale_{1};
};

void paint_page(const SampledMap& map, const PagePainter& painter, Anamorph& made) {
    AnamorphPage& page = made.page;
    const auto width = static_cast<std::size_t>(page.width);
    const std::size_t dots = width * static_cast<std::size_t>(page.height);
    page.rgb.assign(3 * dots, 1);
    std::vector<float> lost(dots, 0);
    std::vector<unsigned char> drawn(dots, 0);
    map.for_each_pixel([&](int x, int y, std::span<const MapImage> images) {
        const PagePainter::Dot dot = painter.paint(images);
        if (!dot.drawn) return;
        const std::size_t at = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
        for (std::size_t c = 0; c < 3; ++c)
            page.rgb[3 * at + c] = static_cast<float>(std::min(1.0, dot.colour[static_cast<int>(c)]));
        lost[at] = static_cast<float>(dot.lost);
        drawn[at] = 1;
    });
    double sum = 0;
    std::size_t x0 = width, x1 = 0, y0 = dots, y1 = 0;
    for (std::size_t at = 0; at < dots; ++at) {
        sum += lost[at];
        if (!drawn[at]) continue;
        x0 = std::min(x0, at % width), x1 = std::max(x1, at % width + 1);
        y0 = std::min(y0, at / width), y1 = std::max(y1, at / width + 1);
    }
    const PictureWindow& w = made.window;
    made.conflict = std::min(1.0, sum / ((w[2] - w[0]) * (w[3] - w[1])));
    if (x1 == 0) return;
    const double wide = page.paper.width / page.width, high = page.paper.height / page.height,
                 top = page.paper.height;
    made.extents = {double(x0) * wide, top - double(y1) * high, double(x1) * wide, top - double(y0) * high};
}

void check_request(const World& world, const AnamorphRequest& request) {
    if (!request.picture || request.picture->width < 1) throw UsageError("there is no picture");
    if (request.page >= world.scene.meshes.size()) throw UsageError("there is no such page");
    if (world.optics.empty()) throw InputError(scene_title(world.scene), "", "has no mirror to look into");
    if (request.optic && *request.optic >= world.optics.size()) throw UsageError("there is no such optic");
    for (std::size_t o = 0; o < world.optics.size(); ++o)
        if (!world.optics[o].mirror && (!request.optic || *request.optic == o))
            throw InputError(scene_title(world.scene), world.names[world.optics[o].mesh],
                             "is glass: an anamorphosis is seen in a mirror");
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    if (!positive(request.dpi) || !positive(request.unit) || !positive(request.tolerance) ||
        !(request.bleed >= 0))
        throw UsageError(
            "dots per inch, unit and tolerance are positive numbers, and the bleed is at least 0");
    if (!request.window) return;
    const PictureWindow& w = *request.window;
    if (!(w[0] < w[2] && w[1] < w[3])) throw UsageError("the window is x0,y0,x1,y1 with x0 < x1 and y0 < y1");
}

}  // namespace

Anamorph make_anamorph(const World& world, const AnamorphRequest& request, const Progress& progress) {
    check_request(world, request);
    Anamorph made;
    AnamorphPage& page = made.page;
    const PaperPlace place = place_paper(world, request, page);
    page.dpi = request.dpi;
    const double width = std::round(page.paper.width / 25.4 * request.dpi),
                 height = std::round(page.paper.height / 25.4 * request.dpi);
    if (width < 1 || height < 1 || width * height > double(kMostPixels))
        throw UsageError(
            fmt::format("a page of {:.4g} x {:.4g} mm at {:.4g} dots per inch has {:.0f} x {:.0f} dots: "
                        "at most {} in all; is the unit right?",
                        page.paper.width, page.paper.height, request.dpi, width, height, kMostPixels));
    page.width = static_cast<int>(width);
    page.height = static_cast<int>(height);
    page.outlines = outlines_of(world, place);
    made.window = request.window ? *request.window : find_window(world, request, place, page.paper);
    const std::vector<unsigned char> shows =
        shows_paper(world, request, place, page.paper, cell_middles(made.window, 256, 256));
    made.coverage = double(std::count(shows.begin(), shows.end(), 1)) / double(shows.size());

    // Page dot -> world -> film.
    const Vec3 dx = place.rectangle.u / width, dy = -place.rectangle.v / height,
               top_left = place.rectangle.origin + place.rectangle.v;
    const FilmImagesParams params{request.frame, request.optic, Path::kReflect, true, false, progress.cancel};
    PlacesOnFilm dots{params, {page.width, page.height, 32, request.tolerance}, {}, {}};
    dots.in_world = [&](std::span<const Vec2> asked) {
        std::vector<std::optional<WorldPlace>> places;
        for (const Vec2& dot : asked)
            places.push_back(WorldPlace{top_left + dot.x * dx + dot.y * dy, dx, dy});
        return places;
    };
    dots.shown = [&](const ShotRay& shot) -> std::optional<Vec2> {
        if (shot.state != ShotState::kSeen || shot.object != request.page) return std::nullopt;
        const Vec2 mm = place.mm_of(shot.position) / Vec2(page.paper.width, page.paper.height);
        return Vec2(mm.x * width, (1 - mm.y) * height);
    };
    const SampledMap map = map_onto_film(world, dots, progress);
    made.exact_places = map.exact_count();
    made.worst_accepted = map.worst_accepted();
    paint_page(map, PagePainter(request, made.window, 25.4 / request.dpi), made);
    if (made.coverage == 0 && made.extents == decltype(made.extents){})
        throw InputError(scene_title(world.scene), world.scene.meshes[request.page].name,
                         "is not seen in the window over a mirror: there is nothing to print");
    return made;
}

// The largest rectangle of a given aspect inside a mask: summed-area table (Crow 1984) and bisection over the
// size.

namespace {

/// Sums over rectangles of cells.
class AreaTable {
  public:
    AreaTable(const std::vector<unsigned char>& cells, int columns, int rows)
        : stride_(static_cast<std::size_t>(columns) + 1),
          sums_(stride_ * (static_cast<std::size_t>(rows) + 1), 0) {
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                sums_[at(x + 1, y + 1)] =
                    sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)] +
                    cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                          static_cast<std::size_t>(x)];
    }
    long sum(int x, int y, int wide, int high) const {
        return sums_[at(x + wide, y + high)] - sums_[at(x, y + high)] - sums_[at(x + wide, y)] +
               sums_[at(x, y)];
    }

  private:
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
    }
    std::size_t stride_;
    std::vector<long> sums_;
};

}  // namespace

std::optional<PictureWindow> largest_window(const std::vector<unsigned char>& covered, int columns, int rows,
                                            const Vec2& film, double aspect) {
    const AreaTable table(covered, columns, rows);
    const Vec2 cell = film / Vec2(columns, rows);
    Vec2 middle(0);
    double count = 0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            if (covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(x)])
                middle += Vec2(x + 0.5, y + 0.5), ++count;
    if (count == 0) return std::nullopt;
    middle /= count;

    // Of the places that hold a window of so many cells the one nearest to the middle of what is covered.
    const auto place = [&](int wide) -> std::optional<std::array<int, 4>> {
        const int high = std::max(1, static_cast<int>(std::ceil(wide * cell.x / aspect / cell.y - 1e-9)));
        std::optional<std::array<int, 4>> best;
        double nearest = 0;
        for (int y = 0; y + high <= rows; ++y)
            for (int x = 0; x + wide <= columns; ++x) {
                if (table.sum(x, y, wide, high) != 1L * wide * high) continue;
                const double off = length(Vec2(x + 0.5 * wide, y + 0.5 * high) - middle);
                if (!best || off < nearest) best = {x, y, wide, high}, nearest = off;
            }
        return best;
    };
    int least = 0, most = columns;
    std::optional<std::array<int, 4>> best;
    while (least < most) {
        const int wide = (least + most + 1) / 2;
        const auto found = place(wide);
        if (found)
            best = found, least = wide;
        else
            most = wide - 1;
    }
    if (!best) return std::nullopt;
    const auto& [x, y, wide, high] = *best;
    const double width = wide * cell.x, height = width / aspect;
    const Vec2 corner(x * cell.x, (y + 0.5 * high) * cell.y - 0.5 * height);
    return PictureWindow{corner.x, corner.y, corner.x + width, corner.y + height};
}

}  // namespace trilens
