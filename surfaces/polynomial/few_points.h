// The few patch points that a face of a dense cage is made of where it is asked for, made there and then.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "surfaces/polynomial/sub_patches.h"

namespace trilens {

/// How the patch points of a kind of faces follow from their control points, and which of them matter where.
struct KindPoints {
    std::vector<double> rows;  // per patch point that is no control point its weights of these
    SubPatches sub_patches;

    std::size_t bytes() const {
        return sizeof(KindPoints) + rows.capacity() * sizeof(double) + sub_patches.bytes();
    }
};

/// The kinds of a cage's faces that many have: as many of them as fit into a budget of bytes, but for one.
/// Thread-safe.
class ManyKinds {
  public:
    explicit ManyKinds(std::size_t budget) : budget_(budget) {}

    /// What make() says of the kind, once it has been asked for often, and for good; none until then, and
    /// where the budget is full.
    template <class Make>
    const KindPoints* of(std::uint64_t kind, const Make& make) {
        constexpr int kMany = 64;  // take as long as what all have in common
        const std::lock_guard lock(mutex_);
        Kind& known = kinds_[kind];
        if (!known.points && ++known.asked > kMany && bytes_ < budget_) {
            known.points = make();
            bytes_ += known.points->bytes();
        }
        return known.points.get();
    }
    std::size_t bytes() const { return bytes_; }

  private:
    struct Kind {
        std::uint64_t asked = 0;
        std::unique_ptr<const KindPoints> points;
    };
    std::size_t budget_;
    std::mutex mutex_;
    std::map<std::uint64_t, Kind> kinds_;
    std::atomic<std::size_t> bytes_{0};
};

/// The points of some sub-patches of one face, in the places that they have among all of its patch points:
/// three coordinates each, controls first. They stay until another face is asked for.
class FewPoints {
  public:
    struct Face {
        std::uint64_t surface = 0;  // a number that no other has had
        int face = 0;
        const KindPoints* kind = nullptr;  // none where control points are all that there is
        std::size_t controls = 0;

        bool operator==(const Face&) const = default;
    };

    /// The points that matter at (u, v) of the face; the others are no numbers. gather(controls) writes the
    /// control points, sum(weights, controls, point) one that is a sum of them.
    template <class Gather, class Sum>
    const double* at(const Face& face, const Vec2& uv, const Gather& gather, const Sum& sum) {
        if (face_ != face) {
            forget();
            controls_.resize(3 * face.controls);
            gather(controls_.data());
            face_ = face;
        }
        if (!face.kind) return controls_.data();
        const std::span<const int> wanted = face.kind->sub_patches.points_at(uv);
        if (wanted.data() != latest_) make(face, wanted, sum);
        return points_.data();
    }

  private:
    static constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

    void forget() {
        for (const std::size_t k : made_) std::fill_n(points_.data() + 3 * k, 3, kNoNumber);
        made_.clear();
        latest_ = nullptr;
    }
    template <class Sum>
    void make(const Face& face, std::span<const int> wanted, const Sum& sum) {
        const std::size_t places = 3 * face.controls + 3 * face.kind->rows.size() / face.controls;
        if (points_.size() < places) points_.resize(places, kNoNumber);
        for (const int number : wanted) {
            const auto k = static_cast<std::size_t>(number);
            double* const point = points_.data() + 3 * k;
            if (!std::isnan(point[0])) continue;
            if (k < face.controls)
                std::copy_n(controls_.data() + 3 * k, 3, point);
            else
                sum(face.kind->rows.data() + (k - face.controls) * face.controls, controls_.data(), point);
            made_.push_back(k);
        }
        latest_ = wanted.data();
    }

    std::optional<Face> face_;
    std::vector<double> controls_, points_;
    std::vector<std::size_t> made_;
    const int* latest_ = nullptr;  // the numbers that were wanted last
};

}  // namespace trilens
