// Faces taken apart into their polynomial parts, one by one or all of a kind at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "surfaces/polynomial/face_stencils.h"
#include "surfaces/polynomial/polynomial_parts.h"

namespace trilens {

/// How often a face is halved in the search for parts that are one polynomial. What is left then (the last
/// 2^-10 of a face around an extraordinary vertex) has bounds by samples.
inline constexpr int kFinestPart = 10;

/// A part of a face, or four that make up one.
struct PartBranch {
    PartShape shape;
    std::size_t first = 0;  // of four branches, or of one part
    bool is_part = true;
};

struct TakenFace {
    std::vector<PartBranch> branches;  // the whole face first
    std::vector<FacePart> parts;
    bool by_kind = false;  // with others of its kind, not alone
};

TakenFace take_apart(const Surface& surface, Id face);

/// Takes faces apart; those of a kind that many have by the weights of their control points, which are taken
/// apart once. Thread-safe to read; the surface must live longer.
class FaceTaker {
  public:
    explicit FaceTaker(const Surface& surface);

    TakenFace take(Id face) const;
    /// Whether the face is taken by its kind, as long as it is found to be as that says.
    bool is_of_kind(Id face) const { return stencils_ && kind_of_[face] && kinds_.count(*kind_of_[face]); }

  private:
    /// Three control points at a time: the sums' weights as the coordinates of a surface.
    struct KindPart {
        PartShape shape;
        std::vector<FacePart> of_group;  // empty: no polynomial
    };
    struct Kind {
        std::vector<PartBranch> branches;
        std::vector<KindPart> parts;
    };

    Kind take_kind(Id face) const;
    std::optional<TakenFace> take_by(const Kind& kind, Id face) const;

    const Surface& surface_;
    const HasStencils* stencils_ = nullptr;
    std::vector<std::optional<std::uint64_t>> kind_of_;  // per face
    std::map<std::uint64_t, Kind> kinds_;                // of those that many faces have
};

}  // namespace trilens
