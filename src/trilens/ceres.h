// Images of points as cost functions of Ceres Solver, for programs that have it: link with Ceres::ceres as
// well.
//
// Numbers of a scene are one parameter block; a target that was photographed in several poses has a block for
// each. Before each evaluation all images and their derivatives are computed at once, on trilens' threads:
// the costs only copy.
//
//     #include <trilens/ceres.h>
//     trilens::CeresImages images(trilens::load_scene({"scene.json"}), {"/meshes/0/primitive/radius"});
//     images.add({.pixel = {24.1, 25.4}, .point = {-1.55, 0.9, 1.2}});
//     ceres::Problem::Options options;
//     options.evaluation_callback = &images;
//     options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
//     ceres::Problem problem(options);
//     images.add_to(problem);
//     ceres::Solver::Summary summary;
//     ceres::Solve({}, &problem, &summary);
//     std::printf("radius %g\n", images.block()[0]);
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trilens/error.h"
#include "trilens/project.h"
#include "trilens/scene.h"

namespace trilens {

/// A pixel at which a point of a target was seen.
struct CeresObservation {
    Vec2 pixel{0};
    Vec3 point{0};  // of the world; with a pose in the target's own frame
    double* pose =
        nullptr;  // a block of 6, the caller's: rotation (an angle's axis times it, radians), translation
    std::size_t camera = 0;  // of the scene
    double sigma = 1;        // of the pixel: residuals are divided by it
};

/// Few parameters of one's own that stand for the numbers of the scene: numbers = map(block).
struct CeresMap {
    std::vector<double> start;  // the block to begin with
    /// Writes the numbers and, unless null, their derivatives, row by row: a row for each number.
    std::function<void(const double* block, double* numbers, double* jacobian)> map;
};

/// The callback and the costs of one problem; both it and the scene's pictures must outlive the problem. One
/// thread. Where a step of the solver leads to numbers that make no scene (a radius below zero) the costs say
/// that they have no value, so that Ceres takes a shorter one.
class CeresImages final : public ceres::EvaluationCallback {
  public:
    /// `free`: JSON pointers to numbers, or arrays of them (find_numbers). `path`: as ProjectRequest has it.
    /// Throws InputError for pointers that name no number.
    explicit CeresImages(Scene scene, std::vector<std::string> free, const EventWord& path = {})
        : CeresImages(std::move(scene), std::move(free), CeresMap{}, path) {}
    CeresImages(Scene scene, std::vector<std::string> free, CeresMap map, const EventWord& path = {})
        : scene_(std::move(scene)),
          free_(std::move(free)),
          map_(std::move(map)),
          path_(path),
          renderer_(scene_) {
        numbers_ = find_numbers(scene_, free_);
        block_ = map_.start;
        if (!map_.map)
            for (const SceneNumber& number : numbers_) block_.push_back(number.value);
    }

    /// The parameter block of the scene, and how long it is.
    double* block() { return block_.data(); }
    std::size_t size() const { return block_.size(); }
    /// The scene's numbers at the present block.
    std::vector<SceneNumber> numbers() {
        map_numbers(nullptr);
        return numbers_;
    }

    void add(const CeresObservation& one) { seen_.push_back({.asked = one}); }

    /// A residual of two numbers, pixel less image, for each observation; `loss` stays the problem's.
    void add_to(ceres::Problem& problem, ceres::LossFunction* loss = nullptr) {
        for (std::size_t i = 0; i < seen_.size(); ++i) {
            std::vector<double*> blocks{block()};
            if (seen_[i].asked.pose) blocks.push_back(seen_[i].asked.pose);
            problem.AddResidualBlock(new Cost(*this, i), loss, blocks);
        }
    }

    /// Observations that have no image at the present parameters: each is a constant residual of 20 pixels,
    /// which pulls nowhere, and is searched for again at the next evaluation.
    std::size_t lost() const {
        std::size_t count = 0;
        for (const Seen& one : seen_) count += !one.image;
        return count;
    }

    void PrepareForEvaluation(bool with_jacobians, bool is_new_point) override {
        if (!is_new_point && !with_jacobians) return;
        if (is_new_point || !is_prepared_) {
            scene_jacobian_.assign(numbers_.size() * block_.size(), 0.0);
            map_numbers(scene_jacobian_.data());
            is_prepared_ = true;
            try {
                renderer_.change(scene_with(scene_, numbers_));
                is_scene_ = true;
            } catch (const InputError&) {
                is_scene_ = false;
            }
        }
        if (!is_scene_) return;
        std::map<std::size_t, std::vector<std::size_t>> of_camera;
        for (std::size_t i = 0; i < seen_.size(); ++i) of_camera[seen_[i].asked.camera].push_back(i);
        for (const auto& [camera, some] : of_camera) find_images(camera, some, with_jacobians);
    }

  private:
    static constexpr double kLostPixels = 20;

    struct Seen {
        CeresObservation asked;
        std::optional<WorldImage> image = {};
        std::array<std::array<double, 6>, 3> by_pose = {};  // of the point in the world
    };

    class Cost final : public ceres::CostFunction {
      public:
        Cost(const CeresImages& images, std::size_t index) : images_(images), index_(index) {
            set_num_residuals(2);
            mutable_parameter_block_sizes()->push_back(static_cast<int>(images.size()));
            if (images.seen_[index].asked.pose) mutable_parameter_block_sizes()->push_back(6);
        }
        bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
            return images_.evaluate(index_, residuals, jacobians);
        }

