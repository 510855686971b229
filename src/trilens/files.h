// Outputs that are either the old file or the whole new one, for programs around the library.
//
//     trilens::check_writable("out.json", {"scene.json"});  // before long work
//     trilens::replace_text_file("out.json", "{}\n");
#pragma once

#include "base/check_output.h"
#include "base/file_bytes.h"
#include "base/files.h"
