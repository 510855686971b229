// Plots are well-formed SVG; every measurement stands where its decade lines say.
#include "report/plot.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "report/xml.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::XmlElement;

namespace {

/// Pixel positions of the axis labels `text` ("tp-x": abscissae, "tp-y": baselines), and of everything of a
/// class.
double tick_place(const std::vector<XmlElement>& svg, const std::string& axis, const std::string& label) {
    for (const XmlElement& element : svg)
        if (element.has_class(axis) && element.text == label)
            return element.number(axis == "tp-x" ? "x" : "y");
    FAIL("no tick " << label);
    return 0;
}

/// Centres of the circles of the first series; the legend's own is the last.
std::vector<Vec2> circles(const std::vector<XmlElement>& svg) {
    std::vector<Vec2> centres;
    for (const XmlElement& element : svg)
        if (element.name == "circle") centres.push_back({element.number("cx"), element.number("cy")});
    REQUIRE(!centres.empty());
    centres.pop_back();
    return centres;
}

std::vector<PlotSeries> quadratic_series(double scale) {
    PlotSeries series{"all", {}, PlotFit{2, scale}};
    for (const double n : {1.0, 10.0, 100.0}) series.points.push_back({n, scale / (n * n)});
    return {series};
}

std::size_t count_class(const std::vector<XmlElement>& svg, const std::string& name) {
    return static_cast<std::size_t>(
        std::count_if(svg.begin(), svg.end(), [&](const XmlElement& e) { return e.has_class(name); }));
}

}  // namespace

TEST_CASE("sweep: points of a log-log plot stand on their decades, and between them in proportion",
          "[report]") {
    std::vector<PlotSeries> series = quadratic_series(10);
    series[0].points.push_back({std::sqrt(10.0), 1});
    const auto svg = trilens_test::read_xml(log_log_plot({"t", "n", "px", {}, true, 640, 420}, series));
    const std::vector<Vec2> at = circles(svg);
    REQUIRE(at.size() == 4);

    const char* const x_labels[] = {"1", "10", "100"};
    const char* const y_labels[] = {"10", "0.1", "0.001"};
    const double baseline = 4;  // a label's text stands this far below its line
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(at[i].x == Approx(tick_place(svg, "tp-x", x_labels[i])).margin(0.02));
        CHECK(at[i].y == Approx(tick_place(svg, "tp-y", y_labels[i]) - baseline).margin(0.02));
    }
    CHECK(at[3].x == Approx((at[0].x + at[1].x) / 2).margin(0.02));
    CHECK(at[3].y == Approx((at[0].y + at[1].y) / 2).margin(0.02));
}

TEST_CASE("sweep: points of a linear plot stand in proportion between its ticks", "[report]") {
    const std::vector<PlotSeries> series = {{"all", {{0, -20}, {5, 30}, {10, 80}}, std::nullopt}};
    const auto svg = trilens_test::read_xml(linear_plot({"t", "x", "y", {}, true, 640, 420}, series));
    const std::vector<Vec2> at = circles(svg);
    CHECK(at[0].x == Approx(tick_place(svg, "tp-x", "0")).margin(0.02));
    CHECK(at[2].x == Approx(tick_place(svg, "tp-x", "10")).margin(0.02));
    CHECK(at[0].y == Approx(tick_place(svg, "tp-y", "-20") - 4).margin(0.02));
    CHECK(at[2].y == Approx(tick_place(svg, "tp-y", "80") - 4).margin(0.02));
    CHECK(at[1].x == Approx((at[0].x + at[2].x) / 2).margin(0.02));
    CHECK(at[1].y == Approx((at[0].y + at[2].y) / 2).margin(0.02));
}

