// Numbers read back, markup cannot break out, base64 and the hash give their published answers.
#include "report/text.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "base/description/digest.h"
#include "report/xml.h"
#include "support/test.h"

using namespace trilens;

TEST_CASE("sweep: shortest_text reads back as the same double", "[report]") {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> exponent(-300, 300), mantissa(-10, 10);
    for (int i = 0; i < 2000; ++i) {
        const double value = mantissa(random) * std::pow(10.0, exponent(random));
        REQUIRE(std::strtod(shortest_text(value).c_str(), nullptr) == value);
    }
    CHECK(shortest_text(0.1) == "0.1");
    CHECK(shortest_text(NAN) == "nan");
    CHECK(shortest_text(-INFINITY) == "-inf");
}

TEST_CASE("sweep: numbers for people", "[report]") {
    CHECK(fixed_text(-0.0004, 2) == "0.00");
    CHECK(fixed_text(-0.006, 2) == "-0.01");
    CHECK(fixed_text(1e300, 0).size() == 301);
    CHECK(rounded_text(0.0123456, 3) == "0.0123");
    CHECK(rounded_text(0.999999, 3) == "1");
    CHECK(rounded_text(123456, 3) == "123000");
    CHECK(rounded_text(-1234567, 3) == "-1.23e+06");
    CHECK(rounded_text(0.0000123, 2) == "1.2e-05");
    CHECK(rounded_text(0, 3) == "0");
}

TEST_CASE("sweep: escaped markup is well formed whatever the bytes, and text survives it", "[report][law]") {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> byte(0, 255), length(0, 40);
    for (int i = 0; i < 500; ++i) {
        std::string text;
        for (int k = length(random); k > 0; --k) text += static_cast<char>(byte(random));
        const std::string document = "<a b=\"" + escape_markup(text) + "\">" + escape_markup(text) + "</a>";
        REQUIRE_NOTHROW(trilens_test::read_xml(document));
    }
    const std::string words = "<script>alert(\"1\" & '2')</script> π → 🙂";
    CHECK(trilens_test::read_xml("<a>" + escape_markup(words) + "</a>")[0].text == words);
    CHECK(escape_markup("\xC0\xAF") == "\xEF\xBF\xBD\xEF\xBF\xBD");                  // overlong
    CHECK(escape_markup("\xED\xA0\x80") == "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // surrogate
}

TEST_CASE("sweep: cells of a table are quoted as in RFC 4180", "[report][oracle]") {
    CHECK(csv_text("ball") == "ball");
    CHECK(csv_text("") == "");
    CHECK(csv_text("a b") == "a b");
    CHECK(csv_text("a,b") == "\"a,b\"");
    CHECK(csv_text("say \"b\"") == "\"say \"\"b\"\"\"");
    CHECK(csv_text("two\nlines") == "\"two\nlines\"");
}

TEST_CASE("sweep: base64 as in RFC 4648 section 10", "[report][oracle]") {
    const auto encode = [](const std::string& text) {
        return base64_text(std::vector<unsigned char>(text.begin(), text.end()));
    };
    CHECK(encode("") == "");
    CHECK(encode("f") == "Zg==");
    CHECK(encode("fo") == "Zm8=");
    CHECK(encode("foo") == "Zm9v");
    CHECK(encode("foobar") == "Zm9vYmFy");
    CHECK(encode("\xFF\xFE\xFD") == "//79");
}

TEST_CASE("sweep: the hash is FNV-1a", "[report]") {
    CHECK(hash_text("") == "cbf29ce484222325");
    CHECK(hash_text("a") == "af63dc4c8601ec8c");
    CHECK(hash_text("foobar") == "85944171f73967e8");
}
