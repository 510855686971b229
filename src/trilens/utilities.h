// For programs around the library: numbers as text, "did you mean", whole files or none, and seconds.
//
//     std::puts(trilens::shortest_text(0.1).c_str());                 // 0.1, in every locale
//     const std::vector<std::string> names{"main", "side"};
//     std::puts(trilens::suggestion("mian", names).c_str());          // ; did you mean 'main'?
//
//     trilens::check_writable("out.json", {"scene.json"});  // before long work
//     const trilens::Stopwatch watch;
//     trilens::replace_text_file("out.json", "{}\n");
//     std::printf("%g s\n", watch.seconds());
#pragma once

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "report/text.h"