TEST_CASE("sweep: the fitted line and the reference orders have their slopes, whatever the scale of the data",
          "[report][law][golden]") {
    for (const double scale : {1e-12, 1e-4, 1.0, 1e4, 1e15}) {
        const auto svg = trilens_test::read_xml(
            log_log_plot({"t", "n", "px", {}, true, 640, 420}, quadratic_series(scale)));
        const std::vector<Vec2> at = circles(svg);
        const double per_order = (at[1].y - at[0].y) / 2 / (at[1].x - at[0].x);
        std::vector<double> reference, fitted;
        for (const XmlElement& element : svg) {
            if (!element.has_class("tp-reference") && !element.has_class("tp-fit")) continue;
            const double slope =
                (element.number("y2") - element.number("y1")) / (element.number("x2") - element.number("x1"));
            (element.has_class("tp-fit") ? fitted : reference).push_back(slope / per_order);
        }
        REQUIRE(reference.size() == 2);
        CHECK(reference[0] == Approx(1).epsilon(1e-3));
        CHECK(reference[1] == Approx(2).epsilon(1e-3));
        REQUIRE(fitted.size() == 1);
        CHECK(fitted[0] == Approx(2).epsilon(1e-3));
    }
}

TEST_CASE("sweep: everything drawn stays inside the picture", "[report]") {
    std::vector<PlotSeries> series;
    for (int i = 0; i < 11; ++i) {
        PlotSeries one{"optic " + std::to_string(i), {}, PlotFit{0.3 * i - 1, std::pow(10.0, i - 3)}};
        for (int n = 1; n < 100; n *= 3)
            one.points.push_back({n, std::pow(10.0, i - 3) * std::pow(n, 1 - 0.3 * i)});
        series.push_back(one);
    }
    const auto svg = trilens_test::read_xml(log_log_plot({"t", "n", "px", {}, true, 640, 420}, series));
    const double height = svg[0].number("height");
    CHECK((height > 420 && height < 520));  // the legend's rows
    for (const XmlElement& element : svg) {
        for (const char* name : {"x", "x1", "x2", "cx"})
            if (element.attributes.count(name))
                CHECK((element.number(name) >= 0 && element.number(name) <= 640));
        for (const char* name : {"y", "y1", "y2", "cy"})
            if (element.attributes.count(name))
                CHECK((element.number(name) >= 0 && element.number(name) <= height));
    }
}

