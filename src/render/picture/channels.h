// The channels of a picture: which layers it has, and what a pixel writes into each.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "render/engines/coverage_bounds.h"
#include "render/frame/request.h"
#include "render/frame/views.h"
#include "render/picture/sample_colour.h"
#include "scene/data/scene.h"

namespace trilens {

/// An image under work, with its channels by what they hold. Names: interface, "Images".
class Canvas {
  public:
    /// `image`: with its windows set, without channels. `layers`: as LayerRequest has them.
    Canvas(Image image, const std::vector<std::string>& layers);

    /// Throws ComputationError where the colour is not finite.
    void put_colours(std::span<const SampleColour> means, std::size_t first);
    /// What the pixel's centre shows.
    void put_centre(const World& world, const SampleViews& views, const SampleView& view, std::size_t pixel);

    /// Whether it has the layer "coverage".
    bool wants_coverage() const { return covered_object_ != kNone; }
    /// What pixels from `first` on show at their centres, and bounds of its share of each.
    void put_coverage(std::span<const Id> shown, std::span<const CoverageBounds> bounds, std::size_t first);

    /// How often its samples were shaded: the pixel's fragments, or its samples.
    void put_fragment_count(std::size_t count, std::size_t pixel);

    const Image& image() const { return image_; }
    /// The image without its values.
    Image layout() const;
    Image take() { return std::move(image_); }

  private:
    /// Indices into the image's channels; kNone: not asked for.
    struct EndChannels {
        Path path = Path::kReflect;
        std::size_t object = kNone, primitive = kNone, x = kNone, y = kNone, z = kNone, length = kNone;
        std::size_t area = kNone;
        std::array<std::size_t, 3> direction{kNone, kNone, kNone}, origin{kNone, kNone, kNone};
    };

    std::size_t add_floats(const std::string& name);
    std::size_t add_ids(const std::string& name);
    std::vector<float>& floats(std::size_t channel) { return image_.channels[channel].floats(); }
    std::vector<Id>& ids(std::size_t channel) { return image_.channels[channel].ids(); }
    void put_end(const World& world, const PathEnd* end, const EndChannels& channels, std::size_t pixel);

    Image image_;
    std::array<std::size_t, 4> rgba_{};
    std::array<std::array<std::size_t, 3>, 3> parts_{};  // direct, reflect, refract
    std::size_t depth_ = kNone;
    std::size_t optic_object_ = kNone, optic_facet_ = kNone, optic_u_ = kNone, optic_v_ = kNone;
    std::size_t bound_ = kNone;  // a proven displacement, pixels
    std::size_t covered_object_ = kNone, covered_least_ = kNone, covered_most_ = kNone;
    std::size_t path_count_ = kNone, method_ = kNone, level_ = kNone, fragments_ = kNone;
    std::vector<EndChannels> ends_;
};

// How the samples around a pixel make its colour.

/// The weights of samples by their place along one axis; a sample's weight is the product of both axes'.
/// Symmetric; they need not sum to 1, for at the film's border samples are missing: whoever sums divides.
struct PixelFilter {
    int reach = 0;                // pixels to either side whose samples count
    std::vector<double> weights;  // of the 2 reach + 1 pixels' samples along the axis, in order
    std::function<Vec3(const Vec3& light)> shown = {};  // as LayerRequest::shown

    /// What of a sample's colour is averaged.
    SampleColour averaged(const SampleColour& sample) const;
};

/// For side x side samples a pixel. Box: those of the pixel alone. Mitchell: Mitchell and Netravali,
/// Reconstruction Filters in Computer Graphics (1988), B = C = 1/3, reaching 2 pixels. Gaussian: deviation
/// 0.5, reaching 1.5 pixels, less its value there (Pharr, Jakob, Humphreys, Physically Based Rendering, 8.8).
PixelFilter make_pixel_filter(FilterKind kind, int side);

}  // namespace trilens
