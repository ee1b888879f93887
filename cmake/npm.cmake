# stickslip_npm(FOLDER NAME FILES ...): what FOLDER/package-lock.json pins, installed once for each build directory into
# its NAME/node_modules. FILES, relative to node_modules, are then there to depend on; the lock file's hashes say that
# they are the right ones. With all of them present npm is not run, nor needed.
find_program(STICKSLIP_NPM npm)
function(stickslip_npm folder name)
  cmake_parse_arguments(ARG "" "" "FILES" ${ARGN})
  set(installed ${CMAKE_BINARY_DIR}/${name})
  list(TRANSFORM ARG_FILES PREPEND ${installed}/node_modules/ OUTPUT_VARIABLE files)
  foreach(file IN LISTS files)
    if(NOT STICKSLIP_NPM AND NOT EXISTS ${file})
      message(FATAL_ERROR "npm was not found; the pages need it once: ./dev deps build, or apt-get install npm")
    endif()
  endforeach()
  if(NOT STICKSLIP_NPM)
    return()
  endif()
  add_custom_command(OUTPUT ${files}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${installed}
    COMMAND ${CMAKE_COMMAND} -E copy ${folder}/package.json ${folder}/package-lock.json ${installed}
    COMMAND ${CMAKE_COMMAND} -E chdir ${installed} ${STICKSLIP_NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    # npm keeps the times of the package, which are older than the lock file.
    COMMAND ${CMAKE_COMMAND} -E touch ${files}
    DEPENDS ${folder}/package.json ${folder}/package-lock.json
    WORKING_DIRECTORY ${CMAKE_BINARY_DIR}
    COMMENT "npm ci" VERBATIM)
endfunction()
