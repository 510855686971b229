// The comparison against OpenImageIO's own tools, where those are right.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "image/image_io.h"
#include "measure/compare.h"
#include "measure/pictures.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// What a command prints.
std::string output_of(const std::string& command) {
    std::string text;
    std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    REQUIRE(pipe);
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
}

double number_after(const std::string& text, const std::string& label) {
    const std::size_t at = text.find(label);
    REQUIRE(at != std::string::npos);
    return std::stod(text.substr(at + label.size()));
}

}  // namespace

TEST_CASE("numbers agree with oiiotool, verdicts do where its own are right", "[measure][compare][oracle]") {
    if (!has_program("oiiotool") || !has_program("idiff")) TRILENS_SKIP("needs oiiotool and idiff");
    const std::string folder = trilens_test::scratch_dir("compare_oiio");
    for (const unsigned seed : {10u, 12u}) {
        const Image a = noise(seed, 37, 23), change = noise(seed + 100, 37, 23, -0.02f, 0.03f);
        Image b = a;
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < a.pixels(); ++i)
                if (i % seed == 0)
                    b.channels[c].floats()[i] =
                        std::min(1.0f, a.channels[c].floats()[i] + change.channels[c].floats()[i]);
        write_exr(folder + "/a.exr", a);
        write_exr(folder + "/b.exr", b);
        const Comparison ours = compare(a, b, only(0.01, 1));
        const std::string theirs =
            output_of("oiiotool --fail 0.01 --diff '" + folder + "/a.exr' '" + folder + "/b.exr'");
        INFO(theirs);
        CHECK(number_after(theirs, "Mean error = ") == Approx(ours.metrics.mae).epsilon(1e-4));
        CHECK(number_after(theirs, "RMS error = ") == Approx(ours.metrics.rmse).epsilon(1e-4));
        CHECK(number_after(theirs, "Peak SNR = ") == Approx(ours.metrics.psnr_db).epsilon(1e-4));
        CHECK(number_after(theirs, "Max error  = ") == Approx(ours.metrics.max).epsilon(1e-4));
        // Printed as "  12 pixels (1.41%) over 0.01".
        CHECK(theirs.find(std::to_string(ours.counts.fail) + " pixels") != std::string::npos);

        // idiff fails where more than failpercent of the pixels fail or one exceeds hardfail (given that one
        // fails).
        for (const double percent : {2.0, 20.0}) {
            for (const double hard : {0.015, 0.1}) {
                CompareOptions options = only(0.01, hard);
                options.failpercent = percent;
                std::ostringstream line;
                line << "idiff -fail 0.01 -failpercent " << percent << " -hardfail " << hard << " '" << folder
                     << "/a.exr' '" << folder << "/b.exr'";
                const bool fails = output_of(line.str()).find("FAILURE") != std::string::npos;
                CHECK(fails == (compare(a, b, options).verdict == Verdict::kFailure));
            }
        }
    }
}
