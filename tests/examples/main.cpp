// Runs the examples of the public headers and of the README, each in a folder with the files that they read,
// and looks for those that they write. Usage: header_examples FOLDER
#include <arpa/inet.h>
#include <sys/socket.h>
#include <trilens/trilens.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "examples.h"

namespace fs = std::filesystem;

namespace {

/// What an example has to leave behind.
const std::map<std::string, std::vector<std::string>> kWritten{
    {"anamorph", {"page.pdf"}},
    {"design", {"mirror.json"}},
    {"files", {"out.json"}},
    {"image", {"picture.png"}},
    {"map", {"unwrap.exr"}},
    {"render", {"projected.exr", "truth.exr"}},
    {"sweep", {"results/scene/report.html", "results/scene/summary.json"}},
    {"trilens", {"mine.exr"}},
    {"unwrap", {"panorama.exr"}},
    {"README", {"my.exr"}}};

/// What the examples of inverse problems read: a ball and its photograph, a cylinder on a page, pixels with
/// the points that the ball shows there, a wish.
void prepare_inverse(const trilens::Renderer& renderer) {
    const std::string scenes = TRILENS_SCENES;
    trilens::replace_text_file("ball.json", renderer.scene().resolved);
    fs::copy("truth.exr", "ball.exr");
    fs::copy(scenes + "/inverse/anamorph-cylinder.json", "cylinder.json");
    trilens::write_image("portrait.png", trilens::read_image("picture.exr"));
    trilens::replace_text_file("wish.json", trilens::wish_example());

    std::vector<trilens::Vec2> places;
    for (int y = 16; y < 34; y += 2)
        for (int x = 22; x < 44; x += 2) places.emplace_back(x + 0.5, y + 0.5);
    const trilens::ShotRays shot = renderer.shoot(places);
    std::string pairs = "x,y,X,Y,Z\n";
    for (std::size_t k = 0; k < places.size(); ++k) {
        const trilens::ShotRay& ray = shot.rays[k];
        if (ray.state != trilens::ShotState::kSeen || ray.event_count != 1) continue;
        const double values[] = {places[k].x, places[k].y, ray.position.x, ray.position.y, ray.position.z};
        for (const double& value : values) pairs += (&value == values ? "" : ",") + std::to_string(value);
        pairs += "\n";
    }
    trilens::replace_text_file("pairs.csv", pairs);
}

/// Where the example of displays finds a viewer that takes what comes. Without one, as where the port is
/// taken, something else listens there or the example fails.
struct SilentViewer {
    int socket = ::socket(AF_INET, SOCK_STREAM, 0);

    SilentViewer() {
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_port = htons(14158);
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
        if (::bind(socket, reinterpret_cast<const sockaddr*>(&place), sizeof(place)) == 0)
            ::listen(socket, 4);
    }
    ~SilentViewer() { ::close(socket); }
};

/// Makes `folder` anew and the working directory: a small scene, its picture and its truth.
void enter(const fs::path& folder) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
    const std::vector<trilens::SceneOverride> small{
        {"/film/width", "64"}, {"/film/height", "48"}, {"/film/spp", "1"}};
    const trilens::Scene scene = trilens::parse_scene(trilens::scene_examples()[0].json, "", small);
    for (const char* name : {"scene.json", "my.json"}) trilens::replace_text_file(name, scene.resolved);
    fs::copy(TRILENS_SCENES "/lenses/cooke-triplet.zmx", "triplet.zmx");
    fs::create_directories("tests/render/ball");
    trilens::replace_text_file("tests/render/ball/test.json",
                               R"({ "scene": "../../../scene.json", "against": "truth", "resolution": 8,
                                    "max": { "displacement_p95": 5 } })");
    const trilens::Renderer renderer(scene);
    trilens::PictureRequest request;
    trilens::write_image("picture.exr", renderer.draw(request).image);
    trilens::write_image("mine.exr", renderer.draw(request).image);
    request.engine = trilens::Engine::kLimitTruth;
    trilens::write_image("truth.exr", renderer.draw(request).image);
    prepare_inverse(renderer);
}

bool passes(const HeaderExample& example, const fs::path& folder) {
    enter(folder / example.name);
    const auto written = kWritten.find(example.name);
    if (written != kWritten.end())
        for (const std::string& file : written->second) fs::remove(file);
    std::printf("%s\n", example.name);
    try {
        example.run();
    } catch (const std::exception& error) {
        std::printf("%s: FAILED: %s\n", example.name, error.what());
        return false;
    }
    bool good = true;
    if (written != kWritten.end())
        for (const std::string& file : written->second) {
            if (fs::exists(file) && fs::file_size(file) > 0) continue;
            std::printf("%s: FAILED: there is no %s\n", example.name, file.c_str());
            good = false;
        }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what ran last is told, however it ends
    const fs::path folder = fs::absolute(argv[1]);
    const SilentViewer viewer;
    int passed = 0, failed = 0;
    for (const HeaderExample& example : kExamples) ++(passes(example, folder) ? passed : failed);
    std::printf("%d passed, %d failed, 0 skipped\n", passed, failed);
    return failed > 0;
}