namespace {

/// Where a text stands, by a measure of its own: 0.6 em a character, from 0.75 em above the baseline to 0.2
/// em below.
struct Words {
    std::string text;
    double left, right, top, bottom;
    bool touches(const Words& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
};

Words words_of(const XmlElement& element) {
    const double size = element.has_class("tp-title") ? 14 : element.has_class("tp-note") ? 11 : 12;
    double characters = 0;
    for (const char c : element.text) characters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    const double width = 0.6 * size * characters, x = element.number("x"), y = element.number("y");
    const std::string anchor = element.attributes.at("text-anchor");
    const double left = anchor == "end" ? x - width : anchor == "middle" ? x - width / 2 : x;
    return {element.text, left, left + width, y - 0.75 * size, y + 0.2 * size};
}

/// All words of a plot but those that stand upright (the y label, turned around its own origin).
std::vector<Words> all_words(const std::vector<XmlElement>& svg) {
    std::vector<Words> all;
    for (const XmlElement& element : svg)
        if (element.name == "text" && !(element.number("x") == 0 && element.number("y") == 0))
            all.push_back(words_of(element));
    return all;
}

}  // namespace

TEST_CASE("sweep: no word of a plot touches another one, the picture's border or a measurement", "[report]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> order(0, 3), decade(-9, 6), share(0, 1);
    std::uniform_int_distribution<int> how_many(1, 7), how_often(1, 40);
    for (int round = 0; round < 300; ++round) {
        PlotParams params{"Mean displacement of what mirrors show and more",
                          "resolution n [facets]",
                          "mean displacement [px]",
                          {{1, "1 px"}, {0.5, "0.5 px"}}};
        params.ticks_at_points = round % 3 > 0;
        params.subtitle = round % 2 ? "of the pixels that were measured: 98.2 % to 99.8 %" : "";
        std::vector<PlotSeries> series;
        const int count = how_many(random), points = how_often(random);
        const double level = decade(random), step = 1.05 + share(random);
        for (int i = 0; i < count; ++i) {
            PlotSeries one{"optic " + std::string(static_cast<std::size_t>(i * i), 'x'),
                           {},
                           PlotFit{order(random), std::pow(10, level)}};
            for (int k = 0; k < points; ++k) {
                const double x = round % 3 == 1 ? k + 1 : std::floor(std::pow(step, k)) + k;
                one.points.push_back(
                    {x, one.fit->constant * std::pow(x, -one.fit->order) * (1 + share(random))});
            }
            series.push_back(one);
        }
        const auto svg = trilens_test::read_xml(log_log_plot(params, series));
        const std::vector<Words> all = all_words(svg);
        INFO("round " << round);
        for (std::size_t i = 0; i < all.size(); ++i) {
            INFO(all[i].text);
            CHECK((all[i].left >= 0 && all[i].right <= svg[0].number("width")));
            CHECK((all[i].top >= 0 && all[i].bottom <= svg[0].number("height")));
            for (std::size_t j = 0; j < i; ++j) {
                INFO(all[j].text);
                CHECK(!all[i].touches(all[j]));
            }
        }
        for (const XmlElement& element : svg)
            if (element.name == "circle")
                for (const Words& words : all)
                    CHECK(!words.touches({"", element.number("cx") - 3, element.number("cx") + 3,
                                          element.number("cy") - 3, element.number("cy") + 3}));
    }
}

TEST_CASE("sweep: measured values are the ticks; of very many, round ones", "[report]") {
    const auto labels_of = [](const std::vector<double>& values) {
        PlotParams params;
        params.ticks_at_points = true;
        PlotSeries series{"all", {}, std::nullopt};
        for (const double value : values) series.points.push_back({value, 1 / value});
        std::vector<std::string> labels;
        for (const XmlElement& element :
             trilens_test::read_xml(log_log_plot(params, std::vector<PlotSeries>{series})))
            if (element.has_class("tp-x")) labels.push_back(element.text);
        return std::set<std::string>(labels.begin(), labels.end());
    };
    CHECK(labels_of({1, 2, 4, 8, 16, 32, 64}) == std::set<std::string>{"1", "2", "4", "8", "16", "32", "64"});
    CHECK(labels_of({3, 7}) == std::set<std::string>{"3", "7"});
    CHECK(labels_of({12}) == std::set<std::string>{"12"});
    std::vector<double> thousand;
    for (int n = 1; n <= 1000; ++n) thousand.push_back(n);
    CHECK(labels_of(thousand) == std::set<std::string>{"1", "10", "100", "1000"});
}

TEST_CASE("sweep: what a scale cannot show is left out and counted", "[report]") {
    const std::vector<PlotSeries> series = {
        {"all", {{1, 1}, {2, 0}, {4, -1}, {8, NAN}, {0, 3}, {16, INFINITY}}, std::nullopt}};
    const std::string logarithmic = log_log_plot({"t", "n", "px", {}, true, 640, 420}, series);
    CHECK(circles(trilens_test::read_xml(logarithmic)).size() == 1);
    CHECK(logarithmic.find("5 points left out: zero, negative or not a number") != std::string::npos);
    const std::string linear = linear_plot({"t", "n", "px", {}, true, 640, 420}, series);
    CHECK(circles(trilens_test::read_xml(linear)).size() == 4);
    CHECK(linear.find("2 points left out") != std::string::npos);

    const std::vector<PlotSeries> nothing = {{"all", {{1, 0}}, std::nullopt}};
    CHECK(log_log_plot({"t", "n", "px", {}, true, 640, 420}, nothing).find("nothing to draw") !=
          std::string::npos);
    CHECK_NOTHROW(trilens_test::read_xml(log_log_plot({}, {})));
    CHECK_NOTHROW(trilens_test::read_xml(linear_plot({}, {})));
}

TEST_CASE("sweep: plots escape their text, draw their levels, and do not depend on the locale", "[report]") {
    const PlotParams params{"<&\"title'>", "n <", "px & more", {{1, "1 px"}, {1e9, "far off"}},
                            true,          640,   420};
    std::vector<PlotSeries> series = quadratic_series(40);
    series[0].name = "</svg><script>";
    const std::string plain = log_log_plot(params, series);
    const auto svg = trilens_test::read_xml(plain);
    CHECK(svg[0].attributes.at("aria-label") == params.title);
    CHECK(count_class(svg, "tp-level") == 1);
    CHECK(plain.find("<script>") == std::string::npos);

    const char* const german = std::setlocale(LC_ALL, "de_DE.UTF-8");
    const std::string again = log_log_plot(params, series);
    std::setlocale(LC_ALL, "C");
    INFO((german ? "with" : "without") << " a locale that writes decimal commas");
    CHECK(again == plain);
}

TEST_CASE("sweep: scales hold their values and have between two and twenty labels at every magnitude",
          "[report]") {
    for (const ScaleKind kind : {ScaleKind::kLinear, ScaleKind::kLog})
        for (const double magnitude : {1e-30, 1e-4, 1.0, 1e4, 1e30})
            for (const double span : {1.0, 1.3, 7.0, 1e3, 1e12}) {
                const std::vector<double> values = {magnitude, magnitude * span};
                const PlotScale scale = fit_scale(kind, values);
                INFO(magnitude << " " << span << " " << static_cast<int>(kind));
                CHECK((scale.lo < values[0] && scale.hi > values[1]));
                if (kind == ScaleKind::kLinear && span == 1.0)
                    continue;  // a range a billionth of its values long
                std::size_t labels = 0;
                double previous = -INFINITY;
                for (const PlotTick& tick : make_ticks(scale)) {
                    CHECK((tick.value > previous && tick.value >= scale.lo && tick.value <= scale.hi));
                    previous = tick.value;
                    labels += !tick.label.empty();
                }
                CHECK((labels >= 2 && labels <= 20));
            }
}

TEST_CASE("sweep: of two series that lie on one another both are seen, and the legend says so", "[report]") {
    std::vector<PlotSeries> series = quadratic_series(10);
    series[0].name = "exact";
    series.push_back(series[0]);
    series[1].name = "classic";
    PlotSeries apart = series[0];
    apart.name = "planar";
    for (Vec2& point : apart.points) point.y *= 3;
    series.push_back(apart);
    const auto svg = trilens_test::read_xml(log_log_plot({"t", "n", "px", {}, true, 640, 420}, series));
    // The fit, the join and three measurements, and the one in the legend.
    CHECK(count_class(svg, "tp-over") == 6);
    for (const XmlElement& element : svg)
        if (element.has_class("tp-over")) CHECK(element.has_class(plot_series_class(1)));
    const auto has_entry = [&](const std::string& words) {
        return std::ranges::any_of(svg, [&](const XmlElement& element) { return element.text == words; });
    };
    CHECK(has_entry("classic: as exact"));
    CHECK(has_entry("planar: order 2.00"));
}

TEST_CASE("sweep: a place is a vertical line within the frame, with its label beside", "[report]") {
    PlotParams params{"t", "s", "px", {}, false, 640, 420};
    params.places = {{1000, "ray tracing"}};  // beyond all measurements
    const auto svg = trilens_test::read_xml(log_log_plot(params, quadratic_series(10)));
    std::size_t lines = 0, labels = 0;
    for (const XmlElement& element : svg) {
        if (element.has_class("tp-level")) {
            ++lines;
            CHECK(element.number("x1") == element.number("x2"));
            CHECK(element.number("x1") == Approx(tick_place(svg, "tp-x", "1000")).margin(0.02));
        }
        labels += element.text == "ray tracing";
    }
    CHECK(lines == 1);
    CHECK(labels == 1);
}
