// Calibrates the port of an underwater camera: where its glass stands before the camera, from photographs of
// a flat target in several poses.
//
//     calibrate_port CALIBRATION PAIRS.csv
//
// CALIBRATION is Calibmar's calibration.yaml or COLMAP's cameras.txt: the camera, known from air, and the
// port as it was drawn. A line of PAIRS.csv is view,x,y,X,Y: a pixel, and the place on the target that is
// seen there. Says the port's numbers with their standard deviations (of a flat port Nx, Ny, Nz and distance;
// of a dome its centre), and the rms in pixels.
#include <trilens/ceres.h>

#include <glog/logging.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using trilens::Vec2;
using trilens::Vec3;

constexpr const char* kCenters[] = {"/meshes/0/primitive/center", "/meshes/1/primitive/center"};
constexpr const char* kNormals[] = {"/meshes/0/primitive/normal", "/meshes/1/primitive/normal"};

struct Pair {
    Vec2 pixel;
    Vec3 point;
};

std::map<int, std::vector<Pair>> read_views(const std::string& file) {
    std::ifstream in(file);
    std::map<int, std::vector<Pair>> views;
    for (std::string line; std::getline(in, line);) {
        for (char& letter : line)
            if (letter == ',') letter = ' ';
        std::istringstream words(line);
        int view = 0;
        Pair pair{Vec2(0), Vec3(0)};
        if (words >> view >> pair.pixel.x >> pair.pixel.y >> pair.point.x >> pair.point.y)
            views[view].push_back(pair);
    }
    return views;
}

/// The port's own numbers and how they make those of the scene: each port has three that its photographs
/// tell.
struct PortMap {
    bool is_dome = false;
    Eigen::Vector3d normal, first, second;  // of a flat port as it was drawn, and across it
    double distance = 0, thickness = 0;

    std::vector<std::string> pointers() const {
        if (is_dome) return {kCenters[0], kCenters[1]};
        return {kCenters[0], kNormals[0], kCenters[1], kNormals[1]};
    }
    std::vector<double> start() const {
        return is_dome ? std::vector<double>{normal.x(), normal.y(), normal.z()}
                       : std::vector<double>{0, 0, distance};
    }
    /// A flat port's normal at tilts a and b, or a dome's centre.
    template <typename T>
    Eigen::Matrix<T, 3, 1> place(const T* block) const {
        if (is_dome) return {block[0], block[1], block[2]};
        const Eigen::Matrix<T, 3, 1> way =
            normal.cast<T>() + block[0] * first.cast<T>() + block[1] * second.cast<T>();
        return way / way.norm();
    }
    template <typename T>
    std::vector<T> numbers(const T* block) const {
        const Eigen::Matrix<T, 3, 1> at = place(block);
        std::vector<T> result;
        for (const double behind : {0.0, thickness}) {
            for (int k = 0; k < 3; ++k) result.push_back(is_dome ? at[k] : (block[2] + behind) * at[k]);
            for (int k = 0; k < 3 && !is_dome; ++k) result.push_back(-at[k]);
        }
        return result;
    }
};

Eigen::Vector3d eigen(const Vec3& v) {
    return {v.x, v.y, v.z};
}

PortMap port_of(const trilens::Scene& scene) {
    PortMap port;
    if (scene.meshes.size() != 2) throw std::runtime_error("the calibration has no port");
    const trilens::Primitive &inside = *scene.meshes[0].primitive, &outside = *scene.meshes[1].primitive;
    port.is_dome = std::holds_alternative<trilens::SpherePrimitive>(inside.kind);
    port.normal = eigen(inside.center);
    if (port.is_dome) return port;
    port.distance = port.normal.norm();
    port.thickness = eigen(outside.center).norm() - port.distance;
    port.normal /= port.distance;
    port.first = port.normal.unitOrthogonal();
    port.second = port.normal.cross(port.first);
    return port;
}

trilens::CeresMap ceres_map(const PortMap& port) {
    return {port.start(), [port](const double* block, double* numbers, double* jacobian) {
                using Number = ceres::Jet<double, 3>;
                const Number own[3] = {Number(block[0], 0), Number(block[1], 1), Number(block[2], 2)};
                const std::vector<Number> found = port.numbers(own);
                for (std::size_t k = 0; k < found.size(); ++k) {
                    numbers[k] = found[k].a;
                    for (std::size_t j = 0; jacobian && j < 3; ++j)
                        jacobian[3 * k + j] = found[k].v[static_cast<Eigen::Index>(j)];
                }
            }};
}

