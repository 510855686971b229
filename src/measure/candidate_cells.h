// Which cells of a reference may show any of some neighbouring points: looked for once for all of them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "measure/cell_reach.h"
#include "measure/field_index.h"
#include "measure/seen_field.h"

namespace trilens {

class ImageFinder;

struct CandidateCells {
    struct Cell {
        int column, row;
        const CellReach* reach = nullptr;  // null: not asked for yet
    };
    double radius = 0;  // pixels
    // Of four cells each what they may show of the group's piece; at the end filled up with empty boxes.
    std::vector<BoxQuad> bounds;
    std::vector<Cell> cells;
};

/// Points of neighbouring pixels that see one object through one optic. One thread's.
class PointGroup {
  public:
    PointGroup(const ImageFinder& finder, std::span<const SeenPoint> points);

    /// Every cell that may show one of the points within `radius` pixels of its pixel, and some others; in
    /// about the order of their distance. The radius of what is returned is at least the one asked for.
    std::shared_ptr<CandidateCells> cells(double radius);
    /// Whether a cell whose bounds hold the point may show it. Makes those bounds tight.
    bool may_hold(std::size_t number, const Vec3& point, CandidateCells& among) const;

  private:
    struct Node {
        int level, column, row;
        double distance;  // squared, pixels, from the nearest of the pixels
    };

    CandidateCells collect(double radius) const;
    void push_children(const Node& node, double most, std::vector<Node>& stack) const;
    void add_cell(int column, int row, CandidateCells& found) const;
    double distance_to(const Node& node) const;

    const ImageFinder& finder_;
    Piece piece_;
    BoxQuad::Floats low_[3], high_[3];  // of the points, four times the same
    int left_, right_, top_, bottom_;   // of their pixels
    std::vector<std::shared_ptr<CandidateCells>> found_;  // of rising radius
};

}  // namespace trilens
