// CAD files that tests write, by OpenCASCADE.
#pragma once

#include <trilens/error.h>

#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <STEPControl_Writer.hxx>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cad/cad_file.h"
#include "cad/cad_scene.h"
#include "support/test.h"

namespace trilens_test {

using namespace trilens;

inline std::string file_named(const std::string& name) {
    static const std::filesystem::path folder = scratch_dir("cad");
    return (folder / name).string();
}

/// By the ending of its name.
inline std::string written(const TopoDS_Shape& shape, const std::string& name) {
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
    const std::string file = file_named(name);
    if (file.ends_with(".step")) {
        STEPControl_Writer writer;
        REQUIRE(writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone);
        REQUIRE(writer.Write(file.c_str()) == IFSelect_RetDone);
    } else {
        IGESControl_Writer writer;
        REQUIRE(writer.AddShape(shape));
        REQUIRE(writer.Write(file.c_str()));
    }
    return file;
}

inline std::vector<CadBody> read_back(const TopoDS_Shape& shape, const std::string& name) {
    const CadModel model = read_cad_file(written(shape, name), 1e-3);
    CHECK(model.warnings == std::vector<std::string>{});
    return model.bodies;
}

inline std::string refusal(const std::function<void()>& act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

inline CadOptions asked(const std::string& file) {
    CadOptions options;
    options.file = file;
    return options;
}

}  // namespace trilens_test
