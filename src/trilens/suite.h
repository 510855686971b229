// Regression tests: folders of scenes, each with what its picture is held against and how far it may be off.
//
//     trilens::SuiteRequest request;
//     request.folders = {"tests/render"};
//     request.junit = "results.xml";
//     const trilens::SuiteResult result = trilens::run_suite(request);
//     for (const trilens::TestResult& test : result.tests)
//         for (const std::string& reason : test.reasons)
//             std::printf("%s: %s\n", test.name.c_str(), reason.c_str());
#pragma once

#include "study/suite.h"
