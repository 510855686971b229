# What cmake --install puts where: headers, libraries, command, CMake package, pkg-config. Components: library (what
# programs load), development, program, viewer; python is in python/.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/trilens)
set(targets trilens_core_library)
if(NOT TRILENS_CORE_ONLY)
  list(APPEND targets trilens)
  # The command finds the libraries beside it, wherever the whole is moved.
  file(RELATIVE_PATH to_libraries ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(trilens_command PROPERTIES INSTALL_RPATH "$ORIGIN/${to_libraries}")
  set_target_properties(trilens PROPERTIES INSTALL_RPATH "$ORIGIN")
  install(TARGETS trilens_pictures_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(TARGETS trilens_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  if(TARGET trilens_viewer)
    set_target_properties(trilens_viewer PROPERTIES INSTALL_RPATH "$ORIGIN/${to_libraries}")
    install(TARGETS trilens_viewer RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT viewer)
  endif()
  if(TARGET trilens_cad_program)
    set_target_properties(trilens_cad_program PROPERTIES INSTALL_RPATH "$ORIGIN/${to_libraries}")
    install(TARGETS trilens_cad_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT cad)
  endif()
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/TrilensRenderTests.cmake DESTINATION ${package_folder} COMPONENT development)
endif()
install(TARGETS ${targets} EXPORT trilens_targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  COMPONENT library NAMELINK_COMPONENT development)
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/trilens DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
if(NOT TRILENS_DEBIAN)  # there each package says it
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
endif()

install(EXPORT trilens_targets NAMESPACE trilens:: FILE trilens-targets.cmake
  DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/trilens-config.cmake.in
  ${PROJECT_BINARY_DIR}/trilens-config.cmake INSTALL_DESTINATION ${package_folder} PATH_VARS CMAKE_INSTALL_BINDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/trilens-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/trilens-config.cmake ${PROJECT_BINARY_DIR}/trilens-config-version.cmake
  DESTINATION ${package_folder} COMPONENT development)

# The program stands on the core: a client calls functions of both, so both are named.
set(pc_libraries "-ltrilens -ltrilens_core")
if(TRILENS_CORE_ONLY)
  set(pc_libraries "-ltrilens_core")
endif()
set(pc_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH pc_to_prefix /${pc_folder} /)
configure_file(${CMAKE_CURRENT_LIST_DIR}/trilens.pc.in ${PROJECT_BINARY_DIR}/trilens.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/trilens.pc DESTINATION ${pc_folder} COMPONENT development)
configure_file(${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)

# Manual pages, completion and schemas come from the command's own tree of options.
if(NOT TRILENS_CORE_ONLY)
  set(shell ${PROJECT_BINARY_DIR}/shell)
  set(compressed)
  if(TRILENS_DEBIAN)
    set(compressed COMMAND gzip -9nfr ${shell}/man1)
  endif()
  add_custom_command(OUTPUT ${shell}/made
    # Anew: pages that were compressed before would be compressed again.
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${shell}/man1
    COMMAND ${CMAKE_COMMAND} -E make_directory ${shell}/man1
    COMMAND trilens_command man --all ${shell}/man1
    ${compressed}
    COMMAND trilens_command completion bash > ${shell}/trilens
    COMMAND trilens_command completion zsh > ${shell}/_trilens
    COMMAND trilens_command completion fish > ${shell}/trilens.fish
    COMMAND trilens_command scene schema > ${shell}/trilens-scene-1.schema.json
    COMMAND trilens_command sweep schema > ${shell}/trilens-sweep-summary-1.schema.json
    COMMAND trilens_command sweep schema --file > ${shell}/trilens-sweep-1.schema.json
    COMMAND trilens_command test --schema > ${shell}/trilens-test-1.schema.json
    COMMAND trilens_command design --schema > ${shell}/trilens-wish-1.schema.json
    COMMAND ${CMAKE_COMMAND} -E touch ${shell}/made
    DEPENDS trilens_command VERBATIM)
  add_custom_target(trilens_shell ALL DEPENDS ${shell}/made)
  install(DIRECTORY ${shell}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
  install(FILES ${shell}/trilens DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  # Debian's zsh looks for those of packages in a folder of its own.
  set(zsh_folder site-functions)
  if(TRILENS_DEBIAN)
    set(zsh_folder vendor-completions)
  endif()
  install(FILES ${shell}/_trilens DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${zsh_folder} COMPONENT program)
  install(FILES ${shell}/trilens.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
  # JSON Schemas, for editors: a file names its own by "$schema".
  install(FILES ${shell}/trilens-scene-1.schema.json ${shell}/trilens-sweep-summary-1.schema.json
    ${shell}/trilens-sweep-1.schema.json ${shell}/trilens-test-1.schema.json ${shell}/trilens-wish-1.schema.json
    DESTINATION ${CMAKE_INSTALL_DATADIR}/trilens COMPONENT program)
endif()
