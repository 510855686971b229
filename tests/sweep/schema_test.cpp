// summary.json is what its schema says, as an independent validator (valijson, draft 7) sees it.
#include <string>

#include "base/files/files.h"
#include "base/util/error.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/run/sweep.h"
#include "sweep/store/results.h"

#if __has_include(<valijson/validator.hpp>)
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

using namespace trilens;

TEST_CASE("sweep: the schema accepts every summary that is written, and refuses changed ones",
          "[sweep][oracle]") {
    valijson::Schema schema;
    const nlohmann::json text = nlohmann::json::parse(summary_schema());
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema);
    const auto accepts = [&](const nlohmann::json& json) {
        return valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(json), nullptr);
    };
    trilens_test::FakeSweep fake(trilens_test::scratch_dir("summary_schema"), {1, 2, 4});
    fake.params.axes.axes.push_back(
        make_axis(pointer_kind("/materials/0/ior"), {"/materials/0/ior", {"1.3", "[1]"}}, "axis"));
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("fails");
    };
    fake.run();
    const std::string file = fake.params.folder + "/summary.json";
    nlohmann::json summary = nlohmann::json::parse(read_whole_file(file).value());
    CHECK(accepts(summary));
    for (const char* pointer : {"/runs/0/status", "/runs/0/point", "/fits/0/order", "/fits/0/group",
                                "/axes/0/values", "/counts/done"}) {
        INFO(pointer);
        nlohmann::json changed = summary;
        REQUIRE(changed.contains(nlohmann::json::json_pointer(pointer)));
        changed[nlohmann::json::json_pointer(pointer)] = nlohmann::json::array({nlohmann::json::object()});
        CHECK(!accepts(changed));
    }
    summary["runs"][0].erase("hash");
    CHECK(!accepts(summary));
}
#else
TEST_CASE("sweep: the schema accepts every summary that is written, and refuses changed ones",
          "[sweep][oracle]") {
    TRILENS_SKIP("needs valijson");
}
#endif

TEST_CASE("sweep: a sweep file may name its schema, which accepts it", "[sweep][oracle]") {
    valijson::Schema schema;
    const nlohmann::json text = nlohmann::json::parse(sweep_schema());
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema);
    const std::string folder = trilens_test::scratch_dir("sweep_schema"), file = folder + "/sweep.json";
    nlohmann::json sweep = {{"$schema", "trilens-sweep-1.schema.json"},
                            {"scenes", {"a.json"}},
                            {"over", {{{"axis", "resolution"}, {"values", "1..8:x2"}}}}};
    const auto accepts = [&] {
        return valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(sweep),
                                              nullptr);
    };
    CHECK(accepts());
    replace_text_file(file, sweep.dump());
    CHECK(read_sweep_file(file).scenes.size() == 1);
    sweep["ovr"] = 1;
    CHECK_FALSE(accepts());
    replace_text_file(file, sweep.dump());
    CHECK_THROWS_AS(read_sweep_file(file), InputError);
}
