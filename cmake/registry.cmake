# stickslip_registry_package(NAME VERSION SHA512 FILES FILE ...): a package of the npm registry, fetched when FILES are
# asked for and unpacked into build/PRESET/NAME/package; FILES, relative to it, are then there to depend on. The checksum
# says that it is the right one. npm itself is not needed.
set(STICKSLIP_REGISTRY https://registry.npmjs.org CACHE STRING "Where packages of the npm registry are fetched: it, a mirror or file://FOLDER")
function(stickslip_registry_package name version sha512)
  cmake_parse_arguments(ARG "" "" "FILES" ${ARGN})
  list(TRANSFORM ARG_FILES PREPEND ${CMAKE_BINARY_DIR}/${name}/package/ OUTPUT_VARIABLE files)
  add_custom_command(OUTPUT ${files}
    COMMAND ${CMAKE_COMMAND} -DURL=${STICKSLIP_REGISTRY}/${name}/-/${name}-${version}.tgz -DSHA512=${sha512}
      -DFOLDER=${CMAKE_BINARY_DIR}/${name} -P ${CMAKE_SOURCE_DIR}/cmake/fetch.cmake
    DEPENDS ${CMAKE_SOURCE_DIR}/cmake/fetch.cmake ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "${name} ${version} from ${STICKSLIP_REGISTRY}" VERBATIM)
endfunction()
