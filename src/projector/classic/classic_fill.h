// A scanline filler: which samples of a facet lie inside polygons on the screen, by the even-odd rule.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "base/util/ids.h"

namespace trilens {

/// Samples in rows of the film from top to bottom, each row from left to right. A sample's place is its index
/// into `sample` and `x`.
struct SampleRows {
    struct Row {
        double y = 0;
        std::size_t first = 0, end = 0;  // places
    };
    std::vector<Row> row;
    std::vector<Id> sample;
    std::vector<double> x;

    std::size_t size() const { return sample.size(); }
};

SampleRows make_sample_rows(std::span<const Id> samples, const SampleGrid& grid);

/// A closed polygon on the screen: homogeneous (x w, y w, w) in pixels, the last vertex joined to the first.
using ScreenPolygon = std::vector<Vec3>;

/// Fills polygons over one facet's samples. Vertices nearer than `least_depth` are cut away; that must be
/// less than the facet's depth at every sample.
class PolygonFiller {
  public:
    PolygonFiller(const SampleRows& rows, double least_depth) : rows_(rows), least_depth_(least_depth) {}

    void add(const ScreenPolygon& polygon);

    /// Calls body for each run [first, end) of places that an odd number of the polygons added since the last
    /// fill holds. A sample exactly on a side belongs to the polygon on its right, or below. The same side
    /// gives the same bits in both of its directions.
    void fill(const std::function<void(std::size_t first, std::size_t end)>& body);

  private:
    struct Crossing {
        std::size_t row = 0;
        double x = 0;
    };
    void add_side(const Vec2& a, const Vec2& b);

    const SampleRows& rows_;
    double least_depth_;
    std::vector<Crossing> crossing_;
    std::vector<Vec2> flat_;
};

}  // namespace trilens
