// Points written as text.
#include "scene/samples/points_file.h"

#include <random>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a point is three numbers within bounds", "[scene]") {
    CHECK(parse_point("1,2,3") == Vec3(1, 2, 3));
    CHECK(parse_point(" -1.5e-3 ,\t+2 , 0\r") == Vec3(-1.5e-3, 2, 0));
    for (const char* text :
         {"", "1,2", "1,2,3,4", "1;2;3", "1,,3", "a,b,c", "1,2,nan", "1,2,inf", "1e31,0,0", "1,2,3x"}) {
        INFO(text);
        CHECK_FALSE(parse_point(text));
    }
}

TEST_CASE("a file of points may begin with a header and names the line that is no point",
          "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_points"), file = folder + "/points.csv";
    // Whether reading throws with these words, after the file's name.
    const auto refuses = [&](const std::string& words) {
        try {
            read_points(file);
        } catch (const InputError& error) {
            const std::string what = error.what();
            return what.find(file) != std::string::npos && what.find(words) != std::string::npos;
        }
        return false;
    };
    replace_text_file(file, "\xef\xbb\xbf\"x\", y, z\n\n# a remark\n1,2,3\r\n-4, 5e-1, 6");
    CHECK(read_points(file) == std::vector<Vec3>{{1, 2, 3}, {-4, 0.5, 6}});

    replace_text_file(file, "x,y,z\n1,2,3\n1,2\n");
    CHECK(refuses("line 3"));
    // A first line with a number in it is no header.
    replace_text_file(file, "1,2\n1,2,3\n");
    CHECK(refuses("line 1"));
    replace_text_file(file, "x,y,z\n");
    CHECK(refuses("no points"));
    // Nor are numbers that something else separates, whether others follow or not.
    for (const char* first : {"0;1;-3", "0 1 -3", "0\t1\t-3", "0,5;1,2;-3"})
        for (const char* rest : {"\n0,1,-2\n", "\r\n", ""}) {
            replace_text_file(file, std::string(first) + rest);
            INFO(first);
            CHECK(refuses("line 1"));
            CHECK(refuses("commas separate numbers"));
        }
    for (const char* header : {"z,y,x", "X, Z, Y", "\"y\",\"x\",\"z\"", "id,x,y,z", "y"}) {
        replace_text_file(file, std::string(header) + "\n1,2,3\n");
        INFO(header);
        CHECK(refuses("line 1"));
        CHECK(refuses("in this order"));
    }
    for (const char* header : {"X,Y,Z", "a,b,c", "easting,northing,height", "x,y,z,", "point 1, 2nd, 3rd"}) {
        replace_text_file(file, std::string(header) + "\n1,2,3\n");
        INFO(header);
        CHECK(read_points(file) == std::vector<Vec3>{{1, 2, 3}});
    }
    CHECK_THROWS_WITH(parse_numbers("y,x\n1,2\n", "places", {2, "x,y", "places"}),
                      ContainsSubstring("names the columns y,x"));
    CHECK(parse_numbers("x,y\n1,2\n", "places", {2, "x,y", "places"}) == std::vector<double>{1, 2});
    CHECK_THROWS_AS(read_points(folder), InputError);
    CHECK_THROWS_AS(read_points(folder + "/none.csv"), InputError);
}

TEST_CASE("a long text of points reads as its lines do, and its first bad line is named", "[scene]") {
    std::mt19937_64 random(5);
    std::string text = "x,y,z\n";
    std::vector<Vec3> expected;
    std::vector<std::size_t> starts;
    for (std::size_t line = 2; line < 20000; ++line) {
        starts.push_back(text.size());
        if (random() % 50 == 0) {
            text += random() % 2 ? "\n" : "# 1,2\r\n";
            continue;
        }
        const Vec3 point(static_cast<double>(random() % 1000) / 8, static_cast<double>(line), -0.25);
        text += std::to_string(point.x) + std::string(random() % 9, ' ') + "," + std::to_string(point.y) +
                ",-0.25" + (random() % 3 ? "\n" : "\r\n");
        expected.push_back(point);
    }
    CHECK(parse_points(text, "points") == expected);
    CHECK(parse_points(text.substr(0, text.size() - 1), "points") == expected);
    for (const std::size_t first : {std::size_t{7}, std::size_t{4321}, starts.size() - 1}) {
        std::string bad = text;
        bad.insert(starts.back(), "again\n");
        bad.insert(starts[first], "x,y\n");
        try {
            parse_points(bad, "points");
            FAIL("no error");
        } catch (const InputError& error) {
            CHECK(std::string(error.what()).find("line " + std::to_string(first + 2)) != std::string::npos);
        }
    }
}
