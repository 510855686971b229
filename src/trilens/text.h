// Text as the library writes it: numbers in every locale alike, and "did you mean".
//
//     std::puts(trilens::shortest_text(0.1).c_str());                 // 0.1
//     const std::vector<std::string> names{"main", "side"};
//     std::puts(trilens::suggestion("mian", names).c_str());          // ; did you mean 'main'?
#pragma once

#include "base/util/names.h"
#include "report/text.h"
