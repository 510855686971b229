// Fuzz target of reports: a sweep of two pictures whose names a stranger chose; its page shows them as text,
// its tables read back.
#include <array>
#include <cstddef>
#include <filesystem>

#include "fuzz/target.h"
#include "trilens/scene.h"
#include "trilens/sweep.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace trilens_fuzz {
namespace {

/// The parts between line ends, at most `count` of them.
template <std::size_t count>
std::array<std::string, count> lines_of(std::string_view bytes) {
    std::array<std::string, count> lines;
    for (std::string& line : lines) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size());
        line = bytes.substr(0, end);
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    }
    return lines;
}

/// All names begin so: in a page that shows them as text it does not stand as it is.
constexpr const char* kMark = "7q<";

void require_escaped(const std::string& page) {
    require(page.find("</html>") != std::string::npos, "a report without an end");
    require(page.find(kMark) == std::string::npos, "a page has a name in it that it did not escape");
    require(page.find("7q&lt;") != std::string::npos, "a page without the names");
}

}  // namespace

Answer sweep_report(std::string_view bytes) {
    const auto names = lines_of<4>(bytes);
    SweepRequest request;
    request.folder = fuzz_folder() + "/sweep";
    fs::remove_all(request.folder);
    return answer([&] {
        Scene scene = parse_scene(small_scene());
        scene.meshes[0].name = kMark + names[0];
        scene.meshes[1].name = kMark + names[1];
        request.loaded = scene;
        request.over = {{"resolution", {"1", "2"}}};
        request.title = kMark + names[2];
        request.command = kMark + names[3];
        const SweepSummary made = run_sweep(request);
        require(made.runs.size() == 2, "a sweep of two pictures has not two");
        const std::string table = file_text(request.folder + "/runs.csv");
        require_escaped(file_text(request.folder + "/report.html"));
        const SweepSummary read = report_sweep(request.folder);
        require(read.runs.size() == made.runs.size(), "a sweep's folder reads back as another");
        require(file_text(request.folder + "/runs.csv") == table, "a table is another once it is read");
        require_escaped(file_text(request.folder + "/report.html"));
    });
}

}  // namespace trilens_fuzz
