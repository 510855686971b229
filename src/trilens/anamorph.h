// Mirror anamorphoses: pages to print at true scale on which a picture lies so that a mirror straightens it.
//
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"cylinder.json"}));
//     trilens::AnamorphRequest request;
//     request.picture = trilens::read_photo("portrait.png").picture;
//     request.page = trilens::find_mesh(renderer.scene(), "page");
//     request.paper = trilens::parse_paper("A4");
//     trilens::write_page("page.pdf", trilens::make_anamorph(renderer, request).page);
#pragma once

#include <string>

#include "inverse/anamorph/anamorph.h"
#include "trilens/maps.h"
#include "trilens/render.h"

namespace trilens {

/// The mesh of that name, as an index into Scene::meshes. Throws UsageError with the nearest name.
Id find_mesh(const Scene& scene, const std::string& name);

/// See make_anamorph and verify_anamorph in the room `inverse`: throws as those do.
Anamorph make_anamorph(const Renderer& renderer, const AnamorphRequest& request,
                       const Progress& progress = {});
AnamorphCheck verify_anamorph(const Renderer& renderer, const AnamorphRequest& request, const Anamorph& made,
                              const Progress& progress = {});

/// Throws UsageError unless the name ends in .pdf, .svg or .png.
void check_page_name(const std::string& file);

/// Writes .pdf, .svg or .png, beside its name, then renamed. Throws UsageError for other endings,
/// OutputError.
void write_page(const std::string& file, const AnamorphPage& page);

}  // namespace trilens
