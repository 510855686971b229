// Light from all around: ambient occlusion (Zhukov, Iones, Kronin, An Ambient Light Illumination Model,
// 1998): the same radiance from all directions that nothing near stands in; and the background: median cut.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/math/luminance.h"
#include "shade/lights/light_sample.h"
#include "shade/shade.h"

namespace trilens {

double occlusion_distance(const AmbientLight& light, double scene_size) {
    return light.distance > 0 ? light.distance : 2 * scene_size;
}

LightSample sample_light(const AmbientLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec3 above = hemisphere_direction(sample, count);
    const auto [u, v] = tangent_basis(at.normal);
    const Vec3 toward = normalize_or_zero(above.x * u + above.y * v + above.z * at.normal);
    const double facing = dot(toward, at.normal);
    if (!(facing > 0)) return {};
    return {.toward = toward,
            .target = at.position + occlusion_distance(light, at.scene_size) * toward,
            .irradiance = std::numbers::pi / (static_cast<double>(count) * facing) * intensity};
}

namespace {

constexpr int kColumns = 512, kRows = 256;

/// Columns first .. last - 1 and rows of the cells.
struct Region {
    std::array<int, 2> first{}, last{};
    double light = 0;
};

/// The background's light in cells of longitude and latitude.
class Cells {
  public:
    explicit Cells(const Background& background);

    double light(const Region& region) const;
    /// Two halves of about equal light, across the longer side; the region has several cells.
    std::array<Region, 2> halves(const Region& region) const;
    /// Adds a direction for the region.
    void add(const Region& region, EnvironmentSamples& to) const;

  private:
    std::size_t cell(int x, int y) const { return static_cast<std::size_t>(y * kColumns + x); }
    double sum(int x, int y) const { return x && y ? sums_[cell(x - 1, y - 1)] : 0; }

    std::vector<Vec3> toward_, flux_;  // flux: radiance times solid angle
    std::vector<double> sums_;         // of luminance, over all cells up to each
};

Cells::Cells(const Background& background) {
    constexpr double kPi = std::numbers::pi;
    std::shared_ptr<const MipMap> map;
    if (background.environment) map = std::make_shared<const MipMap>(background.environment);
    toward_.resize(cell(0, kRows));
    flux_.resize(toward_.size());
    sums_.resize(toward_.size());
    for (int y = 0; y < kRows; ++y) {
        const double theta = kPi * (y + 0.5) / kRows;
        const double solid_angle =
            2 * kPi / kColumns * (std::cos(kPi * y / kRows) - std::cos(kPi * (y + 1) / kRows));
        double row = 0;
        for (int x = 0; x < kColumns; ++x) {
            const double phi = 2 * kPi * (x + 0.5) / kColumns;
            const Vec3 unit(std::sin(theta) * std::cos(phi), std::cos(theta),
                            std::sin(theta) * std::sin(phi));
            const Vec3 across = 2 * kPi / kColumns * Vec3(-unit.z, 0, unit.x),
                       down = kPi / kRows *
                              Vec3(std::cos(theta) * std::cos(phi), -std::sin(theta),
                                   std::cos(theta) * std::sin(phi));
            toward_[cell(x, y)] = unit;
            flux_[cell(x, y)] =
                solid_angle *
                (map ? background_radiance(background, *map, unit, {across, down}) : background.color);
            row += luminance(flux_[cell(x, y)]);
            sums_[cell(x, y)] = row + (y > 0 ? sums_[cell(x, y - 1)] : 0);
        }
    }
}

double Cells::light(const Region& region) const {
    const auto [x0, y0] = region.first;
    const auto [x1, y1] = region.last;
    return std::max(sum(x1, y1) - sum(x0, y1) - sum(x1, y0) + sum(x0, y0), 0.0);
}

std::array<Region, 2> Cells::halves(const Region& region) const {
    // Longitudes are shorter away from the equator.
    const double middle = std::numbers::pi * (region.first[1] + region.last[1]) / 2 / kRows;
    const double width = (region.last[0] - region.first[0]) * std::sin(middle);
    const int height = region.last[1] - region.first[1];
    const std::size_t along = (width > height && region.last[0] - region.first[0] > 1) || height < 2 ? 0 : 1;
    std::array<Region, 2> halves{region, region};
    const auto divide_at = [&](int at) {
        halves[0].last[along] = halves[1].first[along] = at;
        halves[0].light = light(halves[0]);
        halves[1].light = light(halves[1]);
    };
    int low = region.first[along] + 1, high = region.last[along] - 1;
    while (low < high) {
        const int at = (low + high) / 2;
        divide_at(at);
        if (2 * halves[0].light < region.light)
            low = at + 1;
        else
            high = at;
    }
    divide_at(low);
    return halves;
}

void Cells::add(const Region& region, EnvironmentSamples& to) const {
    Vec3 red(0), green(0), blue(0);
    for (int y = region.first[1]; y < region.last[1]; ++y)
        for (int x = region.first[0]; x < region.last[0]; ++x) {
            const Vec3 &flux = flux_[cell(x, y)], &unit = toward_[cell(x, y)];
            red += flux.x * unit;
            green += flux.y * unit;
            blue += flux.z * unit;
        }
    const Vec3 toward = normalize_or_zero(kLuminance.x * red + kLuminance.y * green + kLuminance.z * blue);
    if (toward == Vec3(0)) return;
    to.toward.push_back(toward);
    to.irradiance.push_back(glm::max(Vec3(dot(red, toward), dot(green, toward), dot(blue, toward)), Vec3(0)));
}

}  // namespace

EnvironmentSamples environment_samples(const Background& background, int count) {
    const Cells cells(background);
    // Eight octants to begin with: the vector irradiance of more than a hemisphere says little.
    std::vector<Region> regions;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x) {
            Region region{{x * kColumns / 4, y * kRows / 2}, {(x + 1) * kColumns / 4, (y + 1) * kRows / 2}};
            region.light = cells.light(region);
            regions.push_back(region);
        }
    const auto is_darker = [](const Region& a, const Region& b) { return a.light < b.light; };
    std::vector<Region> done;  // a single cell each
    std::make_heap(regions.begin(), regions.end(), is_darker);
    while (!regions.empty() && regions.size() + done.size() < static_cast<std::size_t>(count)) {
        std::pop_heap(regions.begin(), regions.end(), is_darker);
        const Region most = regions.back();
        regions.pop_back();
        if (!(most.light > 0)) break;
        if (most.last[0] - most.first[0] == 1 && most.last[1] - most.first[1] == 1) {
            done.push_back(most);
            continue;
        }
        for (const Region& half : cells.halves(most)) {
            regions.push_back(half);
            std::push_heap(regions.begin(), regions.end(), is_darker);
        }
    }
    EnvironmentSamples samples{background, count, {}, {}};
    for (const Region& region : done) cells.add(region, samples);
    for (const Region& region : regions)
        if (region.light > 0) cells.add(region, samples);
    return samples;
}

LightSample sample_environment(const EnvironmentSamples& environment, double intensity, const LitPoint& at,
                               std::size_t sample) {
    const Vec3& toward = environment.toward[sample];
    return {.toward = toward,
            .target = at.position + 2 * at.scene_size * toward,
            .irradiance = intensity,
            .color = environment.irradiance[sample]};
}

}  // namespace trilens