      private:
        const CeresImages& images_;
        std::size_t index_;
    };

    void map_numbers(double* jacobian) {
        std::vector<double> values(block_);
        if (map_.map) {
            values.resize(numbers_.size());
            map_.map(block_.data(), values.data(), jacobian);
        } else if (jacobian) {
            for (std::size_t k = 0; k < values.size(); ++k) jacobian[k * values.size() + k] = 1;
        }
        for (std::size_t k = 0; k < values.size(); ++k) numbers_[k].value = values[k];
    }

    /// The point in the world, and how it moves with its pose.
    static Vec3 world_point(Seen& one) {
        const Vec3& p = one.asked.point;
        if (!one.asked.pose) return p;
        using Number = ceres::Jet<double, 6>;
        std::array<Number, 6> pose;
        for (int k = 0; k < 6; ++k) pose[static_cast<std::size_t>(k)] = Number(one.asked.pose[k], k);
        const Number point[3] = {Number(p.x), Number(p.y), Number(p.z)};
        Number turned[3];
        ceres::AngleAxisRotatePoint(pose.data(), point, turned);
        Vec3 world;
        for (std::size_t k = 0; k < 3; ++k) {
            turned[k] += pose[3 + k];
            world[static_cast<int>(k)] = turned[k].a;
            for (int j = 0; j < 6; ++j) one.by_pose[k][static_cast<std::size_t>(j)] = turned[k].v[j];
        }
        return world;
    }

    /// Moves the images that are known, and searches for the others.
    void find_images(std::size_t camera, const std::vector<std::size_t>& some, bool with_jacobians) {
        ProjectRequest request;
        request.frame.camera = camera;
        request.path = path_;
        request.visibility = false;
        request.derivatives = with_jacobians;
        if (with_jacobians) request.parameters = free_;
        std::vector<Vec3> points;
        std::vector<ImageStart> starts;
        std::vector<std::size_t> started;
        for (const std::size_t i : some) {
            points.push_back(world_point(seen_[i]));
            if (!seen_[i].image) continue;
            starts.push_back({points.size() - 1, seen_[i].image->events, seen_[i].image->pixel});
            started.push_back(i);
            seen_[i].image.reset();
        }
        std::vector<std::optional<WorldImage>> moved = renderer_.refine(points, starts, request);
        for (std::size_t k = 0; k < moved.size(); ++k) take(started[k], moved[k], with_jacobians);

        std::vector<Vec3> searched;
        std::vector<std::size_t> lost;
        for (std::size_t k = 0; k < some.size(); ++k)
            if (!seen_[some[k]].image) searched.push_back(points[k]), lost.push_back(some[k]);
        if (lost.empty()) return;
        const std::vector<PointProjection> found = renderer_.project(searched, request);
        for (std::size_t k = 0; k < lost.size(); ++k)
            take(lost[k], nearest(found[k], seen_[lost[k]]), with_jacobians);
    }

    void take(std::size_t i, const std::optional<WorldImage>& image, bool with_jacobians) {
        if (!image || !image->refined) return;
        if (with_jacobians && (!image->has_derivative || image->by_parameter.size() != numbers_.size()))
            return;
        seen_[i].image = image;
    }

    static std::optional<WorldImage> nearest(const PointProjection& found, const Seen& seen) {
        std::optional<WorldImage> best;
        double least = std::numeric_limits<double>::infinity();
        for (const WorldImage& image : found.images) {
            const Vec2 off = image.pixel - seen.asked.pixel;
            const double square = off.x * off.x + off.y * off.y;
            if (square < least) least = square, best = image;
        }
        return best;
    }

    bool evaluate(std::size_t index, double* residuals, double** jacobians) const {
        if (!is_scene_) return false;
        const Seen& one = seen_[index];
        const double scale = 1 / one.asked.sigma;
        for (int row = 0; row < 2; ++row)
            residuals[row] = one.image ? scale * (one.image->pixel[row] - one.asked.pixel[row])
                                       : (row == 0 ? scale * kLostPixels : 0);
        if (!jacobians) return true;
        const std::size_t columns = block_.size();
        for (std::size_t row = 0; row < 2; ++row) {
            for (std::size_t j = 0; jacobians[0] && j < columns; ++j) {
                double sum = 0;
                for (std::size_t k = 0; one.image && k < numbers_.size(); ++k)
                    sum +=
                        one.image->by_parameter[k][static_cast<int>(row)] * scene_jacobian_[k * columns + j];
                jacobians[0][row * columns + j] = scale * sum;
            }
            for (std::size_t j = 0; one.asked.pose && jacobians[1] && j < 6; ++j) {
                double sum = 0;
                for (std::size_t k = 0; one.image && k < 3; ++k)
                    sum += one.image->derivative[row][static_cast<int>(k)] * one.by_pose[k][j];
                jacobians[1][row * 6 + j] = scale * sum;
            }
        }
        return true;
    }

    Scene scene_;
    std::vector<std::string> free_;
    CeresMap map_;
    EventWord path_;
    Renderer renderer_;
    std::vector<SceneNumber> numbers_;
    std::vector<double> block_;
    std::vector<double> scene_jacobian_;  // of the numbers by the block
    std::vector<Seen> seen_;
    bool is_prepared_ = false, is_scene_ = true;  // is_scene_: the present numbers make one
};

}  // namespace trilens
