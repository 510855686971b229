# Every outside library, found once: first what the core needs.
if(EMSCRIPTEN)
  include(BrowserLibraries)
else()
  find_package(glm REQUIRED CONFIG)
  find_package(fmt REQUIRED CONFIG)
  find_package(TBB REQUIRED CONFIG)
  find_package(hwy REQUIRED CONFIG)
endif()
if(NOT TRILENS_CORE_ONLY)
  include(MoreLibraries)
endif()

# Their headers are not ours to warn about.
foreach(library glm::glm hwy::hwy OpenImageIO::OpenImageIO OpenEXR::OpenEXR OpenEXR::OpenEXRCore Imath::Imath embree CLI11::CLI11 TinyGLTF::TinyGLTF
    tinyobjloader::tinyobjloader_double nlohmann_json::nlohmann_json)
  if(TARGET ${library})
    get_target_property(directories ${library} INTERFACE_INCLUDE_DIRECTORIES)
    if(directories)
      set_target_properties(${library} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${directories}")
    endif()
  endif()
endforeach()