/// The pose of a flat target from the homography between it and the film of a camera without a port (Zhang
/// 2000).
std::array<double, 6> first_pose(const std::vector<Pair>& pairs, const trilens::OpencvLens& lens,
                                 double longer) {
    Eigen::MatrixXd rows(2 * pairs.size(), 9);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double x = (pairs[i].pixel.x - lens.cx) / (longer * lens.fx),
                     y = (pairs[i].pixel.y - lens.cy) / (longer * lens.fy);
        const Eigen::RowVector3d at(pairs[i].point.x, pairs[i].point.y, 1);
        const auto row = static_cast<Eigen::Index>(2 * i);
        rows.row(row) << at, 0, 0, 0, -x * at;
        rows.row(row + 1) << 0, 0, 0, at, -y * at;
    }
    const Eigen::VectorXd h = Eigen::JacobiSVD<Eigen::MatrixXd>(rows, Eigen::ComputeFullV).matrixV().col(8);
    Eigen::Matrix3d homography;
    homography << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
    homography /= std::sqrt(homography.col(0).norm() * homography.col(1).norm());
    if (homography(2, 2) < 0) homography = -homography;
    Eigen::Matrix3d turn;
    turn << homography.col(0), homography.col(1), homography.col(0).cross(homography.col(1));
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::AngleAxisd rotation(svd.matrixU() * svd.matrixV().transpose());
    const Eigen::Vector3d about = rotation.angle() * rotation.axis();
    return {about.x(), about.y(), about.z(), homography(0, 2), homography(1, 2), homography(2, 2)};
}

int run(const std::string& calibration, const std::string& pair_file) {
    trilens::SceneRequest request;
    request.file = calibration;
    const trilens::Scene scene = trilens::load_scene(request);
    const auto& lens = std::get<trilens::OpencvLens>(scene.cameras[0].kind);
    const PortMap port = port_of(scene);
    const double water = port.is_dome ? 1 : scene.materials[1].ior;
    std::map<int, std::vector<Pair>> views = read_views(pair_file);
    std::map<int, std::array<double, 6>> poses;

    trilens::CeresImages images(scene, port.pointers(), ceres_map(port), trilens::EventWord("TT"));
    std::size_t count = 0;
    for (const auto& [view, pairs] : views) {
        if (pairs.size() < 4) throw std::runtime_error("a view has fewer than 4 pairs");
        poses[view] = first_pose(pairs, lens, water);
        count += pairs.size();
        for (const Pair& pair : pairs)
            images.add({.pixel = pair.pixel, .point = pair.point, .pose = poses[view].data()});
    }
    if (count == 0) throw std::runtime_error(pair_file + ": holds no pairs");

    ceres::Problem::Options options;
    options.evaluation_callback = &images;
    ceres::Problem problem(options);
    images.add_to(problem);
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = 200;
    solver.function_tolerance = 1e-12;
    solver.parameter_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    // First the poses alone, then the port with them.
    problem.SetParameterBlockConstant(images.block());
    ceres::Solve(solver, &problem, &summary);
    problem.SetParameterBlockVariable(images.block());
    ceres::Solve(solver, &problem, &summary);

    const double rms = std::sqrt(2 * summary.final_cost / static_cast<double>(count));
    double variance[9] = {};
    ceres::Covariance covariance({});
    const std::vector<std::pair<const double*, const double*>> of_port{{images.block(), images.block()}};
    if (covariance.Compute(of_port, &problem))
        covariance.GetCovarianceBlock(images.block(), images.block(), variance);
    const double noise = 2 * summary.final_cost / static_cast<double>(2 * count - 3 - 6 * views.size());
    const Eigen::Vector3d at = port.place(images.block());
    std::printf("%s %.6f %.6f %.6f", port.is_dome ? "centre" : "normal", at.x(), at.y(), at.z());
    if (!port.is_dome) std::printf(" distance %.6f", images.block()[2]);
    std::printf("\ndeviations");
    for (int k = 0; k < 3; ++k) std::printf(" %.3g", std::sqrt(noise * variance[4 * k]));
    std::printf("\nrms %.6f px over %zu pairs in %zu views, %zu lost, %d steps\n", rms, count, views.size(),
                images.lost(), static_cast<int>(summary.iterations.size()));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: calibrate_port CALIBRATION PAIRS.csv\n");
        return 2;
    }
    google::InitGoogleLogging(argv[0]);
    try {
        return run(argv[1], argv[2]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "calibrate_port: %s\n", error.what());
        return 3;
    }
}
