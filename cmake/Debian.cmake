# Debian packages of what is installed, by `cpack -G DEB`: scripts/package does it. Needs the prefix /usr.
find_program(TRILENS_GZIP gzip REQUIRED)

set(soname ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(package_library libtrilens${soname})
set(package_development libtrilens-dev)
set(package_program trilens)
set(package_python python3-trilens)
set(package_documentation trilens-doc)
set(package_viewer trilens-viewer)
set(components library development program documentation)
if(TRILENS_PYTHON)
  list(APPEND components python)
endif()
if(TARGET trilens_viewer)
  list(APPEND components viewer)
endif()

# What every package has in share/doc: the licence as its copyright, and a changelog.
set(doc ${PROJECT_BINARY_DIR}/debian)
set(TRILENS_MAINTAINER "The trilens authors <trilens@users.noreply.github.com>" CACHE STRING "Who answers for the Debian packages")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, if set
string(TIMESTAMP year "%Y" UTC)
file(WRITE ${doc}/copyright
  "trilens ${PROJECT_VERSION}\n\nCopyright ${year} The trilens authors\n\nLicensed under the Apache License, Version 2.0; on Debian systems its text is\n/usr/share/common-licenses/Apache-2.0.\n")
file(WRITE ${doc}/changelog
  "trilens (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * Built from the project's own source.\n\n -- ${TRILENS_MAINTAINER}  ${date}\n")
execute_process(COMMAND ${TRILENS_GZIP} -9nf ${doc}/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS components)
  install(FILES ${doc}/copyright ${doc}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_${component}} COMPONENT ${component})
endforeach()
set(program_doc ${CMAKE_INSTALL_DATADIR}/doc/${package_program})
# README.md stays out: its links lead to what no package has; trilens-doc has all pages.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes ${PROJECT_SOURCE_DIR}/examples/render-tests
  DESTINATION ${program_doc}/examples COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/consumer
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_development}/examples COMPONENT development)
if(TRILENS_PYTHON)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/python/
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_python}/examples COMPONENT python)
endif()

# The pages of docs/, which scripts/docs has made by the time that packages are.
set(pages ${CMAKE_INSTALL_DATADIR}/doc/${package_documentation})
install(DIRECTORY ${PROJECT_BINARY_DIR}/pages/ DESTINATION ${pages}/html COMPONENT documentation
  PATTERN ".buildinfo" EXCLUDE)
file(WRITE ${doc}/doc-base
  "Document: trilens\nTitle: trilens: what curved mirrors and glass show\nAuthor: The trilens authors\nAbstract: How to draw scenes with mirrors and glass by projection,\n and how to measure how far the pictures are from the truth.\nSection: Graphics\n\nFormat: HTML\nIndex: /usr/share/doc/${package_documentation}/html/index.html\nFiles: /usr/share/doc/${package_documentation}/html/*.html\n")
install(FILES ${doc}/doc-base DESTINATION ${CMAKE_INSTALL_DATADIR}/doc-base RENAME ${package_documentation}.trilens
  COMPONENT documentation)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME trilens)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "${TRILENS_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The libraries of these packages are found where they were built; who needs them is said below.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(own "${package_library} (= ${PROJECT_VERSION})")
file(WRITE ${doc}/triggers "activate-noawait ldconfig\n")
file(WRITE ${doc}/shlibs "")
foreach(library trilens trilens_core trilens_pictures)
  file(APPEND ${doc}/shlibs "lib${library} ${soname} ${own}\n")
endforeach()
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${doc}/triggers ${doc}/shlibs)
set(long "trilens draws scenes with curved mirrors and glass by projecting triangles\nthrough the facets of the optics, and measures the error of each picture\nagainst ray-traced truth.")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)

set(section_library libs)
set(section_development libdevel)
set(section_program graphics)
set(section_documentation doc)
set(section_python python)
set(section_viewer graphics)
set(what_library "shared libraries")
set(what_development "headers and CMake package")
set(what_program "the command")
set(what_documentation "documentation")
set(what_python "Python module")
set(what_viewer "the viewer")
foreach(component IN LISTS components)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_${component}})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section_${component}})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "projection through curved mirrors and glass: ${what_${component}}\n${long}")
endforeach()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${own}, ${package_program} (= ${PROJECT_VERSION}), libglm-dev")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${own}")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS fonts-dejavu-core)  # of labels
# The models are those of examples/scenes/engine.json.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "${package_viewer}, ${package_documentation}, assimp-testmodels")
set(CPACK_DEBIAN_VIEWER_PACKAGE_DEPENDS "${own}, ${package_program} (= ${PROJECT_VERSION})")
if(TRILENS_PYTHON)
  find_package(Python REQUIRED COMPONENTS Interpreter)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "${own}, python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)  # of the example
  # What dh_python3 would write: bytecode is made at once, and goes with the package.
  file(WRITE ${doc}/postinst
    "#!/bin/sh\nset -e\nif [ \"$1\" = configure ] && command -v py3compile >/dev/null; then\n    py3compile -p ${package_python}\nfi\n")
  file(WRITE ${doc}/prerm
    "#!/bin/sh\nset -e\nif command -v py3clean >/dev/null; then\n    py3clean -p ${package_python}\nfi\n")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${doc}/postinst ${doc}/prerm)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
endif()
include(CPack)
