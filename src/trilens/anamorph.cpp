#include "trilens/anamorph.h"

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/names.h"

namespace trilens {

Id find_mesh(const Scene& scene, const std::string& name) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].name == name) return static_cast<Id>(m);
        names.push_back(scene.meshes[m].name);
    }
    throw UsageError("there is no object \"" + name + "\"" + suggestion(name, names));
}

Anamorph make_anamorph(const Renderer& renderer, const AnamorphRequest& request, const Progress& progress) {
    Anamorph made;
    renderer.use_world([&](const World& world) { made = make_anamorph(world, request, progress); });
    return made;
}

AnamorphCheck verify_anamorph(const Renderer& renderer, const AnamorphRequest& request, const Anamorph& made,
                              const Progress& progress) {
    AnamorphCheck check;
    renderer.use_world([&](const World& world) { check = verify_anamorph(world, request, made, progress); });
    return check;
}

void check_page_name(const std::string& file) {
    for (const char* end : {".pdf", ".svg", ".png"})
        if (file.size() > 4 && file.ends_with(end)) return;
    throw UsageError("the page \"" + file + "\" must end in .pdf, .svg or .png");
}

void write_page(const std::string& file, const AnamorphPage& page) {
    check_page_name(file);
    if (file.ends_with(".pdf")) return replace_file(file, pdf_of(page));
    if (file.ends_with(".svg")) return replace_text_file(file, svg_of(page));
    replace_file(file, png_of(page));
}

}  // namespace trilens
