// Outputs that are either the old file or the whole new one, for programs around the library.
//
//     trilens::check_writable("out.json", {"scene.json"});  // before long work
//     trilens::replace_text_file("out.json", "{}\n");
#pragma once

#include "base/files/files.h"
